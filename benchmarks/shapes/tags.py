"""Printed marks in photos: the borders of AprilTags, each begun at its upright box, without any color."""

import math
import re
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.shapes.cases import corner_error

Floats = npt.NDArray[np.float64]
SMALLEST = 20.0  # px: mean side of a tag that counts
WORST = 3.0  # px: an answer that is farther off is another quadrilateral


def run(options: Options) -> Section:
    """Fit every border of the photos, if they are there."""
    folder = None if options.data is None else options.data / "stills"
    photos = sorted(folder.glob("apriltag*.txt")) if folder is not None else []
    if not photos:
        skipped = Finding(name="tags", what="AprilTag photos: skipped, not found (`--data DIR`)", figures=())
        return Section("Printed marks", [skipped], "Skipped: the photos are not here.")
    rows = [(path.stem, *row) for path in photos for row in fitted(path)]
    errors = np.array([error for _, _, error in rows])
    answered = errors[np.isfinite(errors)]
    figures = (
        Figure("mean", float(answered.mean()) if len(answered) else None, "px"),
        Figure("median", float(np.median(answered)) if len(answered) else None, "px"),
        Figure("tags", len(rows), "", 0),
        Figure("not answered", len(rows) - len(answered), "", 0),
        Figure("off by more than 3 px", int((answered > WORST).sum()), "", 0),
    )
    finding = Finding(
        name="tags",
        what="borders of AprilTags in photos, begun at their upright boxes",
        figures=figures,
        bar=(Goal("mean", high=1.0), Goal("not answered", high=0.0)),
        prize=(Goal("mean", high=0.5), Goal("not answered", high=0.0)),
    )
    text = "`Tracker(Quadrilateral, ColorModel.dark())`, `start` at the box around the border, one frame.\n\n"
    cells = [[name, f"{side:.0f}", f"{error:.2f}" if math.isfinite(error) else "lost"] for name, side, error in rows]
    return Section("Printed marks", [finding], text + table(["photo", "side, px", "error, px"], cells))


def fitted(path: Path) -> list[tuple[float, float]]:
    """Mean side and corner error of each tag of a photo, px; an infinite error where it was not answered."""
    image = cv2.imread(str(path.with_suffix(".jpg")))
    assert image is not None
    found = []
    for corners in reference(path):
        side = float(np.hypot(*(corners - np.roll(corners, 1, axis=0)).T).mean())
        if side >= SMALLEST:
            answer = border(np.asarray(image, np.uint8), corners)
            error = corner_error(answer.shape.corners, corners) if isinstance(answer, ms.Track) else math.inf
            found.append((side, error))
    return found


def border(image: npt.NDArray[np.uint8], corners: Floats) -> ms.Track[ms.Quadrilateral] | ms.Lost[ms.Quadrilateral]:
    """Fit the border of a tag, begun at the upright box around it."""
    (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
    tracker = ms.Tracker(ms.Quadrilateral, ms.ColorModel.dark())
    tracker.start(ms.Quadrilateral([(left, top), (right, top), (right, bottom), (left, bottom)]))
    return tracker.update(ms.Frame(image, 0.0, 0))


def reference(path: Path) -> list[Floats]:
    """Corners of the tags, (4, 2) px each; the files count from the corner of a pixel, not from its middle."""
    lines = path.read_text(encoding="utf-8").splitlines()
    numbers = [[float(value) for value in re.findall(r"-?\d+(?:\.\d+)?", line)] for line in lines]
    return [np.array(each[1:9]).reshape(4, 2) - 0.5 for each in numbers if len(each) >= 9]
