"""How a camera is turned on its vehicle, from balls at measured places: `fit_mount`.

The vehicle stands level. Directions u_i to a ball in the camera frame and v_i in the vehicle's are related by the
rotation R that is sought, ``v_i = R u_i``. Least squares over yaw, pitch and roll minimize

    sum_i |v_i x R u_i|^2 / s_i^2 + roll^2 / s_r^2,   s_i = tape / distance_i,

the last term since one place says nothing of the roll (Wahba's problem, 1965, with a prior). What the floor is off the
level is shared by all places, and comes to pitch and roll afterward.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from matchset.control.mount.camera_mount import mounting
from matchset.numeric.arguments import require_positive

Floats = npt.NDArray[np.float64]


class MountFitParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How exact a set-up is.

    Parameters
    ----------
    place_sigma : float
        Standard deviation of a measured place in each direction, m. Estimate: a tape measure and a plumb line.
    level_sigma : float
        Standard deviation of the vehicle's level and of its straight ahead, rad. Estimate: 4 mm on 0.5 m.
    roll_sigma : float
        Standard deviation of the roll before anything is measured, rad. Estimate: 5 degrees, mounted by eye.
    most_misfit : float
        Largest angle between a place as told and as seen, standard deviations: more, and it was measured wrong.
    """

    place_sigma: float = 0.01
    level_sigma: float = 0.008
    roll_sigma: float = 0.09
    most_misfit: float = 4.0

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)


class PlaceError(ValueError):
    """A ball is not where it was told to be, or not seen there."""


class PlacedBall(NamedTuple):
    """A ball at a measured place.

    Attributes
    ----------
    seen : (3,)
        Its center in the camera frame, m.
    told : (3,)
        The same in the vehicle's frame, from the lens: right, down, forward, m.
    """

    seen: Floats
    told: Floats


class FittedMount(NamedTuple):
    """How a camera is turned on its vehicle.

    Attributes
    ----------
    yaw, pitch, roll : float
        To the right, then up, then clockwise, rad.
    sigmas : tuple of 3 float
        Standard deviations of these, rad.
    misfits : tuple of float
        Angle between each place as told and as seen, rad.
    """

    yaw: float
    pitch: float
    roll: float
    sigmas: tuple[float, float, float]
    misfits: tuple[float, ...]


def fit_mount(balls: Sequence[PlacedBall], parameters: MountFitParameters | None = None) -> FittedMount:
    """Fit the rotation from camera to vehicle.

    Parameters
    ----------
    balls : sequence of PlacedBall
    parameters : MountFitParameters, optional

    Raises
    ------
    ValueError
        If there is none.
    PlaceError
        If one is not where it was told to be; a ValueError.
    """
    parameters = parameters or MountFitParameters()
    if not balls:
        raise ValueError("a mount needs a ball at one measured place or more")
    told = np.array([ball.told / math.hypot(*ball.told) for ball in balls])
    seen = np.array([ball.seen / math.hypot(*ball.seen) for ball in balls])
    weights = np.array([math.hypot(*ball.told) / parameters.place_sigma for ball in balls])

    def residuals(angles: Floats) -> Floats:
        across = np.cross(told, seen @ mounting(*angles.tolist()).T) * weights[:, np.newaxis]
        return np.append(across, angles[2] / parameters.roll_sigma)  # the last one is the prior of the roll

    fit = least_squares(residuals, np.zeros(3), jac="3-point", xtol=1e-12, ftol=1e-12, gtol=1e-12)
    angles = fit.x
    across = np.cross(told, seen @ mounting(*angles).T)
    misfits = tuple(np.sqrt((across**2).sum(axis=1)).tolist())
    for number, (misfit, weight) in enumerate(zip(misfits, weights.tolist(), strict=True), 1):
        if not misfit * weight <= parameters.most_misfit:
            raise PlaceError(f"the ball at place {number} is seen {math.degrees(misfit):.1f} degrees beside it")
    variances = np.diag(np.linalg.inv(fit.jac.T @ fit.jac)) + parameters.level_sigma**2
    yaw, pitch, roll = angles.tolist()
    return FittedMount(yaw, pitch, roll, tuple(np.sqrt(variances).tolist()), misfits)


class MarkerPlace(NamedTuple):
    """Where a marker is on its ball, seen from a vehicle that stands straight behind it.

    Attributes
    ----------
    yaw, elevation : float
        To the right of the back, as seen from behind, and above the equator, rad.
    """

    yaw: float
    elevation: float


def marker_place(direction: Floats, mount: FittedMount) -> MarkerPlace:
    """Find a marker's place on its ball from its direction.

    Parameters
    ----------
    direction : ndarray of shape (3,)
        Out of the ball through its marker, in the camera frame; the ball's vehicle stands level and parallel.
    mount : FittedMount
    """
    right, down, forward = (mounting(mount.yaw, mount.pitch, mount.roll) @ direction).tolist()
    return MarkerPlace(math.atan2(right, -forward), math.atan2(-down, math.hypot(right, forward)))
