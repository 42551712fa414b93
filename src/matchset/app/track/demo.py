"""`matchset demo`: a rendered clip with exact truth is tracked from one click, and the result is compared with it."""

import csv
import io
import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
from rich.console import Console

from matchset.app.course.log import ShapeLog
from matchset.app.drawing.contact_sheet import WIDTH_PX, SheetFrame, contact_sheet
from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.app.guidance.next_command import shell_command
from matchset.app.pictures.run_pictures import WantedPictures
from matchset.app.progress import announce_if_slow, progress_bar
from matchset.app.run_folder import output_folder
from matchset.app.target.shape_option import parse_shape
from matchset.app.track.loop import RunStatistics, TrackedFrame, computing_lines, follow
from matchset.app.track.options import DemoOptions
from matchset.app.track.outputs import Outputs, track_outputs
from matchset.app.track.rows import TrackRow, track_table
from matchset.app.track.score import TRUTH_COLUMNS, Score, TruthRow, circles, error_px, print_score, score
from matchset.image.color import ColorModel
from matchset.image.files.whole_file import write_whole
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.shapes.ellipse import Ellipse
from matchset.shapes.quadrilateral import Quadrilateral
from matchset.shapes.rectangle import Rectangle
from matchset.shapes.shape import outline
from matchset.sim.clips.clip import Clip
from matchset.sim.clips.shape_clip import ShapeClip
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker

Floats = npt.NDArray[np.float64]

_SHEET_FRAMES = 8  # geometry: two rows of four on the sheet
_TILT = 0.45  # geometry: rotation of a rendered quadrilateral out of the picture's plane, rad


class _DemoRun(msgspec.Struct):
    """What is kept of the run for score and sheet."""

    rows: list[TrackRow]
    truths: list[TruthRow]
    sheet_frames: list[SheetFrame]
    worst: SheetFrame | None = None
    largest_error: float = -1.0


def demonstrate_circle(options: DemoOptions) -> int:
    """Track a rendered ball; write video, tables and a contact sheet, and print the score.

    Returns
    -------
    int
        The exit code.
    """
    console = Console(highlight=False)
    folder = output_folder(options.out, "demo", options.force)
    clip = Clip(frames=options.frames, preset="typical")
    size = f"{clip.width} x {clip.height}, {options.frames} frames"
    console.print(f"A balloon in a room, {size} over an analog radio link.")
    console.print("It is tracked from one click in the first frame.\n")
    statistics = RunStatistics()
    with StopRequest() as stop:
        run = _track_circle(clip, folder, statistics, stop)
    _write_truth(folder / "truth.csv", run.truths)
    result = score(circles(run.rows), run.truths)
    print_score(result)
    console.print("\n" + "\n".join(computing_lines(statistics.durations, "tracking")))
    if run.sheet_frames:
        write_picture(folder / "sheet.png", _sheet(clip, run, result, statistics))
    for name in ("demo.webm", "sheet.png", "tracks.csv", "truth.csv"):
        if (folder / name).exists():
            console.print(f"  {folder / name}", soft_wrap=True)
    console.print(f"\nNext, in the browser, with a ball to click: {shell_command('live')}", soft_wrap=True)
    return stop.code or (FOUND if statistics.found else NOT_FOUND)


def _track_circle(clip: Clip, folder: Path, statistics: RunStatistics, stop: StopRequest) -> _DemoRun:
    background = clip.background()
    color = ColorModel.pick(clip.render(0, background).image, *clip.first_click)
    tracker = Tracker(Circle, color, start=clip.first_click)
    frames = (clip.render(index, background) for index in range(len(clip)))
    wanted = {round((place + 0.5) * len(clip) / _SHEET_FRAMES) for place in range(_SHEET_FRAMES)}
    run = _DemoRun([], [], [])
    with _write_demo(clip, folder, Circle, statistics) as take:
        for tracked in follow(frames, lambda _: tracker, gaps=False, stop=stop):
            truth = _truth(clip, tracked.row.frame)
            run.rows.append(tracked.row)
            run.truths.append(truth)
            if tracked.frame is not None:
                _keep(run, tracked, wanted)
            take(tracked)
    _show_worst(run)
    return run


def _keep(run: _DemoRun, tracked: TrackedFrame, wanted: set[int]) -> None:
    """Keep a frame for the sheet if it is wanted there or the worst so far; a lost one is worse than any error."""
    row, truth = run.rows[-1], run.truths[-1]
    if tracked.frame is None or truth.circle is None:
        return
    error = _error(row, truth)
    shown = SheetFrame(tracked.frame, tracked.answer, error, Circle(*truth.circle))
    if row.frame in wanted:
        run.sheet_frames.append(shown)
    badness = math.inf if error is None else error
    if badness > run.largest_error:
        run.largest_error, run.worst = badness, shown


def _show_worst(run: _DemoRun) -> None:
    """Put the worst frame of the run on the sheet, in the place of the one nearest to it in time."""
    worst = run.worst
    if worst is None or not run.sheet_frames:
        return
    distances = [abs(each.frame.index - worst.frame.index) for each in run.sheet_frames]
    run.sheet_frames[distances.index(min(distances))] = msgspec.structs.replace(worst, remark="the worst")


@contextmanager
def _write_demo(
    clip: Clip | ShapeClip, folder: Path, family: type[Any], statistics: RunStatistics
) -> Iterator[Callable[[TrackedFrame], None]]:
    """Open video, table and progress bar; yield what writes, counts and shows a frame."""
    with ExitStack() as stack:
        log = ShapeLog(family)
        outputs = stack.enter_context(_outputs(clip, folder, family, log))
        bar = stack.enter_context(progress_bar("rendering, tracking, recording", len(clip), statistics.durations))

        def take(tracked: TrackedFrame) -> None:
            log.add(tracked)
            outputs.write(tracked)
            statistics.count(tracked)
            bar.show(tracked.row)

        yield take


def _outputs(clip: Clip | ShapeClip, folder: Path, family: type[Any], log: ShapeLog) -> Outputs[TrackedFrame]:
    """Begin the files of the demonstration; the sheet of a shape that is no circle is the summary of the run."""
    table = track_table(folder / "tracks.csv", family.parameters)
    wanted = WantedPictures(
        folder,
        "demo",
        "One click, then every frame",
        clip.fps,
        summary="sheet.png",
        video=folder / "demo.webm",
        none=family is Circle,
        small=True,
        force=True,
    )
    return track_outputs(table, wanted, (clip.width, clip.height), log)


def _truth(clip: Clip, index: int) -> TruthRow:
    circle = clip.truth(index).circle
    return TruthRow(index, None if circle is None else (circle.x, circle.y, circle.radius))


def _error(row: TrackRow, truth: TruthRow) -> float | None:
    if row.shape is None or truth.circle is None:
        return None
    return error_px(tuple(row.shape.values()), truth.circle)


def _write_truth(path: Path, truths: list[TruthRow]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(TRUTH_COLUMNS)
    for truth in truths:
        numbers = ["", "", ""] if truth.circle is None else [f"{value:.4f}" for value in truth.circle]
        writer.writerow(["demo", truth.frame, *numbers, int(truth.circle is not None), "rendered"])
    write_whole(path, text.getvalue().encode())


def _sheet(clip: Clip, run: _DemoRun, result: Score, statistics: RunStatistics) -> npt.NDArray[np.uint8]:
    with announce_if_slow("drawing the sheet ..."):
        from matchset.app.drawing.curves import SIZE_PX, ErrorCurve, error_figure
        from matchset.app.drawing.plot_style import picture_of

        errors = [_error(row, truth) for row, truth in zip(run.rows, run.truths, strict=True)]
        radii = [math.nan if truth.circle is None else truth.circle[2] for truth in run.truths]
        curve = ErrorCurve(
            [row.time for row in run.rows],
            [math.nan if error is None else error for error in errors],
            radii,
            [shown.frame.index for shown in run.sheet_frames],
        )
        plot = picture_of(error_figure(curve), WIDTH_PX / SIZE_PX[0])
        mean = "-" if result.mean_error_px is None else f"{result.mean_error_px:.2f} px"
        valid = "-" if result.valid_percent is None else f"{result.valid_percent:.1f} %"
        times = statistics.durations.times()
        computing = "" if times is None else f" · computing: {times.words}"
        subtitle = (
            f"{len(run.rows)} frames, {clip.width} × {clip.height}, rendered analog radio link · "
            f"mean error {mean} · valid {valid}{computing}"
        )
        return contact_sheet("One click, then every frame", subtitle, run.sheet_frames, plot)


def demonstrate_shape(options: DemoOptions) -> int:
    """Track a rendered shape that is no circle; write video and table, and print the overlap with the truth.

    Returns
    -------
    int
        The exit code.
    """
    console, family = Console(highlight=False), parse_shape(options.shape)
    folder = output_folder(options.out, "demo", options.force)
    tilt = _TILT if family is Quadrilateral else 0.0
    clip = ShapeClip(corners=_rendered_outline(family), frames=options.frames, tilt=tilt)
    size = f"{clip.width} x {clip.height}, {options.frames} frames"
    console.print(f"A blue {_named(options.shape)} in a room, {size} over an analog radio link.")
    console.print("It is tracked from one click in the first frame.\n")
    statistics = RunStatistics()
    with StopRequest() as stop:
        overlaps = _track_shape(clip, folder, family, statistics, stop)
    share = 100.0 * statistics.found / max(statistics.frames, 1)
    console.print(f"found                {share:8.1f} %   of {statistics.frames} frames")
    if overlaps:
        least = f"{min(overlaps):.4f} at least"
        console.print(f"overlap with truth   {np.mean(overlaps):8.4f}     mean, {least} (1: equal)")
    console.print("\n" + "\n".join(computing_lines(statistics.durations, "tracking")))
    for name in ("demo.webm", "sheet.png", "tracks.csv"):
        console.print(f"  {folder / name}", soft_wrap=True)
    return stop.code or (FOUND if statistics.found else NOT_FOUND)


def _track_shape(
    clip: ShapeClip, folder: Path, family: type[Any], statistics: RunStatistics, stop: StopRequest
) -> list[float]:
    """Track the shape through the clip; return its overlap with the truth in each frame in which it was found."""
    room, (x, y) = clip.room(), clip.outline(0.0).mean(axis=0).tolist()
    color = ColorModel.pick(clip.render(0, room).image, x, y)
    tracker: Tracker[Any] = Tracker(family, color, start=(x, y))
    frames: Iterator[Frame] = (clip.render(index, room) for index in range(len(clip)))
    overlaps = []
    with _write_demo(clip, folder, family, statistics) as take:
        for tracked in follow(frames, lambda _: tracker, gaps=False, stop=stop):
            take(tracked)
            if isinstance(tracked.answer, Track):
                truth = clip.outline(float(tracked.row.frame))
                overlaps.append(overlap(outline(tracked.answer.shape, 180), truth))
    return overlaps


def _named(shape: str) -> str:
    """Name a shape in words: "octagon"; "shape with 3 corners"; "shape as in leaf.png"."""
    name = shape.partition(":affine")[0].strip()
    if name[:1] in "-0123456789" and "," in name:
        return f"shape with {name.count(',')} corners"
    return f"shape as in {name}" if Path(name).suffix else name


def overlap(one: Floats, other: Floats) -> float:
    """Return the area common to two convex outlines over the area of both together (intersection over union)."""
    a, b = one.astype(np.float32), other.astype(np.float32)
    common, _ = cv2.intersectConvexConvex(a, b)
    return float(common / (cv2.contourArea(a) + cv2.contourArea(b) - common))


def _rendered_outline(family: type[Any]) -> tuple[tuple[float, float], ...]:
    """Return the outline of the family's shape that is rendered, about its center."""
    if family is Ellipse:
        points = outline(Ellipse(0.0, 0.0, 1.5, 1.0, 0.0), 180)
    elif family in (Rectangle, Quadrilateral):
        points = outline(Rectangle(0.0, 0.0, 3.0, 2.0, 0.0))
    else:
        points = outline(family.from_coarse(0.0, 0.0, math.sqrt(1.0 / math.pi)), 180)
    return tuple((float(x), float(y)) for x, y in points)
