"""Whose vertical speed the pictures show at take-off: `attribute_vertical_speed`.

A picture shows the difference of two motions. With the ball at b in the level frame at rest, in which dead reckoning
believes the vehicle at p and moving with u, the camera measures b - p: a vehicle that rises by an unknown v faster than
believed sees a neighbor at rest that sinks by v. `NeighborFilter` takes all of that for the neighbor's motion. Where
the throttle that hovers is known to a fifth only, that is wrong for the first seconds: then the vertical speed of the
neighbor's drift is handed over, with a time constant T,

    d = -s dt / T,    s -> s + d,    u -> u + d,

which changes neither the measured difference of the speeds, s - u, nor any place.
"""

import math

import msgspec

from matchset.control.ego_motion import EgoMotion
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.parameter_checks import require_not_negative, require_positive


class TakeoffParameters(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    rename={"duration": "lasts", "time_constant": "handed"},
):
    """Parameters of a take-off; the key in a file is in parentheses where it is another one.

    Chosen on starts of 10 s without pictures, seeds 0 to 39, mass -20 % and all at once: docs/log.md, 2026-11-24.

    Parameters
    ----------
    duration : float
        Time from lift-off for which a vertical speed is the vehicle's own, s; 0 turns it off. More trusts that the
        neighbor keeps its height for longer; less leaves a wrong throttle that hovers to be learned with a wrong speed
        (``lasts``).
    time_constant : float
        Time constant T with which the neighbor's vertical speed is handed over, s. Less is sooner and noisier
        (``handed``).
    """

    duration: float = 1.5
    time_constant: float = 0.3

    def __post_init__(self) -> None:
        require_not_negative(self, ("duration",))
        require_positive(self, ("time_constant",))


def attribute_vertical_speed(
    own: EgoMotion, neighbor: NeighborFilter, lifted: float, since: float, parameters: TakeoffParameters
) -> None:
    """Hand the vertical speed of the neighbor's drift over to the vehicle, after a pose that was accepted.

    Parameters
    ----------
    own : EgoMotion
    neighbor : NeighborFilter
    lifted : float
        Time from lift-off to that pose, s; -inf if there was none.
    since : float
        Time since the pose before, s.
    parameters : TakeoffParameters
    """
    if not 0.0 <= lifted < parameters.duration:
        return
    speed = -neighbor.vertical_speed * (1.0 - math.exp(-since / parameters.time_constant))
    neighbor.add_vertical_speed(speed)
    own.add_vertical_speed(speed, neighbor.time)
