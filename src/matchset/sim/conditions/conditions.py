"""Conditions of a simulated flight that no controller is told: `Conditions`, and its names in words, `quantities`."""

import functools
import math
from typing import Annotated, Any, NamedTuple, get_type_hints

import msgspec

from matchset.numeric.arguments import require_within
from matchset.sim.rope import RopeParameters
from matchset.sim.vehicle import VehicleParameters


class Quantity(NamedTuple):
    """One of the `Conditions` in words.

    Attributes
    ----------
    name : str
    default : float or None
        None: as the rest of the settings have it.
    low, high : float
        What is accepted.
    unit : str
        "x" for a factor, empty for a number without unit.
    meaning : str
    """

    name: str
    default: float | None
    low: float
    high: float
    unit: str
    meaning: str


def _within(low: float, high: float, unit: str, meaning: str) -> msgspec.Meta:
    return msgspec.Meta(description=meaning, extra={"low": low, "high": high, "unit": unit})


class Conditions(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the simulated side differs from what a controller is told; by default in nothing.

    Every field is annotated with its meaning, unit and range: `quantities` lists them. "x" is a factor on what
    ``vehicle.toml`` or the settings of the flight say. All vehicles of a chain are the same; directions and chance
    follow from the seed of the flight. Defaults are the nominal flight, bit for bit.

    Raises
    ------
    ValueError
        If a value is outside of its range; the text begins with its name.
    """

    thrust: Annotated[float, _within(0.3, 3.0, "x", "thrust of the motors at every throttle")] = 1.0
    mass: Annotated[float, _within(0.3, 3.0, "x", "mass of a vehicle, its motors as they are")] = 1.0
    thrust_exponent: Annotated[
        float, _within(0.5, 3.0, "", "thrust goes with this power of the throttle, hovering as before")
    ] = 1.0
    motor_lag: Annotated[float, _within(0.1, 10.0, "x", "lag of the motors")] = 1.0
    attitude_lag: Annotated[float, _within(0.2, 5.0, "x", "how much slower the tilt answers")] = 1.0
    full_tilt: Annotated[float, _within(0.2, 2.5, "x", "tilt at full stick")] = 1.0
    full_yaw_rate: Annotated[float, _within(0.2, 5.0, "x", "yaw rate at full stick")] = 1.0
    yaw_lag: Annotated[float, _within(0.2, 20.0, "x", "how much slower the yaw rate answers")] = 1.0
    roll_trim_deg: Annotated[float, _within(-30.0, 30.0, "degree", "roll with the stick in the middle")] = 0.0
    pitch_trim_deg: Annotated[float, _within(-30.0, 30.0, "degree", "pitch with the stick in the middle")] = 0.0
    yaw_trim_deg_s: Annotated[float, _within(-90.0, 90.0, "degree/s", "yaw rate with the stick in the middle")] = 0.0
    battery_loss_per_min: Annotated[
        float, _within(0.0, 1.0, "1/min", "share of the full thrust lost in each minute, besides vehicle.toml's")
    ] = 0.0
    radio_delay_ms: Annotated[
        float | None, _within(0.0, 500.0, "ms", "from a command to its first effect; as in vehicle.toml")
    ] = None
    commands_lost: Annotated[float, _within(0.0, 1.0, "", "share of the commands that the radio loses")] = 0.0
    told_latency_ms: Annotated[
        float | None, _within(0.0, 700.0, "ms", "latency by the time stamps of the pictures; as it is")
    ] = None
    jitter_ms: Annotated[
        float, _within(0.0, 100.0, "ms", "a picture comes up to so much earlier or later, and is stamped so")
    ] = 0.0
    frames_lost: Annotated[float, _within(0.0, 1.0, "", "share of the pictures that do not come")] = 0.0
    wind_m_s: Annotated[float, _within(0.0, 10.0, "m/s", "steady level wind, from a direction by the seed")] = 0.0
    gust_m_s: Annotated[
        float, _within(0.0, 10.0, "m/s", "gusts: standard deviation along each axis, each vehicle by itself")
    ] = 0.0
    gust_time_s: Annotated[float, _within(0.05, 60.0, "s", "correlation time of the gusts")] = 1.0
    camera_pitch_deg: Annotated[float, _within(-45.0, 45.0, "degree", "the camera is mounted looking up")] = 0.0
    camera_yaw_deg: Annotated[float, _within(-45.0, 45.0, "degree", "the camera is mounted looking right")] = 0.0
    camera_roll_deg: Annotated[float, _within(-45.0, 45.0, "degree", "the camera is mounted turned clockwise")] = 0.0
    focal_length: Annotated[float, _within(0.5, 2.0, "x", "focal length of the lens")] = 1.0
    marker_yaw_deg: Annotated[float, _within(-90.0, 90.0, "degree", "the marker is glued so far to the right")] = 0.0
    blur_ms: Annotated[
        float, _within(0.0, 33.0, "ms", "how long a picture or a field is exposed: what moves is blurred")
    ] = 0.0
    flicker: Annotated[float, _within(0.0, 1.0, "", "share of the light that goes and comes 100 times a second")] = 0.0
    exposure_swing: Annotated[
        float, _within(1.0, 8.0, "x", "brightest over darkest picture: automatic exposure that swings in 4 s")
    ] = 1.0
    shadow: Annotated[
        float, _within(0.0, 1.0, "", "share of the light lost in shadows: on balls, in patches of the room, below")
    ] = 0.0
    ball_diameter: Annotated[float, _within(0.5, 2.0, "x", "diameter of the balls")] = 1.0
    rope_length_m: Annotated[float | None, _within(0.2, 5.0, "m", "length of the rope; 1.2")] = None

    def __post_init__(self) -> None:
        said = (quantity for quantity in quantities() if getattr(self, quantity.name) is not None)
        require_within(self, {quantity.name: (quantity.low, quantity.high) for quantity in said})

    def vehicle(self, told: VehicleParameters) -> VehicleParameters:
        """Return the vehicle as it is, from what is told about it.

        Its `thrust_to_weight` is left as it is told, since one that cannot fly is none: `full_thrust` is what it has.

        Parameters
        ----------
        told : VehicleParameters
        """
        delay = told.radio_delay if self.radio_delay_ms is None else 1e-3 * self.radio_delay_ms
        return msgspec.structs.replace(
            told,
            mass=told.mass * self.mass,
            motor_lag=told.motor_lag * self.motor_lag,
            angle_gain=told.angle_gain / self.attitude_lag,
            rate_gain=told.rate_gain / self.attitude_lag,
            full_tilt_deg=told.full_tilt_deg * self.full_tilt,
            full_yaw_rate_deg=told.full_yaw_rate_deg * self.full_yaw_rate,
            ball_radius=told.ball_radius * self.ball_diameter,
            radio_delay=delay,
        )

    def full_thrust(self, told: VehicleParameters) -> float:
        """Return the mass, kg, whose weight is the thrust at full throttle with a full battery.

        Parameters
        ----------
        told : VehicleParameters
        """
        return told.thrust_to_weight * told.mass * self.thrust

    def rope(self, told: RopeParameters) -> RopeParameters:
        """Return the rope as it is.

        Parameters
        ----------
        told : RopeParameters

        Raises
        ------
        ValueError
            If it is too short for its swing.
        """
        if self.rope_length_m is None:
            return told
        rope = msgspec.structs.replace(told, length=self.rope_length_m)
        rope.__post_init__()
        return rope

    @property
    def level_trim_deg(self) -> tuple[float, float]:
        """Roll and pitch with the sticks in the middle, degree."""
        return self.roll_trim_deg, self.pitch_trim_deg

    @property
    def marker_yaw(self) -> float:
        """How far the marker is off, to the right as seen from behind, rad."""
        return math.radians(self.marker_yaw_deg)

    @property
    def mount(self) -> tuple[float, float, float]:
        """How the camera is turned on its vehicle: yaw to the right, pitch up, roll clockwise, rad."""
        yaw, pitch, roll = self.camera_yaw_deg, self.camera_pitch_deg, self.camera_roll_deg
        return math.radians(yaw), math.radians(pitch), math.radians(roll)


@functools.cache
def quantities() -> tuple[Quantity, ...]:
    """List the names of `Conditions` with default, range, unit and meaning."""
    hints = get_type_hints(Conditions, include_extras=True)
    nominal: dict[str, Any] = {field.name: field.default for field in msgspec.structs.fields(Conditions)}
    return tuple(
        Quantity(name, nominal[name], meta.extra["low"], meta.extra["high"], meta.extra["unit"], meta.description)
        for name, hint in hints.items()
        for meta in hint.__metadata__
    )
