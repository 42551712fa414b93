"""Whose velocity the pictures show: `hand_over`.

A picture shows the difference of two motions. With the ball at b in the level frame at rest, in which dead reckoning
believes the vehicle at p and moving with u, the camera measures b - p: what both are believed to have in common is
never seen. `NeighborFilter` takes all that dead reckoning misses, a gust or a trim, for the neighbor's motion, so that
both are believed to move while they stand. While the ball is hidden that is flown. But a neighbor leaves its place for
a moment only, so the velocity s of its drift is handed over, with a time constant T,

    d = -s dt / T,    s -> s + d,    u -> u + d,

which changes neither the measured difference of the velocities, s - u, nor any place. At take-off the throttle that
hovers is known to a fifth only: then what looks like a neighbor that sinks is the vehicle's own climb, and T is short.
"""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from matchset.control.ego_motion import EgoMotion
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.neighbor_model import VERTICAL
from matchset.numeric.arguments import require_not_negative, require_positive


class CommonMotionParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How soon a motion in common is forgotten.

    Parameters
    ----------
    horizontal_time, vertical_time : float
        Time constant T, s. Less forgets sooner what dead reckoning did wrong, and takes more of a neighbor's slow
        motion for the vehicle's own. Chosen by: a hidden ball, and chains of ten, docs/log/control.md#gains-in-gusts.
    takeoff_duration : float
        Time from lift-off for which a vertical speed is the vehicle's own, s; 0 turns that off. More trusts that the
        neighbor keeps its height for longer; less leaves a wrong throttle that hovers to be learned with a wrong speed.
        Chosen on starts of 10 s, seeds 0 to 39: docs/log/control.md#take-off.
    takeoff_time : float
        Time constant T of the vertical speed meanwhile, s. Less is sooner and noisier. Chosen by the same.
    """

    horizontal_time: float = 3.0
    vertical_time: float = 10.0
    takeoff_duration: float = 1.5
    takeoff_time: float = 0.3

    def __post_init__(self) -> None:
        require_not_negative(self, ("takeoff_duration",))
        require_positive(self, ("horizontal_time", "vertical_time", "takeoff_time"))


def hand_over(
    own: EgoMotion,
    filters: Sequence[NeighborFilter],
    airborne_time: float,
    since: float,
    parameters: CommonMotionParameters,
) -> None:
    """Hand the velocity of the neighbor's drift over to the vehicle, after a pose that was accepted.

    Parameters
    ----------
    own : EgoMotion
    filters : sequence of NeighborFilter
        The neighbor's, and those of other balls in the same frame at rest.
    airborne_time : float
        Time from lift-off to that pose, s; -inf if there was none: nothing happens, a hand holds the vehicle.
    since : float
        Time since the pose before, s.
    parameters : CommonMotionParameters
    """
    if not airborne_time >= 0.0:
        return
    takes_off = airborne_time < parameters.takeoff_duration
    share = np.full(3, 1.0 - math.exp(-since / parameters.horizontal_time))
    share[VERTICAL] = 1.0 - math.exp(-since / (parameters.takeoff_time if takes_off else parameters.vertical_time))
    change = -filters[0].velocity * share
    for each in filters:
        each.add_velocity(change)
    own.add_velocity(change, filters[0].time)
