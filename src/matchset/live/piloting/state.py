"""What a page is told of a flight: `FlightState`; made of a step by `follower_states` and `map_state`."""

import itertools
import math
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.follower import RelativeSetpoint
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.chain.score import FollowerCounters
from matchset.flight.report.chain_frame import camera_positions, chain_frame_to_room, level_ball_frame
from matchset.flight.report.step_text import distance_to_set_place, reason_text
from matchset.live.piloting.commander import Duty
from matchset.live.piloting.fleet import FleetStep
from matchset.localization.pose import Pose
from matchset.sim.vehicle import VehiclePose
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]
Place = tuple[float, float]
"""x to the right and z ahead, m, of a place seen from above."""

MILLIMETERS = 3  # format: digits of a place on the map


class FollowerState(msgspec.Struct, frozen=True):
    """A row of the table.

    Parameters
    ----------
    phase : str
        Of the safety filter.
    reason : str
        Why it is not "flying", or why its gains are lowered; empty if neither is so.
    found : bool
        Whether it sees its neighbor's ball.
    losses, missing : int
        How many times it lost the ball, and pictures that did not come.
    age : float or None
        From capture to command, s; None before the first picture.
    distance, off : float or None
        Of the ball, and from the set place, m; None where it is not known.
    throttle : float
        What was sent, 0 ... 1.
    """

    phase: str
    reason: str
    found: bool
    losses: int
    missing: int
    age: float | None
    distance: float | None
    off: float | None
    throttle: float


class VehicleOnMap(msgspec.Struct, frozen=True):
    """Where a vehicle's ball is, and where its nose points: a unit vector."""

    at: Place
    nose: Place


class MapState(msgspec.Struct, frozen=True, omit_defaults=True):
    """The chain from above: in the room where the truth is known, else about the last ball.

    Parameters
    ----------
    vehicles : list of VehicleOnMap
        True places; only that of the last one, the origin, where no truth is known.
    cameras : list of (float, float) or None
        Where each follower's camera is by the poses measured along the chain; None where one of them is missing.
    places : list of (float, float)
        Where each should be, where the truth is known.
    """

    vehicles: list[VehicleOnMap] = []
    cameras: list[Place | None] = []
    places: list[Place] = []


class FlightState(msgspec.Struct, frozen=True, omit_defaults=True):
    """What there is to say of a flight.

    Parameters
    ----------
    ready : bool
        Whether everything is compiled and everybody is at the start.
    duty : str
        See `matchset.live.piloting.commander.Duty`.
    page : str
        Which page commands; empty: none.
    silent : float
        For how long it has not been heard, s; 0 if nobody commands.
    reason : str
        Why they come down, or have stopped.
    time : float
        Since the take-off, s.
    stop_delay : float or None
        From the order to stop the motors to the commands that did, s, on the clock of the pictures.
    fault : str
        Why nothing can be flown.
    followers : list of FollowerState
    map : MapState
    kernels : int
        Compiled so far while it gets ready; 0: all was kept on the disk.
    preparing : float
        For how long it has been getting ready, s; 0 when it is.
    """

    ready: bool = False
    duty: Duty = "idle"
    page: str = ""
    silent: float = 0.0
    reason: str = ""
    time: float = 0.0
    stop_delay: float | None = None
    fault: str = ""
    followers: list[FollowerState] = []
    map: MapState = MapState()
    kernels: int = 0
    preparing: float = 0.0


def follower_states(
    steps: Sequence[PilotStep], counters: Sequence[FollowerCounters], place: RelativeSetpoint
) -> list[FollowerState]:
    """Make the rows of the table.

    Parameters
    ----------
    steps : sequence of PilotStep
    counters : sequence of FollowerCounters
        Of all steps so far.
    place : RelativeSetpoint
        Where each should be beside its neighbor.
    """
    return [_row(step, each, place) for step, each in zip(steps, counters, strict=True)]


def _row(step: PilotStep, counters: FollowerCounters, place: RelativeSetpoint) -> FollowerState:
    safety, off = step.safety, distance_to_set_place(step.control, place)
    return FollowerState(
        phase=safety.phase,
        reason=reason_text(step),
        found=isinstance(step.ball, Track),
        losses=counters.losses,
        missing=counters.missing,
        age=round(step.age, MILLIMETERS) if math.isfinite(step.age) else None,
        distance=round(step.pose.distance, MILLIMETERS) if isinstance(step.pose, Pose) else None,
        off=None if off is None else round(off, MILLIMETERS),
        throttle=round(step.command.throttle, MILLIMETERS),
    )


def map_state(step: FleetStep, place: RelativeSetpoint) -> MapState:
    """Make the map of a step; `place` is where each should be beside its neighbor."""
    cameras = camera_positions(step.steps)
    if not step.truth:  # its z points back to the followers, and x to the left
        return MapState([VehicleOnMap((0.0, 0.0), (0.0, 1.0))], [None if at is None else _flat(-at) for at in cameras])
    last = step.truth[-1]
    return MapState(
        [VehicleOnMap(_flat(vehicle.ball), _flat(vehicle.rotation[:, 2])) for vehicle in step.truth],
        [None if at is None else _flat(chain_frame_to_room(at, last)) for at in cameras],
        [_flat(_set_place(other, place)) for _, other in itertools.pairwise(step.truth)],
    )


def _set_place(other: VehiclePose, place: RelativeSetpoint) -> Floats:
    at: Floats = other.ball + level_ball_frame(other) @ (place.side, -place.height, place.heading)
    return at


def _flat(point: Floats) -> Place:
    return round(float(point[0]), MILLIMETERS), round(float(point[2]), MILLIMETERS)
