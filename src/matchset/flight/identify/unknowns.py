"""What is known of a vehicle before it is identified: `Unknown`, `UNKNOWNS`."""

import math

import msgspec

from matchset.flight.identify.vehicle_model import VehicleValues


class Unknown(msgspec.Struct, frozen=True):
    """A number before the flight.

    Parameters
    ----------
    nominal : float
        Where the search begins.
    spread : float
        Standard deviation; of the natural logarithm if `relative`. More lets the log decide alone, less keeps what it
        does not tell near the nominal value.
    low, high : float
        Bounds of what is searched.
    unit : str
        In a file; empty for none.
    meaning : str
    relative : bool
        Whether it is positive, and known to a factor.
    """

    nominal: float
    spread: float
    low: float
    high: float
    unit: str
    meaning: str
    relative: bool = True

    def coordinate(self, value: float) -> float:
        """How many spreads a value is above the nominal one."""
        return (math.log(value / self.nominal) if self.relative else value - self.nominal) / self.spread

    def value(self, coordinate: float) -> float:
        """Return the value so many spreads above the nominal one."""
        way = self.spread * coordinate
        return self.nominal * math.exp(way) if self.relative else self.nominal + way

    def sigma(self, value: float, spreads: float) -> float:
        """Return the standard deviation of a value from that of its coordinate."""
        return spreads * self.spread * (value if self.relative else 1.0)


UNKNOWNS = VehicleValues(
    delay=Unknown(0.1, 0.1, -0.08, 0.5, "s", "from a stick to its first effect, by the stamps of pictures", False),
    full_tilt=Unknown(0.35, 0.4, 0.05, 1.2, "rad", "tilt at full stick"),
    tilt_lag=Unknown(0.03, 0.5, 0.003, 0.3, "s", "time constant of the motors before the tilt begins"),
    tilt_time=Unknown(0.054, 0.5, 0.005, 0.5, "s", "time constant of the tilt, its undamped period over 2 pi"),
    tilt_damping=Unknown(0.6, 0.35, 0.15, 3.0, "", "damping ratio of the tilt"),
    roll_trim=Unknown(0.0, 0.1, -0.5, 0.5, "rad", "roll with the stick in the middle", False),
    pitch_trim=Unknown(0.0, 0.1, -0.5, 0.5, "rad", "pitch with the stick in the middle", False),
    full_yaw_rate=Unknown(2.0, 0.5, 0.2, 20.0, "rad/s", "yaw rate at full stick"),
    yaw_lag=Unknown(0.05, 0.6, 0.005, 0.6, "s", "time constant of the yaw rate"),
    yaw_motor_lag=Unknown(0.025, 0.5, 0.002, 0.2, "s", "time constant of the torque before that"),
    yaw_trim=Unknown(0.0, 0.2, -1.5, 1.5, "rad/s", "yaw rate with the stick in the middle", False),
    hover_throttle=Unknown(0.59, 0.4, 0.1, 0.99, "", "throttle that hovers, at the end"),
    sag=Unknown(0.002, 0.005, -0.05, 0.05, "1/s", "how fast that throttle grows as the battery empties", False),
    lift_lag=Unknown(0.05, 0.4, 0.005, 0.4, "s", "time constant of the thrust"),
    effective_mass_ratio=Unknown(1.2, 0.2, 0.9, 2.5, "", "moved over carried mass"),
    drag_time=Unknown(3.5, 0.5, 0.5, 20.0, "s", "time constant of slowing by drag"),
    ahead=Unknown(0.05, 0.03, -0.3, 0.3, "m", "how far the camera is before the center of mass", False),
    speed_x=Unknown(0.0, 0.5, -5.0, 5.0, "m/s", "velocity to the right at the first picture", False),
    speed_y=Unknown(0.0, 0.5, -5.0, 5.0, "m/s", "velocity downward then", False),
    speed_z=Unknown(0.0, 0.5, -5.0, 5.0, "m/s", "velocity forward then", False),
)
"""Wide priors: about the numbers of the simulated toy, which are those of `EgoMotionParameters`, with what vehicles of
half or twice its answer have. Bounds are those of anything that flies."""
