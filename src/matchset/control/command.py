"""Stick positions: `Command`; `clip` brings numbers into their range."""

import math

import msgspec

HOLD = 0.5  # format: throttle that holds the height, where the throttle is a speed up or down


def clip(value: float, low: float, high: float) -> float:
    """Clip a number to a range; comparing takes half the time of `min` and `max`.

    Parameters
    ----------
    value, low, high : float
    """
    return low if value < low else high if value > high else value


class Command(msgspec.Struct, frozen=True):
    """Stick positions; the flight controller of the vehicle turns them into angles and thrust.

    Attributes
    ----------
    roll : float
        -1 ... 1, to the right. Commands an angle: 1 is the largest tilt of the vehicle.
    pitch : float
        -1 ... 1, forward. Commands an angle, as roll.
    yaw : float
        -1 ... 1, clockwise seen from above. Commands a rate.
    throttle : float
        0 ... 1, collective thrust; 0 stops the motors.

    Raises
    ------
    ValueError
        If a position is not finite or out of range: such a command cannot exist, so none can be sent.
    """

    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0
    throttle: float = 0.0

    def __post_init__(self) -> None:
        sticks = -1.0 <= self.roll <= 1.0 and -1.0 <= self.pitch <= 1.0 and -1.0 <= self.yaw <= 1.0
        if sticks and 0.0 <= self.throttle <= 1.0:  # so they are numbers too; what follows finds the words
            return
        for name, low in (("roll", -1.0), ("pitch", -1.0), ("yaw", -1.0), ("throttle", 0.0)):
            value = getattr(self, name)
            if not (math.isfinite(value) and low <= value <= 1.0):
                raise ValueError(f"{name} must be within {low:g} ... 1, got {value}")
