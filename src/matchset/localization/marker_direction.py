"""From a marker in the picture to its direction on the ball: its ray, cut with the sphere."""

import math

import numpy as np
import numpy.typing as npt

from matchset.camera.lens import fold, undistort
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]

PIXEL, SHARE = 0.1, 1e-4  # steps of the derivatives: px, and of the distance
GRAZING = 0.2  # least cosine between the marker's direction and its line of sight: 78 degrees


@kernel
def _cut(intrinsics: Floats, widest: float, x: float, y: float, position: Floats, reach: float, out: Floats) -> bool:
    """Write the unit vector from `position` to where the ray of a pixel first comes within `reach` of it."""
    u, v, seen = undistort(intrinsics, widest, x, y)
    if not seen:
        return False
    scale = 1.0 / math.sqrt(u * u + v * v + 1.0)
    rx, ry, rz = u * scale, v * scale, scale
    along = rx * position[0] + ry * position[1] + rz * position[2]
    square = position[0] ** 2 + position[1] ** 2 + position[2] ** 2
    depth = along * along - square + reach * reach
    if not depth > (GRAZING * reach) ** 2:
        return False
    t = along - math.sqrt(depth)
    out[0], out[1], out[2] = (
        (t * rx - position[0]) / reach,
        (t * ry - position[1]) / reach,
        (t * rz - position[2]) / reach,
    )
    return True


@kernel
def place_marker(
    intrinsics: Floats, x: float, y: float, position: Floats, reach: float, direction: Floats, slopes: Floats
) -> bool:
    """Direction of a marker from the ball's center.

    Parameters
    ----------
    intrinsics : (9,)
        See `lens.py`.
    x, y : float
        Middle of the marker's rim in the picture, px.
    position : (3,)
        The ball's center, camera frame, m.
    reach : float
        How far the middle of the rim is from there, m.
    direction : (3,), written
        Unit vector, camera frame.
    slopes : (3, 5), written
        Its derivatives to x, y (per px) and to the position (per m).

    Returns
    -------
    bool
        Whether the ray meets the ball well inside its outline.
    """
    widest = fold(intrinsics[4], intrinsics[5], intrinsics[8])
    if not _cut(intrinsics, widest, x, y, position, reach, direction):
        return False
    moved, one, other = position.copy(), np.empty(3), np.empty(3)
    far = math.sqrt(position[0] ** 2 + position[1] ** 2 + position[2] ** 2)
    for k in range(5):
        step = PIXEL if k < 2 else SHARE * far
        dx, dy = (step if k == 0 else 0.0), (step if k == 1 else 0.0)
        for side in range(2):
            sign = 1.0 - 2.0 * side
            if k > 1:
                moved[k - 2] = position[k - 2] + sign * step
            if not _cut(intrinsics, widest, x + sign * dx, y + sign * dy, moved, reach, one if side == 0 else other):
                return False
            if k > 1:
                moved[k - 2] = position[k - 2]
        for m in range(3):
            slopes[m, k] = (one[m] - other[m]) / (2.0 * step)
    return True
