"""What people use today for ellipses: OpenCV's EdgeDrawing, on the gray frame or on a mask by color."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.shapes.contours import Method, color_range

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


class EllipseParameters(msgspec.Struct, frozen=True):
    """EdgeDrawing's parameters: the best on seeds 0-3, see `shapes_search`.

    Parameters
    ----------
    mask : bool
        Look at the mask by color instead of the gray frame.
    blur : int
        Side of the Gaussian blur before it, px; 0: none.
    gradient, anchor : int
        Least gradient of an edge, and by how much an anchor must stand out, gray levels.
    nearness : float
        How far from the last answer an ellipse may be, half-widths: center and semi-axes together.
    """

    mask: bool = True
    blur: int = 17
    gradient: int = 36
    anchor: int = 8
    nearness: float = 0.5


GRAY = EllipseParameters(mask=False, blur=13, gradient=12, anchor=2)
"""On the gray frame it answers less often, but what it answers is more exact."""

CHOICES: dict[str, tuple[bool | float, ...]] = {
    "mask": (True, False),
    "blur": (0, 5, 9, 13, 17, 25),
    "gradient": (12, 20, 36),
    "anchor": (2, 8),
    "nearness": (0.3, 0.5, 1.0),
}


def missing() -> str:
    """Say why EdgeDrawing cannot run here, empty if it can: only OpenCV's contrib wheel has it."""
    return "" if hasattr(cv2, "ximgproc") else "this OpenCV has no EdgeDrawing; `make bench` brings one that has"


def ellipse_method(
    case: str,  # noqa: ARG001
    image: Image,
    outline: Floats,
    parameters: EllipseParameters | None = None,
) -> Method:
    """Learn where the ellipse is and its range of colors from the first frame; what finds it in a frame.

    Of all ellipses of a frame the one nearest to the last answer is taken.

    Parameters
    ----------
    case : str
        Any: it finds ellipses.
    image : ndarray of shape (h, w, 3), uint8
    outline : ndarray of shape (k, 2)
        px.
    parameters : EllipseParameters, optional
    """
    from benchmarks.peers.edge_drawing import ellipse_detector

    chosen = parameters or EllipseParameters()
    low, high = color_range(image, outline)
    detect = ellipse_detector(chosen.gradient, chosen.anchor)
    (x, y), axes, _ = cv2.fitEllipse(outline.astype(np.float32))
    last = np.array([x, y, 0.5 * max(axes), 0.5 * min(axes)])

    def find(picture: Image) -> ms.Ellipse | None:
        nonlocal last
        if chosen.mask:
            gray = cv2.inRange(cv2.cvtColor(picture, cv2.COLOR_BGR2HSV), low, high)
        else:
            gray = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        if chosen.blur:
            gray = cv2.GaussianBlur(gray, (chosen.blur, chosen.blur), 0)
        found = detect(np.asarray(gray, np.uint8))
        found = found[found[:, 2:4].min(axis=1) > 0.0]
        if not len(found):
            return None
        places = np.column_stack((found[:, :2], found[:, 2:4].max(axis=1), found[:, 2:4].min(axis=1)))
        away = np.hypot(*(places - last)[:, :2].T) + np.abs(places - last)[:, 2:].sum(axis=1)
        best = int(away.argmin())
        if away[best] > chosen.nearness * last[2]:
            return None
        last = places[best]
        x, y, a, b, degrees = found[best].tolist()
        return ms.Ellipse(x, y, a, b, math.radians(degrees))

    return find
