"""Where a ball might be: circles through the outlines of blobs, and circles of edges.

Every channel of the picture (lightness, the two chroma axes, distance from the commonest color) is cut at
several levels, as a blob detector does, and a circle is fitted to each blob's outline; Hough's transform adds
circles whose rim is an edge though their color is their surroundings'. Nothing is judged here.
"""

from collections.abc import Iterator

import cv2
import numpy as np
import numpy.typing as npt

CircleTuple = tuple[float, float, float]

_RADII_PX = (5.0, 200.0)
_LEVELS = 10


def propose_circles(lab: npt.NDArray[np.float32]) -> list[CircleTuple]:
    """Propose circles.

    Parameters
    ----------
    lab : ndarray of shape (h, w, 3), float32
        The picture in CIE Lab.

    Returns
    -------
    list of (x, y, radius)
        In px, many, in no useful order, but the same for the same picture.
    """
    return [circle for mask in _masks(lab) for circle in _outlines(mask)] + _hough(lab)


def _masks(lab: npt.NDArray[np.float32]) -> Iterator[npt.NDArray[np.uint8]]:
    common = np.median(lab.reshape(-1, 3), axis=0)
    distance = np.linalg.norm(lab[..., 1:] - common[1:], axis=2)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
    for channel in (lab[..., 0], lab[..., 1], lab[..., 2], distance):
        low, high = (float(value) for value in np.percentile(channel, (0.1, 99.9)))
        if high - low < 4.0:
            continue
        for level in np.linspace(low, high, _LEVELS + 2)[1:-1]:
            above = (channel > level).astype(np.uint8)
            for mask in (above, 1 - above):
                yield cv2.morphologyEx(mask, cv2.MORPH_OPEN, kernel).astype(np.uint8, copy=False)


def _outlines(mask: npt.NDArray[np.uint8]) -> Iterator[CircleTuple]:
    contours, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    side = max(mask.shape)
    for contour in contours:
        area = cv2.contourArea(contour)
        low, high = _RADII_PX
        if len(contour) < 20 or not 0.5 * low * low * np.pi < area < 1.5 * high * high * np.pi:
            continue
        hull_area = cv2.contourArea(cv2.convexHull(contour))
        if area < 0.6 * hull_area or area > 0.5 * side * side:
            continue
        circle = _fit(contour[:, 0, :].astype(np.float64))
        if circle is not None and low <= circle[2] <= high:
            yield circle


def _fit(points: npt.NDArray[np.float64]) -> CircleTuple | None:
    """Least-squares circle (Kasa), repeated without the points far from it."""
    kept = points
    for _ in range(4):
        if len(kept) < 12:
            return None
        middle = kept.mean(axis=0)
        shifted = kept - middle
        squares = (shifted**2).sum(axis=1)
        design = np.column_stack([shifted, np.ones(len(kept))])
        solution = np.linalg.lstsq(design, squares, rcond=None)[0]
        center = solution[:2] / 2.0
        radius = float(np.sqrt(max(solution[2] + (center**2).sum(), 1e-9)))
        off = np.abs(np.hypot(*(points - middle - center).T) - radius)
        kept = points[off < max(0.12 * radius, 1.5)]
    if len(kept) < 0.5 * len(points):
        return None
    return float(middle[0] + center[0]), float(middle[1] + center[1]), radius


def _hough(lab: npt.NDArray[np.float32]) -> list[CircleTuple]:
    lightness = lab[..., 0] - lab[..., 0].min()
    light = (255.0 / max(float(lightness.max()), 1.0) * lightness).astype(np.uint8)
    low, high = (round(radius) for radius in _RADII_PX)
    light = cv2.GaussianBlur(light, (0, 0), 1.5)
    found = cv2.HoughCircles(light, cv2.HOUGH_GRADIENT, 2, 12, param1=100, param2=50, minRadius=2 * low, maxRadius=high)
    if found is None:
        return []
    return [(float(x), float(y), float(radius)) for x, y, radius in found.reshape(-1, 3)[:40]]
