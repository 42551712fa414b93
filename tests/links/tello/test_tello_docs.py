"""docs/tello.md: its program flies the fake, its numbers are those of the code."""

import re
import time
from pathlib import Path

import pytest
from fake_tello import FakeTello

from matchset.flight.chain.config import read_flight
from matchset.flight.linked.vehicle_kind import for_links
from matchset.links import connect
from matchset.links.tello.tello_client import STATES, VIDEO, TelloParameters, parse_tello
from matchset.links.tello.tello_link import TelloLink

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "tello.md").read_text(encoding="utf-8")


def test_the_program_of_the_page_flies_and_lands(monkeypatch: pytest.MonkeyPatch) -> None:
    tello, heights = FakeTello(), []

    def sleep(seconds: float) -> None:
        heights.append(tello.height)
        tello.clock.sleep(seconds)

    def link(uri: str) -> TelloLink:
        return TelloLink(uri, tello, clock=tello.clock, sleep=sleep)

    monkeypatch.setattr(connect, "connect", link)
    monkeypatch.setattr(time, "sleep", sleep)
    (program,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(program, "tello.md", "exec"), {})
    assert max(heights) == pytest.approx(0.8, abs=0.05)
    assert (tello.motors, tello.height, tello.closed) == (False, 0.0, True)


def test_the_numbers_of_the_page_are_those_of_the_code() -> None:
    p = TelloParameters()
    assert f"neutral after {p.hold_time:g} s and lands after {p.silence_time:g} s" in PAGE
    assert f"{p.landing_timeout:g} s at most" in PAGE
    assert f"no state for {p.timeout:g} s" in PAGE
    assert f"below {100 * p.least_battery:g} % of battery" in PAGE
    assert f"below {100 * p.low_battery:g} %;" in PAGE
    assert f"UDP {STATES} and {VIDEO}" in PAGE
    assert p.cuts == 10
    for uri in re.findall(r"`(tello:[^`]*)`", PAGE):
        parse_tello(uri)


def test_the_settings_of_the_page_are_read(tmp_path: Path) -> None:
    (settings,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "tello.toml").write_text(settings)
    flight = for_links(read_flight(tmp_path / "tello.toml"), ["tello:"])
    own, speeds = flight.loop.follower.ego_motion, flight.loop.follower.speeds
    assert (own.delay, own.full_yaw_rate, own.speed_commands) == (0.1, 1.75, True)
    assert f"{speeds.horizontal.proportional:g} times the error; so for the height" in PAGE
    assert f"with {speeds.vertical.proportional:g}" in PAGE
    assert f"1 m up, {TelloParameters().takeoff_time:g} s" in PAGE
