"""`matchset demo --shape`: a rendered clip of another shape with exact truth, and what came of it."""

import math
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from rich.console import Console

from matchset.app import exit_codes as ending
from matchset.app.drawing.video_writer import Recorder
from matchset.app.exit_codes import StopRequest
from matchset.app.patience import if_slow
from matchset.app.progress import counting
from matchset.app.run_folder import output_folder
from matchset.app.track.loop import Tally, follow
from matchset.app.track.outputs import track_outlets
from matchset.app.track.shape_option import parse_shape
from matchset.app.track.trackers import COMPILING
from matchset.image.color import ColorModel
from matchset.shapes.ellipse import Ellipse
from matchset.shapes.quadrilateral import Quadrilateral
from matchset.shapes.rectangle import Rectangle
from matchset.shapes.shape import outline
from matchset.sim.clips.shape_clip import ShapeClip
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker

Floats = npt.NDArray[np.float64]
TILT = 0.45  # rad: how far a quadrilateral turns out of the picture's plane


def run_shape_demo(shape: str, out: Path | None, frames: int, force: bool) -> int:
    """Run the command.

    Parameters
    ----------
    shape : str
        As typed behind `--shape`.
    out, frames, force
        See `run_demo`.

    Returns
    -------
    int
        The exit code.
    """
    console, family = Console(highlight=False), parse_shape(shape)
    folder = output_folder(out, "demo", force)
    clip = ShapeClip(corners=_upright(family), frames=frames, tilt=TILT if family is Quadrilateral else 0.0)
    console.print(f"A blue {shape} in a room, {clip.width} x {clip.height}, {frames} frames over an analog radio link.")
    console.print("It is tracked from one click in the first frame.\n")
    tally, overlaps = Tally(), []
    with if_slow(COMPILING):
        room, (x, y) = clip.room(), clip.outline(0.0).mean(axis=0).tolist()
        color = ColorModel.pick(clip.render(0, room).image, x, y)
        tracker = Tracker(family, color, start=(x, y))
    with StopRequest() as stop, ExitStack() as stack:
        recorder = Recorder(folder / "demo.webm", clip.fps, (clip.width, clip.height))
        outlets = stack.enter_context(track_outlets(folder, family.parameters, False, recorder))
        bar = stack.enter_context(counting("rendering, tracking, recording", len(clip)))
        pictures = (clip.render(index, room) for index in range(len(clip)))
        for step in follow(pictures, lambda _: tracker, gaps=False, stop=stop):
            outlets.write(step)
            tally.count(step)
            if isinstance(step.answer, Track):
                overlaps.append(overlap(outline(step.answer.shape, 180), clip.outline(float(step.row.frame))))
            bar.show(step.row)
    share = 100.0 * tally.found / max(tally.frames, 1)
    console.print(f"found                {share:8.1f} %   of {tally.frames} frames")
    if overlaps:
        console.print(
            f"overlap with truth   {np.mean(overlaps):8.4f}     mean, {min(overlaps):.4f} at least (1: equal)"
        )
    console.print(f"\ntracking took {tally.median_ms:.2f} ms of computing a frame (median)")
    for name in ("demo.webm", "tracks.csv"):
        console.print(f"  {folder / name}", soft_wrap=True)
    return stop.code or (ending.FOUND if tally.found else ending.NOT_FOUND)


def overlap(one: Floats, other: Floats) -> float:
    """Area common to two convex outlines, over the area of both (IoU)."""
    a, b = one.astype(np.float32), other.astype(np.float32)
    common, _ = cv2.intersectConvexConvex(a, b)
    return float(common / (cv2.contourArea(a) + cv2.contourArea(b) - common))


def _upright(family: type[Any]) -> tuple[tuple[float, float], ...]:
    """Outline of the family's shape that is shown, about its center."""
    if family is Ellipse:
        points = outline(Ellipse(0.0, 0.0, 1.5, 1.0, 0.0), 180)
    elif family in (Rectangle, Quadrilateral):
        points = outline(Rectangle(0.0, 0.0, 3.0, 2.0, 0.0))
    else:
        points = outline(family.from_coarse(0.0, 0.0, math.sqrt(1.0 / math.pi)), 180)
    return tuple((float(x), float(y)) for x, y in points)
