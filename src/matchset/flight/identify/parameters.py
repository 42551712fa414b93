"""How a flight that identifies a vehicle is flown: `IdentifyParameters`, `careful`."""

import msgspec

from matchset.control.follower import FollowerParameters
from matchset.flight.chain.excitation import ExcitationParameters
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.identify.estimate import EstimateParameters


class IdentifyParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Parameters of `matchset identify`.

    The follower's gains are low, since it knows neither the delay nor the thrust: before a ball that hangs still it
    need not be quick. Chosen on flights without pictures of seeds 0 to 29, vehicles drawn from +-20 % and latencies of
    33 to 200 ms, told 67: docs/log/control.md#identify.

    Parameters
    ----------
    duration : float
        Length of the flight, s. More finds more; a battery and a room are small.
    airborne : float
        Poses of the first so many s after the take-off do not count: a hand or the ground holds the vehicle. More is
        safer, less leaves more to count.
    level_gains, rise_gains : tuple of float
        Proportional, integral and derivative gains, 1/s^2, 1/s^3 and 1/s, of the level axes and of the height. Higher
        ones hold it closer to its place, and oscillate at long delays.
    delay : float
        Delay that it reckons with, s: the middle of what is likely, so that it is never far off.
    thrust_doubt, least_thrust : float
        `ThrustEstimatorParameters.initial_sigma` and `min_gain`: nothing is known of the throttle that hovers.
    most_throttle : float
        `SafetyParameters.max_throttle`: a heavy vehicle needs nearly all.
    earliest : float
        `MotionConsistencyParameters.min_delay`, s: how much less than `delay` the delay may be. Old pictures end the
        flight as any other.
    tilt, yaw : float
        `NeighborFilterParameters.tilt_sigma` and `yaw_sigma`, rad: with a wrong delay dead reckoning is off by that
        while the sticks are shaken. Less refuses the ball, more follows its noise.
    found : float
        A number is found if its standard deviation is less than this share of what it was before the flight.
    edge : float
        So close to a bound, in standard deviations before the flight, a number counts as not found.
    least_delay : float
        Shortest delay that is written, s: dead reckoning wants one.
    excitation : ExcitationParameters
        How the sticks are shaken, where the settings do not say so.
    estimate : EstimateParameters
    """

    duration: float = 10.0
    airborne: float = 0.8
    level_gains: tuple[float, float, float] = (1.2, 0.5, 1.8)
    rise_gains: tuple[float, float, float] = (2.5, 0.0, 3.5)
    delay: float = 0.08
    thrust_doubt: float = 0.5
    least_thrust: float = 0.58
    most_throttle: float = 1.0
    earliest: float = -0.1
    tilt: float = 0.06
    yaw: float = 0.06
    found: float = 0.5
    edge: float = 0.02
    least_delay: float = 0.001
    excitation: ExcitationParameters = ExcitationParameters()
    estimate: EstimateParameters = EstimateParameters()


def careful(flight: FlightParameters, parameters: IdentifyParameters) -> FlightParameters:
    """Return a flight with a follower that is slow, believes little and shakes its sticks; all else as it is.

    Parameters
    ----------
    flight : FlightParameters
    parameters : IdentifyParameters
    """
    replace, pilot = msgspec.structs.replace, flight.pilot
    pilot = replace(
        pilot,
        follower=_careful_follower(pilot.follower, parameters),
        safety=replace(pilot.safety, max_throttle=parameters.most_throttle),
        excitation=pilot.excitation or parameters.excitation,
    )
    return replace(flight, pilot=pilot)


def _careful_follower(follower: FollowerParameters, parameters: IdentifyParameters) -> FollowerParameters:
    replace, level, rise = msgspec.structs.replace, parameters.level_gains, parameters.rise_gains
    gains = ("proportional", "integral", "derivative")
    return replace(
        follower,
        horizontal=replace(follower.horizontal, **dict(zip(gains, level, strict=True))),
        vertical=replace(follower.vertical, **dict(zip(gains, rise, strict=True))),
        gain_schedule=replace(follower.gain_schedule, weight=0.0),
        ego_motion=replace(follower.ego_motion, delay=parameters.delay),
        motion_consistency=replace(follower.motion_consistency, min_delay=parameters.earliest),
        neighbor_filter=replace(follower.neighbor_filter, tilt_sigma=parameters.tilt, yaw_sigma=parameters.yaw),
        thrust_estimator=replace(
            follower.thrust_estimator, initial_sigma=parameters.thrust_doubt, min_gain=parameters.least_thrust
        ),
    )
