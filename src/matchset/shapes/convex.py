"""Any convex outline: `Convex.of` makes a family from points, a picture of it, or its support function."""

import math
from collections.abc import Callable
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.shapes.template import Motion, family_of

Floats = npt.NDArray[np.float64]
STEPS = 360  # geometry: angles at which a support function is sampled


class ConvexParameters(msgspec.Struct, frozen=True):
    """What counts as convex.

    Chosen by hand; `tests/shapes/test_laws.py` would show a change.

    Parameters
    ----------
    least_filled : float
        Share of its hull that the outline in a picture must fill.
    """

    least_filled: float = 0.93


DEFAULT = ConvexParameters()


class Convex:
    """Leaves, eggs, half discs: any convex outline."""

    @staticmethod
    def of(
        points_or_mask: npt.ArrayLike | Callable[[Floats], npt.ArrayLike], motion: Motion = "similarity"
    ) -> type[Any]:
        """Make the family of an outline.

        Parameters
        ----------
        points_or_mask : array_like, or a function
            Points (k, 2) in any unit, x to the right and y down, whose hull is the outline; or a picture (h, w) of
            it, bool or uint8, nonzero inside; or its support function, which gives for angles (n,) from +x toward +y
            the distances of the outline's tangents from a point inside.
        motion : "similarity" or "affine"
            Whether it is only moved, turned and scaled (4 parameters), or seen from the side too (6 parameters).

        Returns
        -------
        type
            A family for `Tracker` and `detect`.

        Raises
        ------
        ValueError
            If it is none of them, holds numbers that are not finite, or is not convex.

        Examples
        --------
        >>> import numpy as np, matchset as ms
        >>> Egg = ms.Convex.of(lambda t: 10.0 + 2.0 * np.cos(t) + 0.7 * np.cos(2.0 * t))
        >>> Egg(x=100.0, y=80.0, scale=2.0, angle=0.0).corners.shape
        (360, 2)
        """
        if callable(points_or_mask):
            return family_of("Convex", _of_support(points_or_mask), motion)
        try:
            array = np.asarray(points_or_mask)
            points = array.astype(np.float64)
        except (TypeError, ValueError):
            raise ValueError(f"an outline is given by points (k, 2) or a picture, got {points_or_mask!r}") from None
        if array.ndim == 2 and array.dtype in (np.bool_, np.uint8) and array.shape[1] != 2:
            return family_of("Convex", _of_mask(array != 0), motion)
        if array.ndim != 2 or array.shape[1] != 2 or len(array) < 3:
            raise ValueError(f"an outline is given by 3 points or more, (k, 2), or a picture, got shape {array.shape}")
        if not np.isfinite(points).all():
            raise ValueError(f"points of an outline must be finite, got {points.tolist()}")
        return family_of("Convex", _hull(points), motion)


def _of_support(support: Callable[[Floats], npt.ArrayLike]) -> Floats:
    """Outline of a support function h: ``h (cos t, sin t) + h' (-sin t, cos t)``."""
    t = 2.0 * math.pi * np.arange(STEPS) / STEPS
    h = np.asarray(support(t), np.float64)
    if h.shape != t.shape or not np.isfinite(h).all():
        raise ValueError(f"a support function gives one finite number per angle, got shape {h.shape}: {h}")
    waves = np.fft.rfft(h) * 1j * np.arange(STEPS // 2 + 1)
    waves[-1] = 0.0
    slope = np.fft.irfft(waves, STEPS)
    points = np.column_stack((h * np.cos(t) - slope * np.sin(t), h * np.sin(t) + slope * np.cos(t)))
    sides = np.roll(points, -1, axis=0) - points
    size = float(np.abs(sides).max())
    along = -sides[:, 0] * np.sin(t) + sides[:, 1] * np.cos(t)
    if h.max() + np.roll(h, STEPS // 2)[h.argmax()] <= 0.0 or (along < -1e-2 * size).any():
        raise ValueError("this support function is of no convex outline: h + h'' must not be negative")
    return points if (along > 1e-9 * size).all() else _hull(points)


def _of_mask(mask: npt.NDArray[np.bool_]) -> Floats:
    """Hull of the largest region of a picture, by the middles of its pixels' sides."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    if not contours:
        raise ValueError(f"this picture, {mask.shape}, holds no outline: it is zero everywhere")
    largest = max(contours, key=len)[:, 0, :].astype(np.float64)
    around = np.array([(0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)])
    hull = _hull((largest[:, None] + around).reshape(-1, 2))
    region = np.zeros(mask.shape, np.uint8)
    cv2.drawContours(region, [largest.astype(np.int32).reshape(-1, 1, 2)], 0, 1, cv2.FILLED)
    filled = float(region.sum()) / max(cv2.contourArea(hull.astype(np.float32)), 1e-9)
    if filled < DEFAULT.least_filled:
        raise ValueError(f"the outline in this picture is not convex: it fills {100.0 * filled:.0f} % of its hull")
    return hull


def _hull(points: Floats) -> Floats:
    """Convex hull in the order in which x turns to y, corners that hardly turn left out."""
    single = points.astype(np.float32)
    hull = points[cv2.convexHull(single.reshape(-1, 1, 2), returnPoints=False)[:, 0]]
    if len(hull) < 3:
        raise ValueError(f"an outline needs an area, these points lie on a line: {points.tolist()[:8]}")
    a, b = hull - np.roll(hull, 1, axis=0), np.roll(hull, -1, axis=0) - hull
    turn = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    if turn.sum() < 0.0:
        hull, turn = hull[::-1], -turn[::-1]
    kept = np.ascontiguousarray(hull[turn > 1e-9 * float(np.ptp(hull, axis=0).max()) ** 2])
    if len(kept) < 3:
        raise ValueError(f"an outline needs an area, these points lie on a line: {points.tolist()[:8]}")
    return kept
