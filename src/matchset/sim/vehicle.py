"""What the simulated vehicle is like: `VehicleParameters`, read from TOML."""

import math
from importlib import resources

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.sim.toml_settings import read_settings

Floats = npt.NDArray[np.float64]

BACKWARD = np.array((0.0, 0.0, -1.0))  # geometry: where a vehicle's marker looks, body frame


class VehicleParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The simulated vehicle; meaning, unit and source of every number are in ``vehicle.toml`` beside this file.

    Raises
    ------
    ValueError
        If a number is not finite or negative, or one that must be positive is zero; the text begins with its name.
    """

    mass: float
    roll_inertia: float
    pitch_inertia: float
    yaw_inertia: float
    thrust_to_weight: float
    motor_lag: float
    motor_lead: float
    angle_gain: float
    rate_gain: float
    full_tilt_deg: float
    full_yaw_rate_deg: float
    level_bias_deg: float
    level_wander_deg: float
    level_wander_time: float
    battery_sag: float
    flight_time: float
    radio_delay: float
    stick_levels: float
    failsafe: float
    frame_drag: float
    ball_radius: float
    ball_height: float
    ball_drag: float
    air_density: float
    rotor_radius: float
    arm: float

    def __post_init__(self) -> None:
        may_be_zero = {"motor_lead", "level_bias_deg", "level_wander_deg", "battery_sag", "radio_delay"}
        may_be_zero |= {"frame_drag", "ball_height", "ball_drag", "air_density"}
        for name in self.__struct_fields__:
            value = getattr(self, name)
            if not 0.0 <= value < math.inf or (value == 0.0 and name not in may_be_zero):
                raise ValueError(f"{name} must be {'0 or more' if name in may_be_zero else 'positive'}, got {value}")
        for name, most in (("full_tilt_deg", 60.0), ("level_bias_deg", 30.0), ("battery_sag", 1.0)):
            if getattr(self, name) > most:
                raise ValueError(f"{name} must be at most {most:g}, got {getattr(self, name)}")
        if self.thrust_to_weight <= 1.0:
            raise ValueError(f"thrust_to_weight must be more than 1 to fly, got {self.thrust_to_weight}")

    @property
    def ball_volume(self) -> float:
        """Of the balloon, m^3."""
        return 4.0 / 3.0 * math.pi * self.ball_radius**3

    @property
    def moved_mass(self) -> float:
        """What accelerates, kg: with the air in the balloon, which weighs nothing in air, and half as much around it.

        A sphere's added mass is half of what it displaces (Lamb, Hydrodynamics, section 92).
        """
        return self.mass + 1.5 * self.air_density * self.ball_volume

    @property
    def ball_inertia(self) -> float:
        """What the balloon's air adds to roll and pitch inertia, kg m^2; its coupling to the speed is left out."""
        return (self.moved_mass - self.mass) * self.ball_height**2

    @property
    def hover_throttle(self) -> float:
        """Throttle at which it hovers with a full battery."""
        return 1.0 / self.thrust_to_weight

    @property
    def ball_area_drag(self) -> float:
        """Drag of the balloon per squared speed, N s^2/m^2: rho c A / 2."""
        return 0.5 * self.air_density * self.ball_drag * math.pi * self.ball_radius**2


class VehiclePose(msgspec.Struct, frozen=True):
    """A vehicle as others see it at a moment.

    Parameters
    ----------
    position : (3,)
        Its center of mass in the room, m.
    rotation : (3, 3)
        From its body to the room.
    ball : (3,)
        Center of its ball in the room, m.
    """

    position: Floats
    rotation: Floats
    ball: Floats


def toy() -> VehicleParameters:
    """Read the toy that comes with the package."""
    name = "vehicle.toml"
    text = resources.files("matchset.sim").joinpath(name).read_text(encoding="utf-8")
    return read_settings(text, VehicleParameters, name)
