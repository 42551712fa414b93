"""Settings and recordings that were written before mean what they meant: without a marker, and with older keys."""

import json
from pathlib import Path
from typing import Any

import msgspec
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.config import ConfigFile, default_toml, read_flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.recording.encoding import decode, encode
from matchset.flight.recording.messages import FORMAT, Configuration
from matchset.localization.ball_target import BALLOON
from older_names import with_older_keys

FRONT = ((0.0, 0.0, 1.0),)


@pytest.mark.parametrize(
    ("text", "diameter", "across"),
    [
        ("", 0.28, 0.06),
        ("[flight.pilot.target]\ndiameter = 0.25", 0.25, 0.06),
        ("[flight.pilot.target]\nmarker_diameter = 0.05", 0.28, 0.05),
        ("[flight.pilot.target]\ndiameter = 0.3\nmarker_diameter = 0.1\nmarkers = [[0.0, 0.0, 1.0]]", 0.3, 0.1),
    ],
)
def test_settings_that_name_no_marker_have_the_one_in_front(
    tmp_path: Path, text: str, diameter: float, across: float
) -> None:
    (tmp_path / "flight.toml").write_text(text)
    target = read_flight(tmp_path / "flight.toml").pilot.target
    assert (target.diameter, target.markers, target.marker_diameter) == (diameter, FRONT, across)
    assert target.diameter_sigma == 0.0


def test_the_template_is_the_default(tmp_path: Path) -> None:
    (tmp_path / "flight.toml").write_text(default_toml())
    assert read_flight(tmp_path / "flight.toml").pilot.target == FlightParameters().pilot.target
    assert msgspec.structs.astuple(FlightParameters().pilot.target) == msgspec.structs.astuple(BALLOON)


def recorded(target: dict[str, Any], camera: CameraModel) -> Configuration:
    """A recording's first message as it was written before: its target has no other keys."""
    message = Configuration(format=FORMAT, matchset="0.1.0", parameters=FlightParameters(), cameras=(camera,))
    fields = msgspec.msgpack.decode(encode(message))
    fields["parameters"]["pilot"]["target"] = target
    return decode(encode(fields), Configuration)


@pytest.mark.parametrize("markers", [FRONT, ()])
def test_a_recording_has_the_ball_that_it_had(markers: Any) -> None:
    camera = CameraModel.from_fov(640, 480, 1.0)
    read = recorded({"diameter": 0.25, "markers": markers, "marker_diameter": 0.06}, camera)
    target = read.parameters.pilot.target
    assert (target.diameter, target.markers, target.diameter_sigma) == (0.25, markers, 0.0)
    assert target.marker_diameter == (0.06 if markers else 0.0)
    assert read.cameras == (camera,)


def toml(table: dict[str, Any], path: str = "") -> str:
    """Write numbers, texts and tables as TOML."""
    lines = [f"{key} = {json.dumps(value)}" for key, value in table.items() if isinstance(value, float | int | str)]
    inner = [toml(value, f"{path}.{key}".strip(".")) for key, value in table.items() if isinstance(value, dict)]
    return "\n".join([f"[{path}]" if path else "", *lines, *inner])


CHANGED = {
    "flight": {
        "long_chain": {"short_followers": 3, "tilt_sigma": 0.02},
        "pilot": {
            "safety": {"hold_time": 0.9, "max_frame_age": 0.25},
            "follower": {
                "hover_throttle": 0.5,
                "ego_motion": {"effective_mass_ratio": 1.3, "speed_commands": False},
                "horizontal": {"proportional": 3.0, "derivative": 2.0, "output_limit": 2.5},
                "horizontal_feedforward": {"crossover_time": 0.3},
                "motion_consistency": {"max_evidence": 2.0, "delay_estimator": {"min_time": 0.2}},
                "speeds": {"vertical": {"proportional": 1.0, "max_error": 0.4}},
            },
        },
    }
}


def test_settings_with_older_keys_mean_the_same_and_it_is_said_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, now = tmp_path / "before.toml", tmp_path / "now.toml"
    before.write_text(toml(with_older_keys(CHANGED, ConfigFile)))
    now.write_text(toml(CHANGED))
    assert "[flight.pilot.follower.answer.latency]\nquick = 0.2" in before.read_text()
    assert read_flight(now).pilot.follower.motion_consistency.delay_estimator.min_time == 0.2
    assert capsys.readouterr().err == ""
    assert read_flight(before) == read_flight(now) == read_flight(before) != FlightParameters()
    assert capsys.readouterr().err.count(f"note: {before} has older names of 19 settings, which are read: ") == 1


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hold = 1.0\nhold_time = 1.0", "line 2: hold_time is there twice: hold is its older name"),
        ("\nhold = -1.0", "line 3: hold_time must be positive, got -1.0"),
        ("holds = 1.0", "line 2: Object contains unknown field `holds`"),
        ("hold = 'long'", "line 2: Expected `float`, got `str`"),
    ],
)
def test_an_older_key_is_refused_as_any_other_with_its_line(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "flight.toml").write_text(f"[flight.pilot.safety]\n{text}\n")
    with pytest.raises(ValueError, match=words):
        read_flight(tmp_path / "flight.toml")
