from pathlib import Path

import pytest

import matchset as ms
from matchset.flight.chain.config import default_toml, flight_parameters, read_flight, with_uri, with_world
from matchset.flight.chain.flight_parameters import FlightParameters


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_template_holds_every_default(tmp_path: Path) -> None:
    assert read_flight(written(tmp_path, default_toml())) == FlightParameters()


def test_every_line_of_the_template_has_a_unit_and_a_source() -> None:
    for line in default_toml().splitlines():
        if "=" in line.split("#")[0]:
            unit, rest = line.split("#", 1)[1].split(",", 1)
            assert unit.strip(), line
            assert len(rest.strip()) > 4, line


def test_what_a_file_leaves_out_is_as_it_was(tmp_path: Path) -> None:
    flight = read_flight(written(tmp_path, "[flight]\nduration = 5\n[flight.world]\nswing = 0.2\n"))
    assert (flight.duration, flight.world.swing, flight.world.vehicles) == (5.0, 0.2, 3)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("swing = 0.1 ", "swimg = 0.1 "),
        ("proportional = 0.3 ", "proportional = -0.3 "),
        ("seed = 0 ", 'seed = "x" '),
        ("hold_time = 1.0 ", "hold_time = -1.0 "),
        ("latency_ms = 67.0", "latency_ms = 9999.0"),
        ("gate = 5.0", "gate = 0.0"),
        ("duration = 60.0", "duration = nan"),
        ("pal = ", "pal = 7 # "),
    ],
)
def test_what_is_wrong_is_refused_with_its_key_and_line(tmp_path: Path, old: str, new: str) -> None:
    text = default_toml()
    assert old in text
    text = text.replace(old, new, 1)
    line = next(k for k, words in enumerate(text.splitlines(), 1) if new in words)
    with pytest.raises(ValueError, match=rf"mine\.toml, line {line}: .*{new.split(' =')[0]}"):
        read_flight(written(tmp_path, text))


def test_a_camera_for_another_size_is_refused(tmp_path: Path) -> None:
    ms.CameraModel.from_fov(720, 576, 1.2).save(tmp_path / "camera.toml")
    with pytest.raises(ValueError, match=r"line 1: camera is for 720 x 576 px.*width and height are 640 x 480"):
        read_flight(written(tmp_path, 'camera = "camera.toml"\n'))
    text = 'camera = "camera.toml"\n[flight.world]\nwidth = 720\nheight = 576\n'
    assert read_flight(written(tmp_path, text)).world.camera.fx == ms.CameraModel.from_fov(720, 576, 1.2).fx


def test_a_uri_and_options_change_only_what_they_say(tmp_path: Path) -> None:
    flight = flight_parameters(written(tmp_path, "[flight.world]\nswing = 0.2\nseed = 3\n"), 7.0)
    flight = with_uri("sim://chain?seed=9", flight)
    assert (flight.world.seed, flight.world.swing, flight.duration) == (9, 0.2, 7.0)
    with pytest.raises(ValueError, match="vehicles"):
        with_world(flight, vehicles=100)
