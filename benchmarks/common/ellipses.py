"""OpenCV's EdgeDrawing (the successor of EDCircles), driven: ellipses of an 8-bit picture."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from cv2 import ximgproc  # type: ignore[attr-defined]

from benchmarks.common.start import Circle3

Gray = npt.NDArray[np.uint8]


def ellipse_detector(gradient: int, anchor: int) -> Callable[[Gray], npt.NDArray[np.float64]]:
    """Set EdgeDrawing up, with its validation (NFA) on.

    Parameters
    ----------
    gradient, anchor : int
        Least gradient of an edge, and by how much an anchor must stand out, gray levels.

    Returns
    -------
    callable
        From a gray picture to ellipses, (k, 5): center, semi-axes, px, and angle of the first of them, degrees.
    """
    detector = ximgproc.createEdgeDrawing()
    settings = ximgproc.EdgeDrawing.Params()
    settings.EdgeDetectionOperator = ximgproc.EdgeDrawing_SOBEL
    settings.GradientThresholdValue, settings.AnchorThresholdValue = gradient, anchor
    settings.MinPathLength, settings.NFAValidation = 10, True
    detector.setParams(settings)

    def detect(gray: Gray) -> npt.NDArray[np.float64]:
        detector.detectEdges(gray)
        detector.detectLines()
        found = detector.detectEllipses()
        if found is None:
            return np.zeros((0, 5))
        e = np.asarray(found, np.float64).reshape(-1, 6)
        # Of the radius of a circle and the two semi-axes of an ellipse, one kind is 0.
        return np.column_stack((e[:, :2], e[:, 2:3] + e[:, 3:5], e[:, 5]))

    return detect


def edge_drawing(gradient: int, anchor: int) -> Callable[[Gray], list[Circle3]]:
    """Do the same, to circles: center and mean semi-axis of each ellipse, px."""
    detector = ellipse_detector(gradient, anchor)

    def detect(gray: Gray) -> list[Circle3]:
        return [(x, y, 0.5 * (a + b)) for x, y, a, b, _ in detector(gray).tolist()]

    return detect
