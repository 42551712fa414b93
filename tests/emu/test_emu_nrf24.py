"""The model of the radio refuses what the chip would: otherwise a clean log of the firmware would prove nothing."""

from collections.abc import Callable
from itertools import pairwise

import pytest
from nrf24 import AWAKE, SETTLING, US, Nrf24

PAYLOAD = bytes(range(10))
Step = Callable[["Bench"], object]


class Bench:
    """A chip and a clock; every command takes 50 us."""

    def __init__(self) -> None:
        self.radio, self.now = Nrf24(), 0

    def command(self, *words: int) -> list[int]:
        self.radio.select(True, self.now)
        answers = []
        for word in words:
            self.now += 2 * US
            answers.append(self.radio.exchange(word, self.now))
        self.now += 50 * US
        self.radio.select(False, self.now)
        return answers

    def enable(self, high: bool) -> None:
        self.radio.enable(high, self.now)

    def wait(self, cycles: int) -> None:
        self.now += cycles
        self.radio.advance(self.now)

    def ready(self) -> "Bench":
        """Set up as a handset does, awake, CE high."""
        for words in ((0x20, 0x0E), (0x21, 0), (0x23, 3), (0x25, 8), (0x26, 0x27), (0x30, 1, 2, 3, 4, 5)):
            self.command(*words)
        self.wait(AWAKE)
        self.enable(True)
        return self

    def load(self, payload: bytes = PAYLOAD) -> None:
        self.command(0xA0, *payload)

    @property
    def reasons(self) -> list[str]:
        return [refusal.reason for refusal in self.radio.refusals]


def test_a_chip_that_is_set_up_sends() -> None:
    bench = Bench().ready()
    bench.load()
    loaded = bench.now
    bench.wait(2_000 * US)
    (packet,) = bench.radio.packets
    assert (packet.channel, packet.address, packet.payload) == (8, bytes([1, 2, 3, 4, 5]), PAYLOAD)
    assert (packet.rate_kbit, packet.crc_bytes) == (250, 2)
    assert packet.cycle == loaded + SETTLING
    assert packet.end - packet.cycle == 576 * US
    assert bench.command(0x07, 0) == [0x2E, 0x2E]  # sent
    assert bench.reasons == []


def test_registers_are_read_back_and_status_comes_first() -> None:
    bench = Bench().ready()
    assert bench.command(0x06, 0) == [0x0E, 0x27]
    assert bench.command(0x10, 0, 0, 0, 0, 0) == [0x0E, 1, 2, 3, 4, 5]
    assert bench.command(0x17, 0)[1] & 0x10  # nothing to send


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (lambda b: b.command(0x20, 0x0C), "powered down"),
        (lambda b: b.command(0x20, 0x0F), "it is set to receive"),
        (lambda b: b.command(0x21, 0x3F), "it would wait for an acknowledgement"),
        (lambda b: b.command(0x23, 0x00), "illegal width of address"),
        (lambda b: b.command(0x25, 126), "channel 126"),
        (lambda b: b.radio.power_cycle(b.now), "powered down"),
    ],
)
def test_a_chip_that_is_set_up_wrongly_sends_nothing(spoil: Step, reason: str) -> None:
    bench = Bench().ready()
    spoil(bench)
    bench.load()
    bench.wait(5_000 * US)
    assert bench.radio.packets == []
    assert bench.reasons == [reason]


def test_with_ce_low_it_waits() -> None:
    bench = Bench().ready()
    bench.enable(False)
    bench.load()
    bench.wait(5_000 * US)
    assert bench.radio.packets == []
    bench.enable(True)
    bench.wait(5_000 * US)
    assert len(bench.radio.packets) == 1


def test_before_its_crystal_runs_it_sends_nothing() -> None:
    bench = Bench()
    for words in ((0x21, 0), (0x23, 3), (0x20, 0x0E)):
        bench.command(*words)
    bench.enable(True)
    bench.load()
    bench.wait(AWAKE)
    assert bench.radio.packets == []
    assert bench.reasons == ["the crystal does not run yet"]


@pytest.mark.parametrize(("size", "reason"), [(0, "a payload of 0 bytes"), (33, "a payload of 33 bytes")])
def test_a_payload_of_no_size_is_refused(size: int, reason: str) -> None:
    bench = Bench().ready()
    bench.load(bytes(size))
    assert bench.reasons == [reason]


def test_a_fourth_payload_finds_the_queue_full() -> None:
    bench = Bench().ready()
    bench.enable(False)
    for _ in range(4):
        bench.load()
    assert bench.reasons == ["transmit queue full"]


@pytest.mark.parametrize(
    ("words", "reason"),
    [((0x25, 9), "register 05 written while on the air"), ((0xE1, 0), "flushed while on the air")],
)
def test_meddling_with_a_packet_on_the_air_is_noticed(words: tuple[int, int], reason: str) -> None:
    bench = Bench().ready()
    bench.load()
    bench.wait(300 * US)
    bench.command(*words)
    assert bench.reasons == [reason]


def test_a_byte_to_a_chip_that_is_not_selected_is_noticed() -> None:
    bench = Bench()
    assert bench.radio.exchange(0x07, 0) == 0xFF
    assert bench.reasons == ["a byte while the chip is not selected"]


def test_a_pulse_of_ce_that_is_too_short_is_noticed() -> None:
    bench = Bench().ready()
    bench.enable(False)
    bench.load()
    bench.enable(True)
    bench.wait(5 * US)
    bench.enable(False)
    assert bench.reasons == ["CE pulse shorter than 10 us"]


def test_three_in_the_queue_go_out_one_after_the_other() -> None:
    bench = Bench().ready()
    bench.enable(False)
    for _ in range(3):
        bench.load()
    bench.enable(True)
    bench.wait(5_000 * US)
    times = [packet.cycle for packet in bench.radio.packets]
    assert [after - before for before, after in pairwise(times)] == [(576 + 130) * US] * 2
