"""What a vehicle makes of its sticks, for dead reckoning: `EgoMotionParameters`, `AttitudeCommand`, `SpeedCommand`."""

from typing import NamedTuple

import msgspec

from matchset.numeric.arguments import require_positive

GRAVITY = 9.81  # theorem: standard gravity, m/s^2 (ISO 80000-3: 9.80665), rounded


class EgoMotionParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Model of the vehicle's answer to its sticks.

    Defaults describe the simulated toy (`matchset/sim/vehicle.toml`); a test compares the two. Measure those of another
    vehicle from its answer to a step of the stick.

    Parameters
    ----------
    full_tilt : float
        Tilt at full stick, rad. Estimate: toys tilt 15 to 25 degrees.
    full_yaw_rate : float
        Yaw rate at full stick, rad/s. Estimate: toys turn 60 to 180 degrees a second.
    delay : float
        Time from sending a command to its first effect, s. Estimate: a radio takes 20 to 40 ms.
    tilt_lag : float
        Time constant L of the motors before the tilt begins, s. Fitted to the toy's step answer.
    tilt_time : float
        Time constant T of the tilt, s: the period of the undamped oscillation over 2 pi. Fitted, as `tilt_lag`.
    tilt_damping : float
        Damping ratio z of the tilt; below 1 it overshoots. Fitted, as `tilt_lag`.
    yaw_lag : float
        Time constant of the yaw rate, s. Fitted to the toy's step answer.
    lift_lag : float
        Time constant of the thrust, s. Estimate: brushed motors have 0.05 to 0.10 s.
    drag_time : float
        Time constant D in which drag slows the vehicle down, s. It keeps the dead reckoning from running away. Chosen
        on the simulated flights of seeds 0 to 9.
    effective_mass_ratio : float
        Moved mass over carried mass: the air in a balloon weighs nothing in air and is moved all
        the same, with half as much around it (added mass). Derived for 100 g and a balloon of 28 cm.
    speed_commands : bool
        Whether sticks are speeds that the vehicle holds by itself, instead of angles and thrust. Set by
        `FollowerParameters.commands`; a file need not name it.
    speed_time, rise_time : float
        Of a vehicle that is told speeds: time constants with which it goes over to another level speed, and to another
        rise, s. Its acceleration is the difference over this time, and its tilt that acceleration's. Estimate: such
        vehicles take half a second.
    full_speed, full_rise : float
        Level speed and rise at full stick of a vehicle that is told speeds, m/s. Estimate: a Tello in its slow mode.
    integration_step : float
        Step of the integration, s. Shorter is more exact and slower: the time of a call is proportional to the number
        of steps. Chosen by hand: a quarter of a picture's period; tests/control/test_ego_motion.py compares with SciPy.
    """

    full_tilt: float = 0.35
    full_yaw_rate: float = 2.0
    delay: float = 0.03
    tilt_lag: float = 0.03
    tilt_time: float = 0.054
    tilt_damping: float = 0.6
    yaw_lag: float = 0.055
    lift_lag: float = 0.05
    drag_time: float = 3.5
    effective_mass_ratio: float = 1.2
    speed_commands: bool = False
    speed_time: float = 0.4
    rise_time: float = 0.4
    full_speed: float = 1.0
    full_rise: float = 1.0
    integration_step: float = 1.0 / 120.0

    def __post_init__(self) -> None:
        require_positive(self, [name for name in self.__struct_fields__ if name != "speed_commands"])


class AttitudeCommand(NamedTuple):
    """A command without the trim: tilt to the right and forward, rad; yaw rate, rad/s; lift (upward), m/s^2."""

    roll: float = 0.0
    pitch: float = 0.0
    yaw_rate: float = 0.0
    lift: float = 0.0


class SpeedCommand(NamedTuple):
    """The same where speeds are told: to the right and forward, m/s; yaw rate, rad/s; upward, m/s."""

    right: float = 0.0
    forward: float = 0.0
    yaw_rate: float = 0.0
    up: float = 0.0
