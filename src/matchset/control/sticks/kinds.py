"""What the sticks of a follower's vehicle mean, and how it is known that it flies: `sticks_for`, `lift_off_of`."""

from matchset.control.learned.thrust_estimator import ThrustEstimator, ThrustEstimatorParameters
from matchset.control.sticks.angle_sticks import AngleSticks, Sticks
from matchset.control.sticks.ego_parameters import GRAVITY, EgoMotionParameters
from matchset.control.sticks.speed_sticks import SpeedSticks, TakeOff


def sticks_for(model: EgoMotionParameters, min_tilt_cosine: float) -> Sticks:
    """Make what turns speeds or accelerations into sticks.

    Parameters
    ----------
    model : EgoMotionParameters
        The vehicle, as the follower takes it to be.
    min_tilt_cosine : float
        As `FollowerParameters.min_tilt_cosine`.
    """
    return SpeedSticks(model) if model.speed_commands else AngleSticks(model, min_tilt_cosine)


def lift_off_of(
    model: EgoMotionParameters, hover_throttle: float, takeoff: float, parameters: ThrustEstimatorParameters
) -> ThrustEstimator | TakeOff:
    """Make what knows of thrust and lift-off.

    Parameters
    ----------
    model : EgoMotionParameters
        The vehicle, as the follower takes it to be.
    hover_throttle : float
        The throttle that hovers, as far as is known.
    takeoff : float
        As `speeds.takeoff_duration` of the follower.
    parameters : ThrustEstimatorParameters
    """
    if model.speed_commands:
        return TakeOff(model.delay, takeoff)
    gravity = GRAVITY / model.effective_mass_ratio
    return ThrustEstimator(hover_throttle, gravity, model.delay, model.lift_lag, parameters)
