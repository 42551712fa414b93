"""What the radio makes of sticks: `quantized`."""

from matchset.control.command import Command


def quantized(command: Command, levels: float) -> Command:
    """Round sticks to the steps of the radio: `levels` from end to end."""
    half = 0.5 * levels
    roll, pitch, yaw = (
        min(max(round(value * half) / half, -1.0), 1.0) for value in (command.roll, command.pitch, command.yaw)
    )
    return Command(roll, pitch, yaw, round(command.throttle * levels) / levels)
