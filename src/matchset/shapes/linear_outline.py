"""Outlines that are linear in their state: the kernel that ellipses, templates and quadrilaterals share.

A place i of such an outline is ``p = sum of state[k] B[i, k]`` with fixed 2-vectors B, and the direction of the outline
there ``t = sum of state[k] T[i, k]``. So all these families need but one compiled step: what tells them apart stands in
the places that they hand to `trace`.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
FIRST = 2  # geometry: columns of a place before those of B and T: the cosine and sine of its angle around the center
SIMILAR, ELLIPTIC, AFFINE, FREE_CORNERS = 4, 5, 6, 8  # geometry: lengths of the states; they tell what `half_width` is


class SideParameters(msgspec.Struct, frozen=True):
    """Where lines cross the sides of an outline with corners.

    Chosen by hand; ``python -m benchmarks --only shapes`` would show a change.

    Parameters
    ----------
    corner_margin : float
        Share of a side, at each end, that no line crosses: blur rounds corners off.
    long_side : float
        Share of the whole outline from which on a side is long enough for that.
    """

    corner_margin: float = 0.07
    long_side: float = 0.1


DEFAULT = SideParameters()


@kernel
def trace(state: Floats, places: Floats, outline: Floats) -> None:
    """Outline of the state at places that `places_of` made; see `Shape.trace`."""
    s = state.shape[0]
    for line in range(outline.shape[0]):
        i = np.uintp(line)
        x = y = tx = ty = 0.0
        for k in range(s):
            at, value = np.uintp(FIRST + 4 * k), state[np.uintp(k)]
            x += value * places[i, at]
            y += value * places[i, at + np.uintp(1)]
            tx += value * places[i, at + np.uintp(2)]
            ty += value * places[i, at + np.uintp(3)]
        unit = 1.0 / max(math.sqrt(tx * tx + ty * ty), 1e-12)
        nx, ny = unit * ty, -unit * tx
        outline[i, 0], outline[i, 1], outline[i, 2], outline[i, 3] = x, y, nx, ny
        for k in range(s):
            at = np.uintp(FIRST + 4 * k)
            outline[i, np.uintp(4 + k)] = nx * places[i, at] + ny * places[i, at + np.uintp(1)]


@kernel
def half_width(state: Floats) -> float:
    """Radius of the circle of equal area, px; 0 where the outline is inside out or has a dent."""
    s = state.shape[0]
    if s == SIMILAR:
        return math.sqrt(state[2] * state[2] + state[3] * state[3])
    if s == ELLIPTIC:
        area, trace_of = state[2] * state[4] - state[3] * state[3], state[2] + state[4]
        return math.sqrt(area) if area > 0.0 and trace_of > 0.0 else 0.0
    if s == AFFINE:
        area = state[2] * state[5] - state[3] * state[4]
        return math.sqrt(area) if area > 0.0 else 0.0
    # Corners c + u a + v b + u v d with u, v = -1, 1: the turns at them are 4 (a x b + u a x d + v d x b).
    plain = state[2] * state[5] - state[3] * state[4]
    along = state[2] * state[7] - state[3] * state[6]
    across = state[6] * state[5] - state[7] * state[4]
    if 0.98 * plain <= abs(along) + abs(across):
        return 0.0
    return math.sqrt(4.0 * plain / math.pi)


def places_of(points: Floats, basis: Floats, tangents: Floats) -> Floats:
    """Join what `trace` is told of n places.

    Parameters
    ----------
    points : ndarray of shape (n, 2), float64
        Where they are in the template, as seen from its center.
    basis, tangents : ndarray of shape (n, s, 2), float64
        B and T.
    """
    n = len(points)
    around = points / np.maximum(np.hypot(points[:, 0], points[:, 1]), 1e-12)[:, np.newaxis]
    return np.column_stack((around, np.concatenate((basis, tangents), axis=2).reshape(n, -1)))


def along_sides(corners: Floats, n: int) -> tuple[Floats, Floats, Floats]:
    """Spread n places evenly over the sides of a polygon, and keep away from its corners, which blur rounds off.

    Parameters
    ----------
    corners : ndarray of shape (k, 2), float64
        Convex, in the order in which x turns to y.
    n : int

    Returns
    -------
    points, directions : ndarray of shape (n, 2), float64
        The places, and the unit vectors along their sides.
    shares : ndarray of shape (n,), float64
        Which side, and how far along it: 2.25 is a quarter along the third.
    """
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    ends = np.cumsum(lengths)
    way = ends[-1] * (np.arange(n) + 0.5) / n
    which = np.minimum(np.searchsorted(ends, way, side="right"), len(corners) - 1)
    share = (way - (ends - lengths)[which]) / lengths[which]
    away = np.where(lengths > DEFAULT.long_side * ends[-1], DEFAULT.corner_margin, 0.0)[which]
    share = away + (1.0 - 2.0 * away) * share
    return corners[which] + share[:, None] * sides[which], (sides / lengths[:, None])[which], which + share
