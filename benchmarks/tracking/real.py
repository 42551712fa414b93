"""Real footage: a green ball moved by hand, followed from one click."""

from pathlib import Path

import matchset as ms
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.tracking.accuracy import figures
from benchmarks.tracking.trial import circle, clicked
from matchset.app.track.score import Circle3, Score, TruthRow, read_truth, score

CLIP = "green_ball_hand"
BAR = (Goal("mean", high=1.5), Goal("valid", low=95.0), Goal("found on absent rows", high=0.0))
PRIZE = (Goal("mean", high=0.8), Goal("valid", low=100.0), Goal("found on absent rows", high=0.0))
# Where on the disc the click hits, in radii from the center; the first is the one that the goals are for.
CLICKS = ((-0.5, 0.0), (0.5, 0.0), (0.0, -0.5), (0.0, 0.5), (0.0, 0.0))


def run(options: Options) -> Section:
    """Follow the ball of the real clip, if it is there."""
    folder = None if options.data is None else options.data / CLIP
    if folder is None or not (folder / "truth.csv").exists():
        skipped = Finding(name="real", what=f"`{CLIP}`: skipped, not found (`--data DIR`)", figures=())
        return Section("Real footage", [skipped], "Skipped: the real clips are not here.")
    truths = read_truth(folder / "truth.csv")
    clicks = CLICKS[:1] if options.quick else CLICKS
    runs = [follow_video(folder / "video.mp4", truths, click) for click in clicks]
    results = [score(answers, truths, start=first_good(truths).frame) for answers in runs]
    absent = sum(runs[0].get(truth.frame) is not None for truth in truths if truth.circle is None)
    finding = Finding(
        name="real",
        what=f"`{CLIP}`, one click at (x - r/2, y) of the first good row",
        figures=(*figures(results[0]), Figure("found on absent rows", absent, "", 0)),
        bar=BAR,
        prize=PRIZE,
    )
    return Section("Real footage", [finding], _text(results, truths))


def first_good(truths: list[TruthRow]) -> TruthRow:
    """Return the first row with the ball well known."""
    return next(truth for truth in truths if truth.tight)


def follow_video(path: Path, truths: list[TruthRow], click: tuple[float, float]) -> dict[int, Circle3 | None]:
    """Follow the ball from the first good row to the end.

    Parameters
    ----------
    path : Path
        The video.
    truths : list of TruthRow
        Only the first good row is used.
    click : tuple of 2 floats
        Where on the disc the click hits, in radii from the center.

    Returns
    -------
    dict of int to (x, y, radius) or None
        Answers by frame.
    """
    first = first_good(truths)
    assert first.circle is not None
    x, y, radius = first.circle
    tracker: ms.Tracker[ms.Circle] | None = None
    answers: dict[int, Circle3 | None] = {}
    for frame in ms.Video(str(path)):
        if frame.index < first.frame:
            continue
        tracker = tracker or clicked(frame, (x + click[0] * radius, y + click[1] * radius))
        answer = tracker.update(frame)
        answers[frame.index] = circle(answer.shape) if isinstance(answer, ms.Track) else None
    return answers


def _text(results: list[Score], truths: list[TruthRow]) -> str:
    head = ["click, radii from the center", *(figure.name for figure in figures(results[0]))]
    rows = [
        [f"({x:+g}, {y:+g})", *(figure.text for figure in figures(result))]
        for (x, y), result in zip(CLICKS, results, strict=False)
    ]
    first = first_good(truths).frame
    return (
        f"Scored from frame {first} on: {results[0].tight} rows with the ball well known, "
        f"{results[0].absent} without it. The truth itself is good to about 0.5 px where sharp and 1-2 px "
        "under motion blur. The other clicks show how much hangs on where one hits.\n\n" + table(head, rows)
    )
