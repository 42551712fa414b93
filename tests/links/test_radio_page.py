"""The page for people with a soldering iron tells the truth: its program runs, its pins are the firmware's."""

import re
import time
from pathlib import Path

import pytest
from fakes import FakePort

from matchset.links import connect
from matchset.links.arduino.arduino_link import ArduinoLink

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "radio.md").read_text(encoding="utf-8")
FIRMWARE = ROOT / "firmware" / "syma_transmitter"


def test_the_program_of_the_page_flies_and_lands(monkeypatch: pytest.MonkeyPatch) -> None:
    port, throttles = FakePort(), []
    port.clock.sleep(0.2)

    def sleep(seconds: float) -> None:
        throttles.append(port.throttle)
        port.clock.sleep(seconds)

    def link(uri: str) -> ArduinoLink:
        return ArduinoLink(uri, port, clock=port.clock, sleep=sleep)

    monkeypatch.setattr(connect, "connect", link)
    monkeypatch.setattr(time, "sleep", sleep)
    (program,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(program, "radio.md", "exec"), {})
    assert max(throttles) == pytest.approx(255 * 59 / 120, abs=1)
    assert (port.throttle, port.state, port.closed) == (0, "locked", True)


def test_the_pins_of_the_page_are_those_of_the_firmware() -> None:
    source = (FIRMWARE / "board_avr.c").read_text()
    pins = {name: int(bit) + 8 for name, bit in re.findall(r"#define (CE|CSN|MOSI|SCK) PB(\d)", source)}
    assert len(pins) == 4
    for name, pin in {**pins, "MISO": 12}.items():
        assert re.search(rf"\| {name} \| D{pin} \|", PAGE), (name, pin)


def test_the_limits_of_the_page_are_those_of_the_firmware() -> None:
    header = (FIRMWARE / "pilot.h").read_text()
    ticks = dict(re.findall(r"#define (\w+_TICKS) (\d+)", header))
    assert (int(ticks["NEUTRAL_TICKS"]) - 1) * 4 == 100
    assert (int(ticks["FAILSAFE_TICKS"]) - 1) * 4 == 240
    assert "no good frame for 100 ms" in PAGE
    assert "none for 240 ms" in PAGE
