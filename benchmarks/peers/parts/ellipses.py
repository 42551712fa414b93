"""OpenCV's EdgeDrawing (the successor of EDCircles), driven: ellipses of an 8-bit picture."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from cv2 import ximgproc  # type: ignore[attr-defined]

from benchmarks.peers.parts.start import Circle3

Gray = npt.NDArray[np.uint8]


def edge_drawing(gradient: int, anchor: int) -> Callable[[Gray], list[Circle3]]:
    """Set EdgeDrawing up, with its validation (NFA) on.

    Parameters
    ----------
    gradient, anchor : int
        Least gradient of an edge, and by how much an anchor must stand out, gray levels.

    Returns
    -------
    callable
        From a gray picture to circles: center and mean semi-axis of each ellipse, px.
    """
    detector = ximgproc.createEdgeDrawing()
    settings = ximgproc.EdgeDrawing.Params()
    settings.EdgeDetectionOperator = ximgproc.EdgeDrawing_SOBEL
    settings.GradientThresholdValue, settings.AnchorThresholdValue = gradient, anchor
    settings.MinPathLength, settings.NFAValidation = 10, True
    detector.setParams(settings)

    def detect(gray: Gray) -> list[Circle3]:
        detector.detectEdges(gray)
        detector.detectLines()
        found = detector.detectEllipses()
        if found is None:
            return []
        # Of the radius of a circle and the two semi-axes of an ellipse, one kind is 0.
        return [(float(e[0]), float(e[1]), float(e[2] + (e[3] + e[4]) / 2.0)) for e in found.reshape(-1, 6)]

    return detect
