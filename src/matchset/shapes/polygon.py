"""Polygons of a given form: `Polygon.of` makes a family for the tracker."""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.shapes.template import Affine, Motion, Similar, family_of

Floats = npt.NDArray[np.float64]
__all__ = ["Affine", "Polygon", "Similar", "convex_corners"]


class Polygon:
    """Triangles, stop signs, hexagons: convex polygons of a given form."""

    @staticmethod
    def of(vertices: npt.ArrayLike, motion: Motion = "similarity") -> type[Any]:
        """Make the family of a polygon.

        Parameters
        ----------
        vertices : array_like of shape (k, 2)
            Its corners in any unit, in order around it, x to the right and y down; k >= 3.
        motion : "similarity" or "affine"
            Whether it is only moved, turned and scaled, as before a camera that looks straight at it (4 parameters:
            `Similar`), or seen from the side too (6 parameters: `Affine`).

        Returns
        -------
        type
            A family for `Tracker` and `detect`.

        Raises
        ------
        ValueError
            If there are fewer than 3 vertices, they are not finite, or they do not go once around a convex polygon.

        Examples
        --------
        >>> import matchset as ms
        >>> Triangle = ms.Polygon.of([(0, 0), (4, 0), (0, 3)])
        >>> shape = Triangle(x=100.0, y=80.0, scale=20.0, angle=0.0)
        >>> shape.corners.round(1).tolist()
        [[73.3, 60.0], [153.3, 60.0], [73.3, 120.0]]
        """
        return family_of("Polygon", convex_corners(vertices, 3), motion)


def convex_corners(vertices: npt.ArrayLike, least: int) -> Floats:
    """Corners of a convex polygon in the order in which x turns to y; ValueError if they are none.

    Parameters
    ----------
    vertices : array_like of shape (k, 2)
    least : int
        How many there must be.
    """
    try:
        corners = np.array(vertices, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"vertices must be an array of shape (k, 2), got {vertices!r}") from None
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < least:
        raise ValueError(f"vertices must be at least {least} points, an array (k, 2), got shape {corners.shape}")
    if not np.isfinite(corners).all():
        raise ValueError(f"vertices must be finite, got {corners.tolist()}")
    before, after = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    around = np.arctan2(turn, (before * after).sum(axis=1)).sum() / (2.0 * np.pi)
    least_turn = 1e-9 * float(np.ptp(corners, axis=0).max()) ** 2
    if abs(abs(around) - 1.0) > 1e-6 or not ((turn > least_turn).all() or (turn < -least_turn).all()):
        raise ValueError(f"vertices must go once around a convex polygon, turning at each, got {corners.tolist()}")
    return corners if turn[0] > 0.0 else np.ascontiguousarray(corners[::-1])
