"""The paper's Table 1 and Fig. 6 again: what it took and how exact it was there, and here."""

import math

from benchmarks.contest import speed as contest_times
from benchmarks.contest.field import OURS, PAPER, missing, peer
from benchmarks.contest.run import Results, SequenceRun, follow_sequence
from benchmarks.contest.speed import PAPER_FPS
from benchmarks.figures.kept import draw_kept
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Picture, Section, table
from benchmarks.tracking.accuracy import figures, pooled
from benchmarks.workers import spread

NO_CODE = "not run: no packaged implementation is known to us"
# name in print, ms in print, peer here, or why there is none
ROWS = (
    ("EDCircles", 9.9, "edge_drawing", "as OpenCV's EdgeDrawing, its successor"),
    ("GRCD-R", 52.0, "", NO_CODE),
    ("Isophote", 20.5, "", NO_CODE),
    ("ITCiD", 15.7, "", NO_CODE),
    ("PolynomialFitting", 16.9, "", NO_CODE),
    ("AR Aristo platform", 16.6, "", "not run: a platform of its own, not a program that takes frames"),
    ("RuneTag", 51.0, "", "not run: not packaged; in another run its decoder did not work; quoted under *Tag systems*"),
    ("AprilTag", 19.0, "april_tag", "AprilTag 3, on tag sequences"),
    ("ChromaTag", 1.4, "", "not run: not packaged; in another run it crashed on sequences; quoted under *Tag systems*"),
    ("Algorithm 1 (the paper)", 0.9, PAPER, "to the letter in NumPy, whole-frame color filter included"),
)
ADDED = (
    ("ArUco (not in the paper)", "aruco", "on tag sequences"),
    ("matchset", OURS, "in the same race"),
)


def run_table1(options: Options) -> Section:
    """Set the times of this machine beside those of the print."""
    light, heavy = contest_times.everybody(options)
    rows, figures = [], []
    for name, printed, key, note in ROWS:
        why = missing(key) if key else ""
        here = "-" if not key or why else f"{heavy[key].median_us / 1e3:.2f} ({heavy[key].least_us / 1e3:.2f})"
        rows.append([name, f"{printed:g}", here, f"not run: {why}" if why else note])
        if here != "-":
            figures.append(Figure(name, heavy[key].median_us / 1e3, "ms", 2))
    for name, key, note in ADDED:
        if not missing(key):
            rows.append([name, "-", f"{heavy[key].median_us / 1e3:.3f} ({heavy[key].least_us / 1e3:.3f})", note])
    figures.append(Figure("matchset", heavy[OURS].median_us / 1e3, "ms", 3))
    fps = 1e6 / light[OURS].median_us
    text = (
        "Milliseconds per frame. In print: the authors' laptop (Intel 4810MQ, 2.8 GHz) and, for most rows, the figures "
        "of those papers on their machines. Here: median (minimum) of this machine, one thread, 640 × 480, among the "
        "heavy ones.\n\n"
        + table(["", "in print, ms", "here, ms", "note"], rows)
        + f"\nThe paper's {PAPER_FPS} frames per second on one core: here {fps:,.0f} with other light contenders in "
        "between.\n"
    )
    finding = Finding(name="table1", what="Table 1, the rows that could be run", figures=tuple(figures))
    return Section("The paper's Table 1", [finding], text)


FRAMES, QUICK_FRAMES = 500, 120
SHOWN = ("matchset", "region_bgr", "paper", "hough_gradient", "simple_blob")
PRINTED = (
    ("the paper's algorithm", "1.73 px", "94.6 %", "6.2 px"),
    ("OpenCV's circle detection", "8.02 px", "less than 50 %", "more than 15 px"),
    ("OpenCV's blob detection", "18.86 px", "less than 50 %", "more than 15 px"),
)


def run_figure6(options: Options) -> Section:
    """Follow one long `typical` sequence with those of the paper's figure, its algorithm, and the strongest rival."""
    frames = QUICK_FRAMES if options.quick else FRAMES
    keys = [key for key in SHOWN if not missing(key)]
    heats = [SequenceRun("typical", options.seeds[0], frames, (key,)) for key in keys]
    done: Results = {}
    for each in spread(follow_sequence, heats, options.jobs):
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
    assert options.pictures is not None
    errors = {_short(peer(key).name): trial.errors for key, trial in reversed(done.items())}
    truths = done["matchset"].truths
    radii = [truth.circle[2] if truth.circle else math.nan for truth in truths]
    best = _short(peer("matchset").name)
    data = {"errors": errors, "radii": radii, "best": best}
    draw_kept(options.pictures, "figure6", "errors over frames", data)
    draw_kept(options.pictures, "figure6_histogram", "error histogram", {"errors": errors, "best": best})
    return (
        Picture("figure6.svg", "Error over 500 frames, as the paper's Fig. 6b"),
        Picture("figure6_histogram.svg", "Histogram of the error, as the paper's Fig. 6c"),
    )


def _short(name: str) -> str:
    return name.split(",")[0].split(" (")[0].replace("SimpleBlobDetector on the HSV mask", "SimpleBlob")
