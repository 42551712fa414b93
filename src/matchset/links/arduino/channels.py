"""A command as sixteen channels, and as it is after the quantization of the radio packets.

Channels 1 ... 4 are roll, pitch, throttle, yaw (AETR), 5 arm, 6 high rate, 7 flip (never), 16 a number that the
firmware sends back; the others stay at the center.
"""

from matchset.control.command import Command
from matchset.links.crsf_frame import CHANNEL_CENTER, CHANNEL_COUNT, CHANNEL_HIGH, CHANNEL_LOW

FRAME_NUMBERS = 1024  # format: frames are numbered modulo this


def channels(command: Command, armed: bool = False, high_rate: bool = False) -> list[int]:
    """Return the sixteen channels of a command, 172 ... 1811 each; the frame number is its lowest.

    Parameters
    ----------
    command : Command
    armed, high_rate : bool
        The switches: without `armed` the motors stay off; the high rate allows more tilt.
    """
    half, whole = CHANNEL_HIGH - CHANNEL_CENTER, CHANNEL_HIGH - CHANNEL_LOW
    values = [CHANNEL_CENTER] * CHANNEL_COUNT
    values[0] = CHANNEL_CENTER + round(command.roll * half)
    values[1] = CHANNEL_CENTER + round(command.pitch * half)
    values[2] = CHANNEL_LOW + round(command.throttle * whole)
    values[3] = CHANNEL_CENTER + round(command.yaw * half)
    values[4] = CHANNEL_HIGH if armed else CHANNEL_LOW
    values[5] = CHANNEL_HIGH if high_rate else CHANNEL_LOW
    values[6] = values[15] = CHANNEL_LOW
    return values


def throttle_byte(channel: int) -> int:
    """Return the throttle that the firmware computes from a channel, 0 ... 255."""
    return (channel - CHANNEL_LOW) * 10197 + 32768 >> 16


def stick_byte(channel: int) -> int:
    """Return the stick that the firmware computes from a channel, -127 ... 127."""
    size = abs(channel - CHANNEL_CENTER) * 10163 + 32768 >> 16
    return size if channel >= CHANNEL_CENTER else -size


def on_air(command: Command) -> Command:
    """Return the command as the radio packets carry it: 255 steps of throttle, 127 on each side of a stick."""
    roll, pitch, throttle, yaw = channels(command)[:4]
    return Command(
        roll=stick_byte(roll) / 127,
        pitch=stick_byte(pitch) / 127,
        yaw=stick_byte(yaw) / 127,
        throttle=throttle_byte(throttle) / 255,
    )
