"""A command as the sixteen channels of a transmitter: roll, pitch, throttle, yaw, and the arm switch."""

from matchset.control.command import Command
from matchset.links.crsf_frame import CHANNEL_CENTER, CHANNEL_COUNT, CHANNEL_HIGH, CHANNEL_LOW

ROLL, PITCH, THROTTLE, YAW = 0, 1, 2, 3  # format: order of the channels, AETR
_HALF, _WHOLE = CHANNEL_HIGH - CHANNEL_CENTER, CHANNEL_HIGH - CHANNEL_LOW


def channels(command: Command, armed: bool, arm_channel: int) -> list[int]:
    """Return the sixteen channels of a command, 172 ... 1811 each.

    All switches but that of arming are low, whatever a flight controller has them do.

    Parameters
    ----------
    command : Command
    armed : bool
        Whether the arm switch is high; if not, the throttle is zero too.
    arm_channel : int
        Of the arm switch, 5 ... 16.
    """
    values = [CHANNEL_LOW] * CHANNEL_COUNT
    values[ROLL] = CHANNEL_CENTER + round(command.roll * _HALF)
    values[PITCH] = CHANNEL_CENTER + round(command.pitch * _HALF)
    values[YAW] = CHANNEL_CENTER + round(command.yaw * _HALF)
    if armed:
        values[THROTTLE] = CHANNEL_LOW + round(command.throttle * _WHOLE)
        values[arm_channel - 1] = CHANNEL_HIGH
    return values


def on_air(values: list[int]) -> Command:
    """Return the command that channels stand for."""
    return Command(
        roll=max((values[ROLL] - CHANNEL_CENTER) / _HALF, -1.0),
        pitch=max((values[PITCH] - CHANNEL_CENTER) / _HALF, -1.0),
        yaw=max((values[YAW] - CHANNEL_CENTER) / _HALF, -1.0),
        throttle=(values[THROTTLE] - CHANNEL_LOW) / _WHOLE,
    )
