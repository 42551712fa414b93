"""The file of a vehicle: settings that a flight reads, with standard deviations, dates, and reasons."""

from datetime import date
from pathlib import Path

import msgspec
import pytest

from matchset.flight.chain.config import ConfigFile, read_flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.identify.parameters import IdentifyParameters
from matchset.flight.identify.unknowns import UNKNOWNS
from matchset.flight.identify.vehicle_file import vehicle_toml
from matchset.flight.identify.verdict import SHOWN, VehicleFinding
from matchset.sim.toml_settings import read_settings

DAY = date(2026, 11, 23)


def found(**changed: VehicleFinding) -> list[VehicleFinding]:
    """Every number as it is before a flight, but for some."""
    nominal = {name: getattr(UNKNOWNS, name) for name in SHOWN}
    return [
        changed.get(n, VehicleFinding(n, each.nominal, 0.01, each.unit, each.meaning)) for n, each in nominal.items()
    ]


def written(folder: Path, findings: list[VehicleFinding], source: str = "sim://chain") -> Path:
    path = folder / "vehicle.toml"
    path.write_text(vehicle_toml(findings, source, DAY, IdentifyParameters()), encoding="utf-8")
    return path


def test_a_flight_reads_what_was_found_and_keeps_its_own_number_of_what_was_not(tmp_path: Path) -> None:
    hover, mass_ratio = (
        VehicleFinding("hover_throttle", 0.7, 0.002, "", "throttle"),
        VehicleFinding("effective_mass_ratio", 1.9, 0.3, "", "mass", "too short"),
    )
    own = read_flight(written(tmp_path, found(hover_throttle=hover, effective_mass_ratio=mass_ratio))).pilot.follower
    assert own.hover_throttle == 0.7
    assert own.ego_motion.effective_mass_ratio == FlightParameters().pilot.follower.ego_motion.effective_mass_ratio
    text = (tmp_path / "vehicle.toml").read_text()
    assert "hover_throttle = 0.7    # no unit, +- 0.002, 2026-11-23; throttle" in text
    assert "# effective_mass_ratio: not found: too short" in text


def test_every_number_has_its_standard_deviation_unit_and_date_for_programs(tmp_path: Path) -> None:
    path = written(tmp_path, found(sag=VehicleFinding("sag", 0.001, 0.0003, "1/s", "sag", "unsteady")))
    numbers = {each.name: each for each in read_settings(path.read_text(), ConfigFile, "it").identified}
    assert set(numbers) == set(SHOWN)
    assert {each.date for each in numbers.values()} == {DAY}
    assert (numbers["sag"].sigma, numbers["sag"].unit, numbers["sag"].found) == (0.0003, "1/s", False)
    assert numbers["hover_throttle"].found


def test_a_delay_that_is_none_is_written_as_the_least(tmp_path: Path) -> None:
    early = VehicleFinding("delay", -0.004, 0.001, "s", "delay")
    path = written(tmp_path, found(delay=early))
    assert read_flight(path).pilot.follower.ego_motion.delay == 0.001
    assert "found -0.0040" in path.read_text()


@pytest.mark.parametrize("source", ["serial:///dev/x\n[flight]\nduration = 1", 'a "quoted" \\ name', "\r\n\tx"])
def test_no_name_of_a_link_breaks_the_file(tmp_path: Path, source: str) -> None:
    assert read_flight(written(tmp_path, found(), source)).duration == FlightParameters().duration


def test_a_file_of_another_version_is_refused_with_its_line(tmp_path: Path) -> None:
    path = written(tmp_path, found())
    path.write_text(path.read_text().replace("tilt_lag =", "tilt_pole =", 1))
    line = next(k for k, words in enumerate(path.read_text().splitlines(), 1) if "tilt_pole" in words)
    with pytest.raises(ValueError, match=rf"vehicle\.toml, line {line}: .*tilt_pole"):
        read_flight(path)


@pytest.mark.parametrize(
    ("finding", "words"),
    [
        (VehicleFinding("hover_throttle", 0.70361, 0.00091, "", ""), "70.361 +- 0.091 %"),
        (VehicleFinding("delay", 0.09367, 0.00069, "s", ""), "93.67 +- 0.69 ms"),
        (VehicleFinding("yaw_trim", 0.1, 0.02, "rad/s", ""), "5.7 +- 1.1 degrees/s"),
        (VehicleFinding("effective_mass_ratio", 1.23, 0.4, "", ""), "1.23 +- 0.40"),
        (VehicleFinding("full_tilt", 0.35, 0.0, "rad", ""), "degrees"),
    ],
)
def test_people_get_degrees_and_ms_to_the_digit_that_is_known(finding: VehicleFinding, words: str) -> None:
    assert words in finding.words
    assert msgspec.structs.replace(finding, missing="why").words == finding.words
