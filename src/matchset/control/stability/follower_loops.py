"""The level, height and yaw loop of a follower, made of its parameters: `FollowerLoops`."""

from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.chain.gain_schedule import Gains
from matchset.control.neighbor_model import VERTICAL, NeighborFilterParameters
from matchset.control.pid import PidParameters
from matchset.control.stability.loop import (
    AxisControl,
    FilterGains,
    Loop,
    Timing,
    Vehicle,
    horizontal_speed_vehicle,
    horizontal_vehicle,
    open_loop,
    vertical_speed_vehicle,
    vertical_vehicle,
    yaw_vehicle,
)
from matchset.control.sticks.ego_parameters import EgoMotionParameters

Floats = npt.NDArray[np.float64]

LEVEL, RISE, YAW = LOOPS = ("level", "rise", "yaw")
"""The loops of a follower: both level axes, height, bearing."""


class LoopParameters(NamedTuple):
    """What of a follower's parameters does not change in flight; as in `FollowerParameters`."""

    vertical: PidParameters
    yaw: PidParameters
    horizontal_lead: float
    vertical_lead: float
    oscillation_feedforward: float
    drift_feedforward: float
    ego_motion: EgoMotionParameters
    neighbor_filter: NeighborFilterParameters
    max_extrapolation: float


class LoopConditions(NamedTuple):
    """What this flight shows.

    Attributes
    ----------
    gains : Gains
        That the schedule has chosen.
    timing : Timing
    filter_gains : ndarray of shape (3, 5)
        By which the neighbor's filter corrects x, y and z: they follow the noise of the poses.
    thrust : float
        Vertical acceleration over what is believed, no unit.
    tilt : float
        The same of level accelerations and of the yaw rate.
    """

    gains: Gains
    timing: Timing
    filter_gains: Floats
    thrust: float = 1.0
    tilt: float = 1.0


def lowered(pid: PidParameters, factor: float) -> PidParameters:
    """Lower P, I and D by a factor, 0 ... 1; with 1 it is the same object."""
    if factor == 1.0:
        return pid
    return msgspec.structs.replace(
        pid,
        proportional=factor * pid.proportional,
        integral=factor * pid.integral,
        derivative=factor * pid.derivative,
    )


class FollowerLoops:
    """Cuts a follower's loops open.

    The integrals count with the gain that remains in the end, `PidParameters.integral_floor`. Of both level axes that
    one counts whose filter corrects more, which leaves less margin; the yaw loop sees the ball's direction through it.

    Parameters
    ----------
    parameters : LoopParameters
    """

    def __init__(self, parameters: LoopParameters) -> None:
        self.parameters = parameters

    def loop(self, name: str, conditions: LoopConditions, factor: float = 1.0) -> Loop:
        """Cut a loop open.

        Parameters
        ----------
        name : str
            One of `LOOPS`.
        conditions : LoopConditions
        factor : float
            By which its gains are lowered, see `lowered`.
        """
        neighbor, gains = self.parameters.neighbor_filter, conditions.filter_gains
        level = max((gains[0], gains[2]), key=lambda each: float(each[0] + each[3]))
        seen = FilterGains(gains[VERTICAL] if name == RISE else level, neighbor, neighbor.acceleration_time)
        control, vehicle = self._axis(name, conditions)
        control = control._replace(pid=lowered(control.pid, factor))
        return open_loop(control, vehicle, seen, conditions.timing)

    def _axis(self, name: str, conditions: LoopConditions) -> tuple[AxisControl, Vehicle]:
        """Return controllers and vehicle of a loop."""
        known, gains, model = self.parameters, conditions.gains, self.parameters.ego_motion
        told = model.speed_commands
        if name == LEVEL:
            time, lead = model.speed_time if told else 1.0, known.horizontal_lead
            swing, drift = time * known.oscillation_feedforward, time * known.drift_feedforward
            control = AxisControl(gains.horizontal, lead, gains.horizontal_feedforward, swing, drift, float(told))
            return control, (horizontal_speed_vehicle if told else horizontal_vehicle)(model, conditions.tilt)
        if name == RISE:
            drift, lead = (model.rise_time if told else 1.0) * gains.vertical_drift_feedforward, known.vertical_lead
            control = AxisControl(known.vertical, lead, gains.vertical_feedforward, 0.0, drift, float(told))
            return control, (vertical_speed_vehicle if told else vertical_vehicle)(model, conditions.thrust)
        return AxisControl(known.yaw), yaw_vehicle(model, conditions.tilt)
