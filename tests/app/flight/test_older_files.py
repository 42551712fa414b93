"""Settings and recordings that were written when a ball had a marker by default mean what they meant."""

from pathlib import Path
from typing import Any

import msgspec
import pytest

from matchset.app.flight.config import default_toml, read_flight
from matchset.app.flight.flight import FlightParameters
from matchset.app.recording.encoding import decode, encode
from matchset.app.recording.messages import FORMAT, Configuration
from matchset.camera.camera_model import CameraModel
from matchset.localization.ball_target import BALLOON

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
