"""Regions of the coarse grid that look like the target, as convex outlines."""

import cv2
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

LEAST = 4.0  # area of a region that is worth a look, cells


def region_hulls(smooth: npt.NDArray[np.int32], stride: int, most: int) -> list[Floats]:
    """Find the regions of a grid of scores that are positive.

    Parameters
    ----------
    smooth : ndarray of shape (rows, columns), int32
        Scores, see `detect_grid`.
    stride : int
        Size of a cell, px.
    most : int
        How many at most.

    Returns
    -------
    list of ndarray of shape (m, 2), float64
        Hulls, px, largest first, in the order in which x turns to y.
    """
    contours, _ = cv2.findContours((smooth > 0).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    areas = [cv2.contourArea(contour) + 0.5 * len(contour) for contour in contours]
    order = sorted(range(len(contours)), key=lambda k: -areas[k])[:most]
    found = []
    for k in order:
        if areas[k] < LEAST or len(contours[k]) < 3:
            continue
        hull = cv2.convexHull(contours[k])[:, 0, :].astype(np.float64)
        if len(hull) < 3:
            continue
        low, high = hull.min(axis=0), hull.max(axis=0)
        middle, size = 0.5 * (low + high), 0.5 * (high - low)
        hull = middle + (hull - middle) * (size + 0.5) / np.maximum(size, 0.5)  # to the rim of the outermost cells
        hull *= stride
        hull += (0.25 * stride, 0.5 * stride)
        x, y = hull[:, 0], hull[:, 1]
        turns = float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
        found.append(hull if turns > 0.0 else np.ascontiguousarray(hull[::-1]))
    return found
