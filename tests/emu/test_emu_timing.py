"""The figures of the air side, in cycles: period, latency, failsafe, watchdog, size."""

import random
import subprocess
from itertools import pairwise

import pytest
import toolchain
from emulator import RAM_END, TICK, Board

from flight import BOUND, FULL, PERIOD, arm, fly, flying_board, frame, throttles
from matchset.control.command import Command

US = 16
SPI = pytest.mark.parametrize("slow_spi", [False, True], ids=["true SPI", "simavr's SPI"])


@SPI
def test_a_packet_every_4_ms_while_commands_come(slow_spi: bool) -> None:
    with flying_board(slow_spi) as board:
        chance = random.Random(5)
        begin = len(board.packets)
        for _ in range(60):
            board.write(frame(Command(throttle=chance.random(), roll=chance.uniform(-1, 1))))
            board.run(chance.uniform(0.02, 0.05))
        times = [packet.cycle for packet in board.packets[begin:]]
        assert len(times) > 400
        periods = [after - before for before, after in pairwise(times)]
        print(f"period {min(periods) / US:.1f} ... {max(periods) / US:.1f} us of {len(periods)}")
        assert all(abs(period - TICK) <= 50 * US for period in periods)
        assert board.radio.refusals == []


def latencies(slow_spi: bool, count: int) -> list[int]:
    """Cycles from the begin of the last byte of a frame to the first packet that carries it."""
    chance = random.Random(100)
    found = []
    with flying_board(slow_spi) as board:
        for turn in range(count):
            board.run_to(board.cycle + chance.randrange(TICK))
            stick = (turn % 100 + 1) / 127
            board.write(frame(Command(throttle=0.5, yaw=stick)))
            board.run(0.012)
            sent = board.last_byte
            packet = next(p for p in board.packets if p.cycle > sent and p.payload[2] == turn % 100 + 1)
            found.append(packet.cycle - sent)
    return found


@SPI
def test_a_command_is_on_the_air_6_ms_after_its_last_byte(slow_spi: bool) -> None:
    found = latencies(slow_spi, 60)
    print(f"last byte to preamble {min(found) / US:.0f} ... {max(found) / US:.0f} us of {len(found)}")
    assert max(found) <= 6000 * US


def failsafe_times(phases: int, seed: int) -> list[int]:
    """Cycles from the end of the last good frame to the first packet with zero throttle, at random phases."""
    chance = random.Random(seed)
    found = []
    with flying_board() as board:
        for _ in range(phases):
            arm(board)
            fly(board, 2 * PERIOD)
            board.run_to(board.cycle + chance.randrange(TICK))
            board.write(frame())
            board.run(0.005)
            last = board.last_byte
            packets = board.run(0.4)
            zero = next(packet for packet in packets if packet.payload[0] == 0)
            after = [packet.payload for packet in packets if packet.cycle >= zero.cycle]
            assert all(payload[:4] == b"\0\0\0\0" for payload in after)
            assert len(after) > 30  # transmission goes on
            found.append(zero.cycle - last)
        assert board.radio.refusals == []
    return found


def test_without_frames_the_throttle_is_zero_within_250_ms_at_100_phases() -> None:
    times = failsafe_times(100, seed=100)
    first, last = min(times) / US / 1e3, max(times) / US / 1e3
    print(f"last good frame to zero throttle {first:.1f} ... {last:.1f} ms of {len(times)}")
    assert max(times) <= 250_000 * US
    assert min(times) >= 230_000 * US  # nor much too early


def test_without_frames_sticks_are_neutral_after_100_ms_and_throttle_is_held_until_then() -> None:
    with flying_board() as board:
        board.write(frame())
        board.run(0.005)
        last = board.last_byte
        packets = [packet for packet in board.run(0.2) if packet.cycle > last + 6000 * US]
        neutral = next(packet.cycle for packet in packets if packet.payload[1:4] == b"\0\0\0")
        assert 98_000 * US <= neutral - last <= 110_000 * US
        assert set(throttles(packets)) == {255}


@pytest.mark.parametrize("interrupts_off", [False, True])
@pytest.mark.parametrize("symbol", ["transmitter_work", "transmitter_tick", "transmitter_prepare"])
def test_a_hang_ends_with_zero_throttle_within_80_ms_and_no_binding(symbol: str, interrupts_off: bool) -> None:
    chance = random.Random(3)
    with flying_board() as board:
        for _ in range(4):
            board.run_to(board.cycle + chance.randrange(TICK))
            board.hang(symbol, interrupts_off)
            begin = board.cycle
            board.write(frame())
            packets = board.run(0.2)
            zero = next(packet for packet in packets if packet.payload[0] == 0)
            print(f"hang to zero throttle {(zero.cycle - begin) / US / 1e3:.1f} ms")
            assert zero.cycle - begin <= 80_000 * US
            assert set(throttles([packet for packet in packets if packet.cycle >= zero.cycle])) == {0}
            assert len({packet.address for packet in board.packets[-50:]}) == 1  # no bind packets
            assert zero.cycle - begin >= 40_000 * US  # it did hang
            board.read()
            fly(board, 0.2)  # arm high and throttle up do not help
            assert board.packets[-1].payload[0] == 0
            arm(board)
            assert fly(board, 0.2)[-1].payload[0] == 255
        assert board.radio.refusals == []


def test_flash_and_memory_are_small() -> None:
    size = subprocess.run(
        ["avr-size", str(toolchain.firmware())], capture_output=True, text=True, check=True
    ).stdout.splitlines()[1]
    text, data, bss = map(int, size.split()[:3])
    with Board() as board:
        symbols = toolchain.symbols()
        end = symbols["_end"] & 0xFFFF
        board.fill_ram(end, b"\xa5" * (RAM_END + 1 - end))
        board.run(BOUND)
        arm(board)
        fly(board, 1.0, FULL)
        untouched = board.ram(end, RAM_END + 1 - end)
    free = len(untouched) - len(untouched.lstrip(b"\xa5"))
    stack = len(untouched) - free
    print(f"flash {text + data} B, RAM {data + bss} B, stack {stack} B")
    assert text + data <= 8 * 1024
    assert data + bss + stack <= 512
