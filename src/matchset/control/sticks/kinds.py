"""What the sticks of a follower's vehicle mean, and how it is known that it flies: `sticks_for`, `kind_of`."""

from typing import TYPE_CHECKING

from matchset.control.learned.thrust_estimator import ThrustEstimator
from matchset.control.sticks.angle_sticks import AngleSticks, Sticks
from matchset.control.sticks.ego_parameters import GRAVITY
from matchset.control.sticks.speed_sticks import SpeedSticks, TakeOff

if TYPE_CHECKING:
    from matchset.control.follower import FollowerParameters


def sticks_for(follower: "FollowerParameters") -> Sticks:
    """Make what turns speeds or accelerations into sticks.

    Parameters
    ----------
    follower : FollowerParameters
        As in use.
    """
    model = follower.ego_motion
    return SpeedSticks(model) if model.speed_commands else AngleSticks(model, follower.min_tilt_cosine)


def kind_of(follower: "FollowerParameters") -> tuple[Sticks, ThrustEstimator | TakeOff]:
    """Make what turns speeds or accelerations into sticks, and what knows of thrust and lift-off.

    Parameters
    ----------
    follower : FollowerParameters
        As in use.
    """
    model, hover = follower.ego_motion, follower.hover_throttle
    if model.speed_commands:
        return sticks_for(follower), TakeOff(model.delay, follower.speeds.takeoff_duration)
    gravity = GRAVITY / model.effective_mass_ratio
    thrust = ThrustEstimator(hover, gravity, model.delay, model.lift_lag, follower.thrust_estimator)
    return sticks_for(follower), thrust
