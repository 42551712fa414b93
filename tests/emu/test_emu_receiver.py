"""A quadcopter that behaves as the captures say would bind to the emulated board, follow it, and stop."""

import pytest
from emulator import Board
from receiver import Quadcopter

from flight import BOUND, FULL, arm, fly, flying_board, throttles
from matchset.control.command import Command
from matchset.links.arduino.messages import Config, bind_frame, write_config_frame


@pytest.mark.parametrize("fourth", [0x20, 0x09])
@pytest.mark.parametrize("clock_ppm", [-200.0, 0.0, 200.0])
def test_it_binds_and_hears_nearly_every_packet(fourth: int, clock_ppm: float) -> None:
    with flying_board() as board:
        quad = Quadcopter(fourth, clock_ppm)
        quad.listen(board.packets)
        assert quad.id == Config().id
        quad.listen(fly(board, 4.0, Command(throttle=0.5, roll=-1.0)))
        assert quad.heard > 0.97 * (quad.heard + quad.missed)
        assert quad.last is not None
        assert (quad.last.throttle, quad.last.roll) == (128, -127)
        assert quad.motors(board.time) == 128


@pytest.mark.parametrize("fourth", [0x20, 0x09])
def test_it_binds_even_where_only_the_fourth_channel_is_heard(fourth: int) -> None:
    quad = Quadcopter(fourth, blocked_channels=[0x4B, 0x30, 0x40])
    quad.bind_channels = [fourth] * 4
    with Board() as board:
        quad.listen(board.run(BOUND))
    assert quad.id == Config().id


def test_it_follows_on_three_channels_when_the_fourth_is_jammed() -> None:
    with flying_board() as board:
        quad = Quadcopter(blocked_channels=[20])
        quad.listen(board.packets)
        quad.listen(fly(board, 2.0))
        assert 0.2 < quad.missed / (quad.heard + quad.missed) < 0.3
        assert quad.motors(board.time) == 255


def test_its_motors_stop_when_the_cable_is_pulled_and_when_the_board_dies() -> None:
    with flying_board() as board:
        quad = Quadcopter(motor_timeout=1.0)
        quad.listen(board.packets)
        assert quad.motors(board.time) == 255
        quad.listen(board.run(0.25))
        assert quad.motors(board.time) == 0  # the firmware said so
    with flying_board() as board:
        quad = Quadcopter(motor_timeout=1.0)
        quad.listen(board.packets)
        assert quad.motors(board.time + 1.1) == 0  # no board at all: its own motor_timeout ends


def test_a_neighbor_with_another_id_is_not_heard() -> None:
    with flying_board() as board, Board() as other:
        quad = Quadcopter()
        quad.listen(board.packets)
        other.run(BOUND)
        other.write(write_config_frame(Config(id=bytes.fromhex("3b01020304"))))
        other.run(0.2)
        arm(other)
        heard = quad.heard
        quad.listen(fly(other, 1.0, FULL))
        assert quad.heard == heard


def test_a_second_binding_moves_a_quadcopter_to_a_new_id() -> None:
    with Board() as board:
        board.run(BOUND)
        board.write(write_config_frame(Config(id=bytes.fromhex("3b01020304"))))
        board.run(0.3)
        quad = Quadcopter()
        board.write(bind_frame())
        quad.listen(board.run(1.6))
        assert quad.id == bytes.fromhex("3b01020304")
        arm(board)
        quad.listen(fly(board, 0.5))
        assert quad.motors(board.time) == 255
        assert set(throttles(board.run(0.5)[-20:])) == {0}
