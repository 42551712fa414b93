"""Bytes that no host would send: on the C code under sanitizers, and in the emulator."""

import os
import random
import subprocess

import pytest
import toolchain
from emulator import Board

from flight import BOUND, arm, fly, throttles

MILLION = 1_000_000
EMULATED_BYTES = int(os.environ.get("MATCHSET_NOISE_BYTES", MILLION // 10))  # a million: make bench-radio


def fuzz(seeds: str, count: int, mode: int) -> tuple[int, int, int, int, int]:
    """Bytes, packets, packets with throttle, frames, armings; the program is the judge."""
    command = [str(toolchain.host_fuzz()), seeds, str(count), str(mode)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    fed, packets, with_throttle, frames, armings = map(int, done.stdout.split())
    return fed, packets, with_throttle, frames, armings


@pytest.mark.parametrize("mode", [0, 1, 2], ids=["noise", "any values in good frames", "damaged flights"])
def test_no_throttle_while_disarmed_on_this_computer(mode: int) -> None:
    """Nine million bytes in all, of 300 seeds; a thousand million: make fuzz."""
    fed, packets, with_throttle, frames, armings = fuzz("1-100", 30_000, mode)
    assert fed == 3 * MILLION
    assert packets > 60_000
    if mode == 0:
        assert with_throttle == 0
    else:  # the noise does reach what is behind the parser
        assert frames > 30_000
        assert armings > 100
    assert mode != 2 or with_throttle > 3000


@pytest.mark.parametrize(("seed", "count"), [(772, 1_800_000), (30, 400_000)])
def test_overlapping_frames_are_judged_as_the_firmware_reads_them(seed: int, count: int) -> None:
    """A judge that counted frames within frames took an armed quadcopter for a disarmed one here."""
    assert fuzz(str(seed), count, 2)[2] > 500


def noise(chance: random.Random, count: int) -> bytes:
    """Random bytes, one in six a start byte, and now and then the head of a channel frame."""
    out = bytearray()
    while len(out) < count:
        kind = chance.randrange(40)
        if kind < 6:
            out.append(0xC8)
        elif kind == 6:
            out += b"\xc8\x18\x16"
        else:
            out.append(chance.randrange(256))
    return bytes(out[:count])


def test_no_throttle_while_disarmed_in_the_emulator() -> None:
    chance = random.Random(100)
    with Board() as board:
        board.run(BOUND)
        left, flying = EMULATED_BYTES, 0
        while left:
            part = min(left, 20_000)
            board.write(noise(chance, part))
            left -= part
            while board.waiting:
                flying += sum(throttles(board.run(0.05)))
                board.read()
            board.radio.commands.clear()
            board.radio.packets.clear()
        assert flying == 0
        assert board.radio.refusals == []
        board.run(0.1)
        arm(board)
        assert throttles(fly(board, 0.2))[-1] == 255  # and it still works
