"""Fingers: capsules, each the hull of two discs, shaded like round limbs."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.sim.rendering.shutter import ALL_ROWS, ShutterRows

Picture = npt.NDArray[np.float32]
Array = npt.NDArray[np.float64]


class Capsule(NamedTuple):
    """The hull of two discs, px: centers and radii of both."""

    x0: float
    y0: float
    r0: float
    x1: float
    y1: float
    r1: float

    def covers(self, x: Array, y: Array) -> npt.NDArray[np.bool_]:
        """Which points, px, lie in it (the radius taken as linear along it)."""
        dx, dy = self.x1 - self.x0, self.y1 - self.y0
        along = np.clip(((x - self.x0) * dx + (y - self.y0) * dy) / max(dx * dx + dy * dy, 1e-12), 0.0, 1.0)
        distance = np.hypot(x - self.x0 - along * dx, y - self.y0 - along * dy)
        inside: npt.NDArray[np.bool_] = distance < self.r0 + along * (self.r1 - self.r0)
        return inside


def draw_capsules(
    picture: Picture, exposures: list[list[Capsule]], color: npt.ArrayLike, rows: ShutterRows = ALL_ROWS
) -> None:
    """Blend capsules over some rows of a picture, one after the other, in place.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    exposures : list of list of Capsule
        The capsules in each sub-exposure.
    color : array_like of shape (3,)
        BGR, where light falls straight on them.
    rows : ShutterRows
        Which rows to draw.
    """
    skin = np.asarray(color, np.float64)
    for places in zip(*exposures, strict=True):
        _draw_capsule(picture, np.array(places, np.float64), skin, (rows.start, rows.step))


@kernel
def _draw_capsule(picture: Picture, places: Array, color: Array, rows: tuple[int, int]) -> None:
    """Blend the mean of the sub-exposures of a capsule, (n, 6); light comes from the upper left and the camera."""
    left, top = np.inf, np.inf
    right, bottom = -np.inf, -np.inf
    for i in range(places.shape[0]):
        for k in range(0, 6, 3):
            x, y, r = places[i, k], places[i, k + 1], places[i, k + 2] + 1.0
            left, right, top, bottom = min(left, x - r), max(right, x + r), min(top, y - r), max(bottom, y + r)
    x0, x1 = int(max(left, 0.0)), int(min(right + 1.0, picture.shape[1] - 1.0))
    y0, y1 = int(max(top, 0.0)), int(min(bottom + 1.0, picture.shape[0] - 1.0))
    y0 += (rows[0] - y0) % rows[1]
    for y in range(y0, y1 + 1, rows[1]):
        for x in range(x0, x1 + 1):
            alpha, shade = 0.0, 0.0
            for i in range(places.shape[0]):
                inside, light = _lit(places[i], float(x), float(y))
                alpha += inside
                shade += inside * light
            if alpha > 0.0:
                shade /= alpha
                alpha /= places.shape[0]
                for k in range(3):
                    # Blood under the skin: dark parts are redder.
                    dim = shade if k == 2 else shade * (0.8 + 0.2 * shade)
                    picture[y, x, k] += alpha * (min(color[k] * dim, 255.0) - picture[y, x, k])


@kernel(refcount=False)
def _lit(place: Array, x: float, y: float) -> tuple[float, float]:
    """Share of a pixel that a capsule covers, and its brightness there."""
    dx, dy = place[3] - place[0], place[4] - place[1]
    along = ((x - place[0]) * dx + (y - place[1]) * dy) / max(dx * dx + dy * dy, 1e-12)
    along = min(max(along, 0.0), 1.0)
    off_x, off_y = x - place[0] - along * dx, y - place[1] - along * dy
    radius = place[2] + along * (place[5] - place[2])
    distance = np.sqrt(off_x * off_x + off_y * off_y)
    inside = min(max(radius - distance + 0.5, 0.0), 1.0)
    unit = 1.0 / max(radius, distance)
    nx, ny = off_x * unit, off_y * unit
    nz = np.sqrt(max(1.0 - nx * nx - ny * ny, 0.0))
    return inside, 0.45 + 0.6 * max(-0.35 * nx - 0.55 * ny + 0.75 * nz, 0.0)
