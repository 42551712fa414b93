"""Frames as a host sends them, and a board that is bound, armed and flying."""

from emulator import Board
from nrf24 import Packet
from syma import BIND_ADDRESS

from matchset.control.command import Command
from matchset.links import crsf_frame as crsf
from matchset.links.arduino import channels

PERIOD = 1 / 30
BOUND = 1.5  # s after power on
FULL = Command(throttle=1.0, roll=0.5, pitch=-0.5, yaw=0.25)


def frame(command: Command = FULL, armed: bool = True, **switches: int) -> bytes:
    """A channel frame; `switches` sets channels by number, e.g. ``ch5=992``."""
    values = channels.channels(command, armed)
    for name, value in switches.items():
        values[int(name.removeprefix("ch")) - 1] = value
    return crsf.frame(crsf.CHANNELS_PACKED, crsf.pack_channels(values))


def fly(board: Board, seconds: float, command: Command = FULL, armed: bool = True) -> list[Packet]:
    """Send a command 30 times a second; returns the packets of that time."""
    packets = []
    for _ in range(round(seconds / PERIOD)):
        board.write(frame(command, armed))
        packets += board.run(PERIOD)
    return packets


def arm(board: Board) -> None:
    """Arm switch low, then high, throttle zero."""
    fly(board, 4 * PERIOD, Command(), armed=False)
    fly(board, 2 * PERIOD, Command(), armed=True)


def flying_board(slow_spi: bool = False) -> Board:
    """A board that was switched on, has bound, and flies with `FULL`."""
    board = Board(slow_spi=slow_spi)
    board.run(BOUND)
    arm(board)
    packets = fly(board, 3 * PERIOD)
    assert packets[-1].payload[0] == 255
    return board


def throttles(packets: list[Packet]) -> list[int]:
    """Throttle of each packet; a bind packet counts as zero."""
    return [0 if packet.address == BIND_ADDRESS else packet.payload[0] for packet in packets]
