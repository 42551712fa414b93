"""The page of the first flight and its settings tell the truth: they are what the links and the follower are told."""

import math
import re
from pathlib import Path

import pytest

from matchset.control.safety import SafetyParameters
from matchset.flight.chain.config import read_flight
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.links.crsf.parameters import CrsfParameters

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "first_flight.md").read_text(encoding="utf-8")
TEXT = (ROOT / "docs" / "betaflight.txt").read_text(encoding="utf-8")
LINES = [line for line in TEXT.splitlines() if line.strip() and not line.startswith("#")]
SETTINGS = dict(line.removeprefix("set ").split(" = ") for line in LINES if line.startswith("set "))
MODES = [line.split()[1:] for line in LINES if line.startswith("aux ")]


def test_every_line_is_one_of_its_command_line_and_comes_once() -> None:
    assert all(re.fullmatch(r"set [a-z_]+ = [A-Z0-9]+|aux( \d+){7}|feature [A-Z]+", line) for line in LINES)
    assert len(SETTINGS) == len([line for line in LINES if line.startswith("set ")])


def test_it_has_all_that_flew_betaflight_s_source() -> None:
    """Those lines are known to be spelled right: tests/benchmarks/test_betaflight.py types them."""
    flown = (ROOT / "benchmarks" / "flight" / "betaflight" / "settings.txt").read_text(encoding="utf-8")
    assert flown in TEXT
    untried = [line for line in LINES if line not in flown]
    assert len(untried) == TEXT.count("# (not tried)")


@pytest.mark.parametrize("axis", ["roll", "pitch", "yaw"])
def test_sticks_are_a_straight_line(axis: str) -> None:
    assert SETTINGS["rates_type"] == "ACTUAL"
    assert SETTINGS[f"{axis}_rc_rate"] == SETTINGS[f"{axis}_srate"]
    assert SETTINGS[f"{axis}_expo"] == SETTINGS["deadband"] == SETTINGS["yaw_deadband"] == "0"


def test_arming_and_angle_mode_are_those_of_the_link() -> None:
    arming, angle = MODES
    assert arming[1:3] == ["0", str(CrsfParameters().arm_channel - 5)]
    assert int(arming[3]) > 1500
    assert angle[1] == "1"
    assert [int(value) for value in angle[3:5]] == [900, 2100]  # always


def test_silence_stops_the_motors() -> None:
    assert SETTINGS["failsafe_procedure"] == "DROP"
    assert 2 <= int(SETTINGS["failsafe_delay"]) <= 10  # tenths of a second


def test_the_follower_is_told_what_betaflight_does(tmp_path: Path) -> None:
    (settings,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "flight.toml").write_text(settings)
    own = read_flight(tmp_path / "flight.toml").pilot.follower.ego_motion
    assert math.degrees(own.full_tilt) == pytest.approx(float(SETTINGS["angle_limit"]), abs=0.05)
    assert math.degrees(own.full_yaw_rate) == pytest.approx(10.0 * float(SETTINGS["yaw_srate"]), abs=0.05)


def test_the_limits_of_the_page_are_the_defaults() -> None:
    p = PreflightParameters()
    for words in (
        f"{p.least_rate:g} pictures a second",
        f"above {1e3 * p.longest_gap:.0f} ms",
        f"{1e3 * SafetyParameters().max_frame_age:.0f} ms",
        f"{p.most_clipped:.0%} of the pixels".replace("%", " %"),
        f"within {100.0 * p.most_flicker:.0f} %",
        f"{100.0 * p.most_errors:.0f} % errors",
        f"{p.least_cell:g} V a cell",
        f"{p.stick:g} of the stick",
        f"tracked in {100.0 * p.least_seen:.0f} %",
        f"within {100.0 * p.distance_error:.0f} %",
        f"in {100.0 * p.least_marker:.0f} %",
        f"{1e3 * p.most_noise:.0f} mm and {math.degrees(p.most_yaw_noise):.0f} degrees",
        f"{100.0 * p.most_off:.0f} cm off",
        f"recording of {p.recorded:.0f} s",
    ):
        assert words in PAGE, words
