"""Sticks that are angles and thrust, as of toys and flight controllers: `AngleSticks`."""

import math
from typing import NamedTuple, Protocol

from matchset.control.command import Command, clip
from matchset.control.safety import DesiredCommand
from matchset.control.sticks.ego_parameters import GRAVITY, AttitudeCommand, EgoMotionParameters, SpeedCommand


class WantedMotion(NamedTuple):
    """What the controllers of a follower want: accelerations, m/s^2, or speeds, m/s; of the yaw a rate, rad/s.

    Attributes
    ----------
    right, forward, up, yaw : float
    """

    right: float
    forward: float
    up: float
    yaw: float


class Sticks(Protocol):
    """The contract of what sticks mean.

    Attributes
    ----------
    hold_throttle : float
        Throttle that holds the height by itself; NaN where the throttle is thrust.
    """

    hold_throttle: float

    def horizontal(self, wanted: float) -> float:
        """Return the roll or pitch stick, without its ends, for what a level controller wants."""
        ...

    def vertical(self, wanted: float) -> float:
        """Return what is added to the throttle that hovers, as a share of it, for what is wanted upward."""
        ...

    def feedforward(self, speed: float, acceleration: float, upward: bool = False) -> float:
        """Return what is flown beside the controllers' outputs, for a speed and an acceleration of the set place."""
        ...

    def command(self, wanted: WantedMotion, hover: float, most: float, tilt: tuple[float, float]) -> DesiredCommand:
        """Return the sticks for what the controllers want.

        Parameters
        ----------
        wanted : WantedMotion
        hover : float
            Throttle that hovers.
        most : float
            Largest roll and pitch stick; 0 before lift-off.
        tilt : tuple of float
            Roll and pitch of the vehicle when the command acts, rad.
        """
        ...

    def modeled_command(self, command: Command, trim: WantedMotion, hover: float) -> AttitudeCommand | SpeedCommand:
        """Return what dead reckoning is told of a command, without what only holds the vehicle still."""
        ...


class AngleSticks:
    """Sticks that are angles and thrust.

    Parameters
    ----------
    model : EgoMotionParameters
    min_tilt_cosine : float
        Least cosine of the tilt over which the throttle is divided.
    """

    hold_throttle = math.nan

    def __init__(self, model: EgoMotionParameters, min_tilt_cosine: float) -> None:
        self._model, self._least = model, min_tilt_cosine
        self._gravity = GRAVITY / model.effective_mass_ratio
        self._upright = 1.0  # cosine of the tilt at which the last command acts

    def horizontal(self, wanted: float) -> float:
        """Return the stick of the tilt that accelerates as wanted, m/s^2."""
        return math.atan(wanted / self._gravity) / self._model.full_tilt

    def vertical(self, wanted: float) -> float:
        """Return the share of the lift that accelerates as wanted, m/s^2."""
        return wanted / self._gravity

    def feedforward(self, speed: float, acceleration: float, upward: bool = False) -> float:  # noqa: ARG002
        """Return the acceleration: that of the set place."""
        return acceleration

    def command(self, wanted: WantedMotion, hover: float, most: float, tilt: tuple[float, float]) -> DesiredCommand:
        """Return the tilts and the thrust that accelerate as wanted; see `Sticks.command`."""
        self._upright = max(math.cos(tilt[0]) * math.cos(tilt[1]), self._least)
        return DesiredCommand(
            clip(self.horizontal(wanted.right), -most, most),
            clip(self.horizontal(wanted.forward), -most, most),
            wanted.yaw / self._model.full_yaw_rate if most else 0.0,
            hover * (1.0 + self.vertical(wanted.up)) / self._upright,
        )

    def modeled_command(self, command: Command, trim: WantedMotion, hover: float) -> AttitudeCommand:
        """Return tilt, yaw rate and lift of a command without its trim; none without thrust."""
        model, gravity = self._model, self._gravity
        if not command.throttle > 0.0:
            return AttitudeCommand()
        return AttitudeCommand(
            model.full_tilt * command.roll - math.atan(trim.right / gravity),
            model.full_tilt * command.pitch - math.atan(trim.forward / gravity),
            model.full_yaw_rate * command.yaw - trim.yaw,
            gravity * (command.throttle * self._upright / hover - 1.0),
        )
