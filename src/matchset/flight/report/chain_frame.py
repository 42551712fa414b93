"""The common frame of a chain: the level frame of the last vehicle's ball (decision 061); for display and reports.

The poses that the followers measure compose along the chain to this frame (`localization/chain.py`). Where the last
ball is in the room only the simulator's truth knows.
"""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from matchset.flight.chain.chain_step import FlightSetup
from matchset.flight.chain.pilot import PilotStep
from matchset.localization.chain import FACING_AWAY, seen_from_last
from matchset.localization.pose import Pose
from matchset.sim.vehicle import BACKWARD, VehiclePose

Floats = npt.NDArray[np.float64]


def level_ball_frame(vehicle: VehiclePose) -> Floats:
    """Matrix from the level frame of a vehicle's ball to the room, (3, 3): z where the marker points, y down."""
    out = vehicle.rotation @ BACKWARD
    yaw = math.atan2(-out[0], -out[2])
    c, s = math.cos(yaw), math.sin(yaw)
    level: Floats = np.array(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c))) @ FACING_AWAY
    return level


def room_to_chain_frame(point: Floats, last: VehiclePose) -> Floats:
    """Express a point of the room in the level frame of the last ball, (3,), m."""
    position: Floats = (point - last.ball) @ level_ball_frame(last)
    return position


def chain_frame_to_room(point: Floats, last: VehiclePose) -> Floats:
    """Express a point of the level frame of the last ball in the room, (3,), m."""
    position: Floats = last.ball + level_ball_frame(last) @ point
    return position


def camera_positions(steps: Sequence[PilotStep]) -> list[Floats | None]:
    """Estimate the positions of the cameras from the poses along the chain, in the level frame of the last ball.

    Parameters
    ----------
    steps : sequence of PilotStep
        One per follower, in the order of the chain.

    Returns
    -------
    list of ndarray or None
        Each (3,), m; None for every follower before one that measured no pose.
    """
    poses = seen_from_last([step.pose for step in steps])
    return [None if pose is None else pose.position for pose in poses]


def set_places(setup: FlightSetup) -> list[Floats | None]:
    """Return where the cameras are in the level frame of the last ball, each at its set place and looking straight on.

    Parameters
    ----------
    setup : FlightSetup

    Returns
    -------
    list of ndarray or None
        Each (3,), m, in the order of the chain.
    """
    place = setup.parameters.pilot.place
    position = np.array((place.side, place.height, place.heading))
    pose = Pose(position=position, rotation_matrix=FACING_AWAY, covariance=np.zeros((6, 6)), observed="level", time=0.0)
    found = seen_from_last([pose] * setup.followers)
    return [None if each is None else each.position for each in found]
