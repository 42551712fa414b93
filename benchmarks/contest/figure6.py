"""The paper's Fig. 6 again: the error over 500 frames, and its histogram."""

import math

from benchmarks.contest.field import missing, peer
from benchmarks.contest.run import Heat, Results, run_heat
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Picture, Section, table
from benchmarks.tracking.accuracy import figures, pooled
from benchmarks.workers import spread

FRAMES, QUICK_FRAMES = 500, 120
SHOWN = ("matchset", "region_bgr", "paper", "hough_gradient", "simple_blob")
PRINTED = (
    ("the paper's algorithm", "1.73 px", "94.6 %", "6.2 px"),
    ("OpenCV's circle detection", "8.02 px", "less than 50 %", "more than 15 px"),
    ("OpenCV's blob detection", "18.86 px", "less than 50 %", "more than 15 px"),
)


def run(options: Options) -> Section:
    """Follow one long `typical` sequence with those of the paper's figure, its algorithm, and the strongest rival."""
    frames = QUICK_FRAMES if options.quick else FRAMES
    keys = [key for key in SHOWN if not missing(key)]
    heats = [Heat("typical", options.seeds[0], frames, (key,)) for key in keys]
    done: Results = {}
    for each in spread(run_heat, heats, options.jobs):
        done |= each
    scores = {peer(key).name: figures(pooled([trial])) for key, trial in done.items()}
    rows = [[name, *(figure.text for figure in row)] for name, row in scores.items()]
    head = ["", *(figure.name for figure in next(iter(scores.values())))]
    text = (
        f"`typical`, seed {options.seeds[0]}, {frames} frames. Everybody is told the truth of the first.\n\n"
        + table(head, rows)
        + "\n**In print**, over 500 frames of the authors' own video, which is not public: another video, so not to be "
        "put in one column with the above\n\n"
        + table(["", "mean error", "valid", "trembling"], [list(row) for row in PRINTED])
    )
    finding = Finding(
        name="figure6",
        what=f"Fig. 6: mean error over {frames} frames of `typical`",
        figures=tuple(Figure(key, pooled([trial]).mean_error_px, "px", 2) for key, trial in done.items()),
    )
    pictures = () if options.pictures is None else _draw(done, options)
    return Section("The paper's Fig. 6", [finding], text, pictures)


def _draw(done: Results, options: Options) -> tuple[Picture, ...]:
    from benchmarks.tracking.pictures import error_histogram, errors_over_frames

    assert options.pictures is not None
    errors = {_short(peer(key).name): trial.errors for key, trial in reversed(done.items())}
    truths = done["matchset"].truths
    radii = [truth.circle[2] if truth.circle else math.nan for truth in truths]
    errors_over_frames(errors, radii, options.pictures / "figure6.png")
    error_histogram(errors, options.pictures / "figure6_histogram.png")
    return (
        Picture("figure6.png", "Error over 500 frames, as the paper's Fig. 6b"),
        Picture("figure6_histogram.png", "Histogram of the error, as the paper's Fig. 6c"),
    )


def _short(name: str) -> str:
    return name.split(",")[0].split(" (")[0].replace("SimpleBlobDetector on the HSV mask", "SimpleBlob")
