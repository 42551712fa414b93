"""One frame for all of a chain, at rest in the room or fixed to the last ball: only for display.

What the cameras see composes to the level frame of the last ball (`localization/chain.py`); where that ball is in the
room only the simulator's truth knows.
"""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from matchset.app.flight.pilot import PilotStep
from matchset.localization.chain import FACING_AWAY, seen_from_last
from matchset.sim.vehicle import BACKWARD, VehiclePose

Floats = npt.NDArray[np.float64]


def level_ball_frame(sight: VehiclePose) -> Floats:
    """Matrix from the level frame of a vehicle's ball to the room, (3, 3): z where the marker points, y down."""
    out = sight.rotation @ BACKWARD
    yaw = math.atan2(-out[0], -out[2])
    c, s = math.cos(yaw), math.sin(yaw)
    level: Floats = np.array(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c))) @ FACING_AWAY
    return level


def room_to_chain_frame(point: Floats, last: VehiclePose) -> Floats:
    """Express a point of the room in the level frame of the last ball, (3,), m."""
    seen: Floats = (point - last.ball) @ level_ball_frame(last)
    return seen


def chain_frame_to_room(point: Floats, last: VehiclePose) -> Floats:
    """Express a point of the level frame of the last ball in the room, (3,), m."""
    there: Floats = last.ball + level_ball_frame(last) @ point
    return there


def camera_positions(steps: Sequence[PilotStep]) -> list[Floats | None]:
    """Where the cameras are by what they see, in the level frame of the last ball, each (3,), m.

    Parameters
    ----------
    steps : sequence of PilotStep
        One per follower, in the order of the chain.

    Returns
    -------
    list of ndarray or None
        None from the last gap of the chain on forward.
    """
    places = seen_from_last([step.pose for step in steps])
    return [None if place is None else place.position for place in places]
