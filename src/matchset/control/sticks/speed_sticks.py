"""Sticks that are speeds, which the vehicle holds by itself, as of a Tello: `SpeedSticks`, `TakeOff`.

Its level speed goes over to the one that is told with the time T, ``v' = (u - v) / T``, so the told speed

    u = v_set + T a_set + P (p_set - p) + D (v_set - v) + trim

accelerates it by ``a_set + (P (p_set - p) + (1 + D) (v_set - v)) / T``: v_set alone already damps. All of it is taken
for the time at which the command acts. There is no throttle that hovers: half of it stands still.
"""

import math

from matchset.control.command import HOLD, Command, clip
from matchset.control.safety import DesiredCommand
from matchset.control.sticks.angle_sticks import WantedMotion
from matchset.control.sticks.ego_parameters import EgoMotionParameters, SpeedCommand

MOST_RISE = 0.98  # format: of the throttle's way from HOLD to its ends; all of it means that a toy has no thrust left
LIFTS = 0.9  # format: share of HOLD from which on a vehicle takes off


class SpeedSticks:
    """Sticks that are speeds.

    Parameters
    ----------
    model : EgoMotionParameters
    """

    hold_throttle = HOLD

    def __init__(self, model: EgoMotionParameters) -> None:
        self._model = model

    def horizontal(self, wanted: float) -> float:
        """Return the stick of a level speed, m/s."""
        return wanted / self._model.full_speed

    def vertical(self, wanted: float) -> float:
        """Return the share of the throttle that gives a speed upward, m/s."""
        return wanted / self._model.full_rise

    def feedforward(self, speed: float, acceleration: float, upward: bool = False) -> float:
        """Return the speed that leads to that of the set place in spite of the lag."""
        model = self._model
        return speed + (model.rise_time if upward else model.speed_time) * acceleration

    def command(self, wanted: WantedMotion, hover: float, most: float, tilt: tuple[float, float]) -> DesiredCommand:  # noqa: ARG002
        """Return the sticks of speeds; before lift-off those that stand still. See `Sticks.command`."""
        if not most:
            return DesiredCommand(0.0, 0.0, 0.0, HOLD)
        return DesiredCommand(
            clip(self.horizontal(wanted.right), -most, most),
            clip(self.horizontal(wanted.forward), -most, most),
            wanted.yaw / self._model.full_yaw_rate,
            HOLD + HOLD * clip(self.vertical(wanted.up), -MOST_RISE, MOST_RISE),
        )

    def modeled_command(self, command: Command, trim: WantedMotion, hover: float) -> SpeedCommand:  # noqa: ARG002
        """Return the speeds of a command without their trim; none before lift-off, where it stands."""
        model = self._model
        if not command.throttle > 0.0:
            return SpeedCommand()
        return SpeedCommand(
            model.full_speed * command.roll - trim.right,
            model.full_speed * command.pitch - trim.forward,
            model.full_yaw_rate * command.yaw - trim.yaw,
            model.full_rise * (command.throttle - HOLD) / HOLD - trim.up,
        )


class TakeOff:
    """When a vehicle that is told speeds flies: it takes off by itself, and hovers at half of the throttle.

    It stands in place of a `ThrustEstimator`: there is no thrust to be learned.

    Parameters
    ----------
    delay : float
        From sending a command to its first effect, s.
    duration : float
        How long its own take-off takes, s.

    Attributes
    ----------
    gain, sigma : float
        1 and 0: the throttle that hovers is known.
    delay : float
        s.
    lift_time : float
        When sticks begin to count, s; inf before take-off.
    airborne : bool
        Whether a picture was seen after that.
    """

    gain, sigma = 1.0, 0.0

    def __init__(self, delay: float, duration: float) -> None:
        self.delay, self._duration = delay, duration
        self.reset()

    def reset(self) -> None:
        """Forget everything: it is on the ground."""
        self.lift_time, self.airborne = math.inf, False

    def sent(self, throttle: float, now: float) -> None:
        """Note a throttle that was sent, 0 ... 1, and when, s."""
        if self.lift_time == math.inf and throttle >= LIFTS * HOLD:
            self.lift_time = now + self.delay + self._duration

    def update(self, height: float, upright: float, time: float) -> None:  # noqa: ARG002
        """Note that a picture was taken at a time, s."""
        self.airborne = self.airborne or time >= self.lift_time
