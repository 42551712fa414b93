"""What the Arduino IDE would build flies too."""

import toolchain
from emulator import Board

from flight import BOUND, arm, fly, throttles


def test_the_sketch_that_the_arduino_ide_builds_binds_arms_and_flies() -> None:
    with Board(program=toolchain.arduino_sketch()) as board:
        assert len(board.run(BOUND)) > 345
        assert set(throttles(board.packets)) == {0}
        arm(board)
        assert throttles(fly(board, 0.3))[-1] == 255
        assert throttles(board.run(0.3))[-1] == 0
        assert board.radio.refusals == []
