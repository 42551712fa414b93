"""`matchset demo`: a rendered clip with exact truth, tracked from one click, and what came of it."""

import csv
import math
from contextlib import ExitStack
from pathlib import Path

import msgspec
import numpy as np
import numpy.typing as npt
from rich.console import Console

from matchset.app import exit_codes as ending
from matchset.app.drawing.annotate import shape_names
from matchset.app.drawing.contact_sheet import WIDTH_PX, Shot, picture_sheet
from matchset.app.drawing.video_writer import Recorder
from matchset.app.exit_codes import StopRequest
from matchset.app.patience import if_slow
from matchset.app.progress import counting
from matchset.app.run_folder import output_folder
from matchset.app.track.learn_command import write_picture
from matchset.app.track.loop import Tally, follow
from matchset.app.track.outputs import track_outlets
from matchset.app.track.rows import Row
from matchset.app.track.score import Score, circles, error_px, score
from matchset.app.track.score_command import print_score
from matchset.app.track.trackers import COMPILING
from matchset.app.track.truth import COLUMNS, Truth
from matchset.image.color import ColorModel
from matchset.shapes.circle import Circle
from matchset.sim.clips.clip import Clip
from matchset.tracking.tracker import Tracker

_SHOTS = 8


class _Show(msgspec.Struct):
    """What the demo keeps of its run."""

    rows: list[Row]
    truths: list[Truth]
    shots: list[Shot]


def run_demo(out: Path | None, frames: int, force: bool) -> int:
    """Run the command.

    Parameters
    ----------
    out : Path or None
        Folder to write to; None for a new one.
    frames : int
        Length of the clip.
    force : bool
        Whether files may be overwritten.

    Returns
    -------
    int
        The exit code.
    """
    console = Console(highlight=False)
    folder = output_folder(out, "demo", force)
    clip = Clip(frames=frames, preset="typical")
    console.print(f"A balloon in a room, {clip.width} x {clip.height}, {frames} frames over an analog radio link.")
    console.print("It is tracked from one click in the first frame.\n")
    tally = Tally()
    with StopRequest() as stop:
        show = _track(clip, folder, tally, stop)
    _write_truth(folder / "truth.csv", show.truths)
    result = score(circles(show.rows), show.truths)
    print_score(result, console)
    console.print(f"\ntracking took {tally.median_ms:.2f} ms of computing a frame (median)")
    if show.shots:
        write_picture(folder / "sheet.png", _sheet(clip, show, result, tally))
    for name in ("demo.webm", "sheet.png", "tracks.csv", "truth.csv"):
        if (folder / name).exists():
            console.print(f"  {folder / name}", soft_wrap=True)
    return stop.code or (ending.FOUND if tally.found else ending.NOT_FOUND)


def _track(clip: Clip, folder: Path, tally: Tally, stop: StopRequest) -> _Show:
    show = _Show([], [], [])
    with if_slow(COMPILING):
        background = clip.background()
        color = ColorModel.pick(clip.render(0, background).image, *clip.first_click)
        tracker = Tracker(Circle, color, start=clip.first_click)
    frames = (clip.render(index, background) for index in range(len(clip)))
    wanted = {round((place + 0.5) * len(clip) / _SHOTS) for place in range(_SHOTS)}
    with ExitStack() as stack:
        recorder = Recorder(folder / "demo.webm", clip.fps, (clip.width, clip.height))
        outlets = stack.enter_context(track_outlets(folder, shape_names(Circle), False, recorder))
        bar = stack.enter_context(counting("rendering, tracking, recording", len(clip)))
        for step in follow(frames, lambda _: tracker, gaps=False, stop=stop):
            truth = _truth(clip, step.row.frame)
            outlets.write(step)
            tally.count(step)
            show.rows.append(step.row)
            show.truths.append(truth)
            if step.frame is not None and step.row.frame in wanted:
                show.shots.append(Shot(step.frame, step.answer, _error(step.row, truth)))
            bar.show(step.row)
    return show


def _truth(clip: Clip, index: int) -> Truth:
    circle = clip.truth(index).circle
    return Truth(index, None if circle is None else (circle.x, circle.y, circle.radius))


def _error(row: Row, truth: Truth) -> float | None:
    if row.shape is None or truth.circle is None:
        return None
    return error_px(tuple(row.shape.values()), truth.circle)


def _write_truth(path: Path, truths: list[Truth]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for truth in truths:
            numbers = ["", "", ""] if truth.circle is None else [f"{value:.4f}" for value in truth.circle]
            writer.writerow(["demo", truth.frame, *numbers, int(truth.circle is not None), "rendered"])


def _sheet(clip: Clip, show: _Show, result: Score, tally: Tally) -> npt.NDArray[np.uint8]:
    with if_slow("drawing the sheet ..."):
        from matchset.app.drawing.curves import error_plot

        errors = [_error(row, truth) for row, truth in zip(show.rows, show.truths, strict=True)]
        radii = [math.nan if truth.circle is None else truth.circle[2] for truth in show.truths]
        plot = error_plot(
            [row.time for row in show.rows],
            [math.nan if error is None else error for error in errors],
            radii,
            (WIDTH_PX, 360),
        )
        mean = "-" if result.mean_error_px is None else f"{result.mean_error_px:.2f} px"
        valid = "-" if result.valid_percent is None else f"{result.valid_percent:.1f} %"
        subtitle = (
            f"{len(show.rows)} frames, {clip.width} × {clip.height}, over a rendered analog radio link   ·   "
            f"mean error {mean}   ·   valid {valid}   ·   {tally.median_ms:.2f} ms a frame"
        )
        return picture_sheet("One click, then every frame", subtitle, show.shots, plot)
