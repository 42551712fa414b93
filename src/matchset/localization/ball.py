"""What of a ball in the picture its place in space is taken from: `outline_of`, by `BallParameters`."""

import math
from functools import cached_property
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.localization import cone
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]

NOWHERE = np.empty((0, 0))
ANGLES = 2.0 * math.pi * np.arange(48) / 48
RIM = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
REASONS = {
    cone.FEW: "the lens model has no directions where the ball is seen",
    cone.FLAT: "the outline is not that of a ball",
    cone.NEAR: "the ball touches the camera",
}


class BallParameters(msgspec.Struct, frozen=True, dict=True):
    """How an outline becomes a place.

    Parameters
    ----------
    edge_shift : float
        By how much the outline lies outside its edge points, px. A ball gets darker or brighter toward its rim, which
        pulls edges inward by 0.03 to 0.07 px in rendered rooms; flat discs by 0.005. The default is the middle. To
        set it, hold the ball at two or more taped distances (see calibration). 0.1 px too much is 0.25 % of range at
        a radius of 40 px.
    least_points : int
        Edge points from which the cone is fitted to them; with fewer it is fitted to the circle.
    inflation : float
        By how much the covariance of independent edge points is enlarged, since neighbors err together: more is safer.
    floor : float
        Least standard deviation of an edge point that is believed, px.
    center_floor, size_floor : float
        Standard deviation of what shifts all edge points together (shading, blur, the grid of pixels), px.
    """

    edge_shift: float = 0.025
    least_points: int = 12
    inflation: float = 2.5
    floor: float = 0.02
    center_floor: float = 0.014
    size_floor: float = 0.025

    @cached_property
    def common(self) -> Floats:
        """Covariance of what shifts all edge points together, (3, 3), px^2."""
        return np.diag((self.center_floor**2, self.center_floor**2, self.size_floor**2))


class Outline(NamedTuple):
    """What `fit_cone` is told of an outline.

    Attributes
    ----------
    points : ndarray of shape (n, 2)
        px.
    spread : ndarray of shape (3, 3)
        Covariance of an error of x, y and size that all points share, px^2.
    numbers : tuple of float
        x and y of a point well inside, px; 1 if points may be wrong, else 0; `edge_shift`, inflation and floor.
    """

    points: Floats
    spread: Floats
    numbers: tuple[float, float, float, float, float, float]


def outline_of(track: Track[Circle], limits: BallParameters) -> Outline:
    """Outline of a ball: the match-set of its track, or with few points its circle, as if seen with no edge."""
    circle, points = track.shape, track.match_set
    if len(points) < limits.least_points:
        spread = np.array(track.covariance, np.float64)
        points = RIM * circle.radius + (circle.x, circle.y)
        return Outline(points, spread, (circle.x, circle.y, 0.0, limits.edge_shift, 0.0, limits.floor))
    numbers = circle.x, circle.y, 1.0, limits.edge_shift, limits.inflation, limits.floor
    if points.dtype != np.float64 or not points.flags.carray:  # to the compiler read-only arrays are another type
        points = np.array(points, np.float64, order="C")
    return Outline(points, limits.common, numbers)
