"""Who may fly, in the emulated firmware: arming, resets, a radio that fails, and the stored configuration."""

import pytest
from emulator import BORF, EXTRF, PORF, Board
from syma import BIND_ADDRESS, data_channels

from flight import BOUND, FULL, PERIOD, arm, fly, flying_board, frame, throttles
from matchset.control.command import Command
from matchset.links.arduino.messages import (
    CONFIG,
    STATUS,
    Config,
    StatusReport,
    bind_frame,
    decode_config,
    read_config_frame,
    write_config_frame,
)
from matchset.links.crsf_frame import CrsfParser, crc8

ZERO = Command()


def report(board: Board) -> StatusReport:
    board.read()
    board.run(0.15)
    return [StatusReport.decode(payload) for kind, payload in CrsfParser().feed(board.read()) if kind == STATUS][-1]


def ask(board: Board, question: bytes) -> tuple[str, Config]:
    board.read()
    board.write(question)
    board.run(0.3)
    (answer,) = [payload for kind, payload in CrsfParser().feed(board.read()) if kind == CONFIG]
    return decode_config(answer)


@pytest.fixture
def bound() -> Board:
    board = Board()
    board.run(BOUND)
    return board


def test_throttle_without_arming_stays_on_the_ground(bound: Board) -> None:
    assert set(throttles(fly(bound, 0.5, FULL, armed=False))) == {0}


def test_arm_high_alone_does_not_arm(bound: Board) -> None:
    fly(bound, 0.5, ZERO, armed=True)
    assert set(throttles(fly(bound, 0.5))) == {0}


def test_arm_high_with_throttle_up_does_not_arm(bound: Board) -> None:
    fly(bound, 0.5, ZERO, armed=False)
    assert set(throttles(fly(bound, 0.5))) == {0}
    assert set(throttles(fly(bound, 0.3, ZERO))) == {0}  # and has to begin anew
    assert set(throttles(fly(bound, 0.3))) == {0}


def test_arm_low_with_throttle_up_does_not_prepare(bound: Board) -> None:
    fly(bound, 0.5, Command(throttle=0.2), armed=False)
    fly(bound, 0.2, ZERO)
    assert set(throttles(fly(bound, 0.3))) == {0}


def test_a_low_frame_long_ago_does_not_count(bound: Board) -> None:
    fly(bound, 0.2, ZERO, armed=False)
    bound.run(0.5)
    fly(bound, 0.2, ZERO)
    assert set(throttles(fly(bound, 0.3))) == {0}


def test_the_switch_in_the_middle_disarms() -> None:
    with flying_board() as board:
        board.write(frame(FULL, ch5=992))
        board.run(0.02)
        assert throttles(board.run(0.1)) == [0] * 25


def test_the_failsafe_is_left_only_by_low_zero_high() -> None:
    with flying_board() as board:
        board.run(0.4)
        assert report(board).state == "failsafe"
        assert set(throttles(fly(board, 0.5))) == {0}
        assert set(throttles(fly(board, 0.5, ZERO))) == {0}
        assert report(board).state == "failsafe"
        arm(board)
        assert throttles(fly(board, 0.2))[-1] == 255


def test_a_frame_out_of_range_is_a_bad_frame() -> None:
    values = [2000, *[992] * 15]
    packed = sum(value << 11 * place for place, value in enumerate(values)).to_bytes(22, "little")
    body = b"\x16" + packed
    with flying_board() as board:
        before = report(board).bad
        fly(board, 0.1)
        board.write(b"\xc8\x18" + body + bytes([crc8(body)]))
        board.run(0.02)
        assert report(board).bad == before + 1


def test_a_good_frame_inside_a_broken_one_is_found(bound: Board) -> None:
    good = report(bound).good
    for cut in range(1, 26):
        bound.write(frame(ZERO, armed=False)[:cut] + frame(ZERO, armed=False))
        bound.run(0.05)
    assert report(bound).good == good + 25


def test_bind_is_refused_in_flight_and_heard_on_the_ground() -> None:
    with flying_board() as board:
        board.write(bind_frame())
        assert BIND_ADDRESS not in {packet.address for packet in fly(board, 0.2)}
        fly(board, 0.1, ZERO, armed=False)
        board.write(bind_frame())
        packets = fly(board, 1.8)
        assert sum(packet.address == BIND_ADDRESS for packet in packets) == 345
        assert set(throttles(packets)) == {0}
        assert report(board).state == "locked"


@pytest.mark.parametrize("flags", [EXTRF, BORF, EXTRF | BORF, 0, PORF])
def test_a_reset_in_flight_binds_nobody_and_stops_the_motors(flags: int) -> None:
    """With no flag at all: a boot loader has cleared them. With PORF: the supply dipped, memory survived."""
    with flying_board() as board:
        board.reset(flags, keep_ram=True)
        packets = board.run(0.5)
        assert len(packets) > 115
        assert set(throttles(packets)) == {0}
        assert BIND_ADDRESS not in {packet.address for packet in packets}
        assert report(board).state == "failsafe"
        assert report(board).warnings == ("it was reset without loss of power",)
        arm(board)
        assert throttles(fly(board, 0.2))[-1] == 255


def test_power_on_binds_unless_told_not_to() -> None:
    with flying_board() as board:
        board.reset(PORF, keep_ram=False)
        assert {packet.address for packet in board.run(0.5)} == {BIND_ADDRESS}
        board.run(1.5)
        assert ask(board, write_config_frame(Config(bind_at_power_on=False)))[0] == "stored"
        board.reset(PORF, keep_ram=False)
        assert BIND_ADDRESS not in {packet.address for packet in board.run(0.5)}
        assert report(board).state == "locked"


def test_a_configuration_is_stored_and_used_at_once_and_after_power_on(bound: Board) -> None:
    assert ask(bound, read_config_frame()) == ("default", Config())
    wish = Config(id=bytes.fromhex("bc11223344"), reversed=("roll",), trims=(-4, 0, 3), bind_at_power_on=False)
    assert ask(bound, write_config_frame(wish)) == ("stored", wish)
    arm(bound)
    packet = fly(bound, 0.2)[-1]
    assert packet.address == wish.id
    assert packet.channel in data_channels(0xBC)
    assert packet.payload[3] == 0x80 | 64  # half a stick to the right, sign turned
    assert packet.payload[5:8] == bytes([0x64, 0x00, 0x03])
    bound.reset(PORF, keep_ram=False)
    bound.run(0.1)
    assert ask(bound, read_config_frame()) == ("stored", wish)


@pytest.mark.parametrize("damaged", [16, 40, 48, 62])
def test_one_damaged_copy_of_the_configuration_does_no_harm(bound: Board, damaged: int) -> None:
    wish = Config(id=bytes.fromhex("bc11223344"))
    ask(bound, write_config_frame(wish))
    memory = bytearray(bound.eeprom)
    memory[damaged] ^= 0x10
    with Board(eeprom=bytes(memory)) as again:
        again.run(0.05)
        assert ask(again, read_config_frame()) == ("stored", wish)


def test_power_lost_while_storing_leaves_the_old_or_the_new_configuration(bound: Board) -> None:
    old, new = Config(id=bytes.fromhex("0102030405")), Config(id=bytes.fromhex("0a0b0c0d0e"), tail=1, trims=(1, 1, 1))
    ask(bound, write_config_frame(old))
    bound.write(write_config_frame(new))
    seen = set()
    for _ in range(60):
        bound.run(0.0001)  # simavr stores a byte in no time; silicon takes 3.3 ms for each
        with Board(eeprom=bound.eeprom) as again:
            again.run(0.02)
            seen.add(ask(again, read_config_frame()))
    assert seen == {("stored", old), ("stored", new)}


def test_bad_values_and_writes_in_flight_are_refused() -> None:
    with flying_board() as board:
        fly(board, PERIOD)
        answer = ask(board, write_config_frame(Config(tail=7)))
        assert answer[0] == "refused: it is flying"
        assert answer[1] == Config()
        board.run(0.3)
        good = write_config_frame(Config())
        body = bytearray(good[2:-1])
        body[4 + 6] = 200  # a channel beyond the band
        assert ask(board, good[:2] + bytes(body) + bytes([crc8(bytes(body))]))[0] == "refused: a value is out of range"


def test_a_radio_that_is_not_there_is_reported_and_one_that_comes_back_is_used(bound: Board) -> None:
    bound.radio.present = False
    bound.run(0.6)
    assert any("radio" in words for words in report(bound).warnings)
    bound.radio.power_cycle(bound.cycle)
    bound.radio.present = True
    assert len(bound.run(0.6)) > 80
    assert report(bound).warnings == ()


def test_a_radio_that_forgot_its_registers_is_set_up_again_in_flight() -> None:
    with flying_board() as board:
        board.radio.power_cycle(board.cycle)
        packets = fly(board, 1.0)
        late = [packet for packet in packets if packet.cycle > packets[-1].cycle - 8_000_000]
        assert throttles(late)[-1] == 255
        assert len(late) > 120
        assert {(packet.rate_kbit, packet.crc_bytes, packet.address) for packet in late} == {(250, 2, Config().id)}
