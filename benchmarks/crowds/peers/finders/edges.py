"""Edge Drawing of OpenCV's contributions and the ellipses in its edges, of which those of the clicked color stay."""

from typing import Any

import cv2
import numpy as np

import matchset as ms
from benchmarks.crowds.peers.finders.color_range import Bytes, Range
from benchmarks.crowds.peers.peer import Detection, Find

NUMBERS = 6  # of an ellipse: x, y, radius of a circle or 0, half axes or 0, angle


def start(image: Bytes, circle: ms.Circle, parameters: dict[str, Any]) -> Find:
    """Learn the color; `round`: least ratio of the axes, `colored`: least share of its disc in the clicked color."""
    colors = Range(image, circle, parameters)
    contributed: Any = vars(cv2)["ximgproc"]  # not in every build
    drawing = contributed.createEdgeDrawing()
    settings = contributed.EdgeDrawing.Params()
    settings.GradientThresholdValue = parameters["gradient"]
    settings.AnchorThresholdValue = parameters["anchor"]
    settings.MinPathLength = parameters["path"]
    settings.NFAValidation = parameters["validated"]
    drawing.setParams(settings)

    def find(picture: Bytes) -> list[Detection]:
        mask = colors.mask(picture)
        drawing.detectEdges(mask if parameters["on"] == "mask" else _gray(picture))
        ellipses = drawing.detectEllipses()
        found: list[Detection] = []
        rows = np.zeros((0, NUMBERS)) if ellipses is None else np.asarray(ellipses, float).reshape(-1, NUMBERS)
        for x, y, radius, long, short, _ in rows.tolist():
            axes = (radius, radius) if radius > 0.0 else (max(long, short), min(long, short))
            mean = (axes[0] * axes[1]) ** 0.5
            if mean < parameters["least"] * circle.radius or axes[1] < parameters["round"] * axes[0]:
                continue
            share = _share(mask, x, y, mean)
            if share > parameters["colored"]:
                found.append((x, y, mean, share))
        return _apart(found)

    return find


def _gray(picture: Bytes) -> Bytes:
    return picture if picture.ndim == 2 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)


def _share(mask: Bytes, x: float, y: float, radius: float) -> float:
    """Share of a disc that is in a mask."""
    left, top = max(int(x - radius), 0), max(int(y - radius), 0)
    part = mask[top : int(y + radius) + 2, left : int(x + radius) + 2]
    rows, columns = np.indices(part.shape)
    inside = np.hypot(columns + left - x, rows + top - y) < radius
    return float((part[inside] > 0).mean()) if inside.any() else 0.0


def _apart(found: list[Detection]) -> list[Detection]:
    """Leave one of several on one ball: the inner and the outer side of an edge are found both."""
    kept: list[Detection] = []
    for each in sorted(found, key=lambda one: -one[3]):
        if all(np.hypot(each[0] - other[0], each[1] - other[1]) > 0.5 * max(each[2], other[2]) for other in kept):
            kept.append(each)
    return kept
