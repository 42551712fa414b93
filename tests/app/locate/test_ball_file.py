import math
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.app.locate.what_options_name import ball_target, read_ball


def write(folder: Path, text: str) -> Path:
    path = folder / "ball.toml"
    path.write_text(text)
    return path


def test_directions_may_have_any_length(tmp_path: Path) -> None:
    target = ball_target(None, None, write(tmp_path, "diameter = 1\nmarkers = [[0, 0, 3], [0.5, 0, 0]]"), True)
    assert target.diameter == 1.0
    assert target.markers == ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    assert target.marker_diameter == 0.06


def test_what_is_typed_counts_more_than_the_file(tmp_path: Path) -> None:
    path = write(tmp_path, "diameter = 1.0\nmarker_diameter = 0.2\nmarkers = [[0, 0, 1]]")
    target = ball_target(0.5, 0.1, path, True)
    assert (target.diameter, target.marker_diameter) == (0.5, 0.1)


@pytest.mark.parametrize("diameter", [0.001, 0.28, 30.0])
def test_a_ball_without_markers_may_have_any_size(diameter: float) -> None:
    target = ball_target(diameter, None, None, False)
    assert (target.diameter, target.markers) == (diameter, ())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "markers"),
        ("markers = []", "markers is empty"),
        ("markers = [[0, 0]]", "markers"),
        ("markers = [[0, 0, 0]]", "not all zero"),
        ("markers = [[0, 0, nan]]", "must be directions"),
        ("markers = [[0, 0, 1]]\nsize = 3", "size"),
        ('markers = [[0, 0, 1]]\ndiameter = "large"', "diameter"),
        ("markers = [[0, 0, 1]]\ndiameter = -1.0", "must be positive, got -1.0 m"),
        ("markers = [[0, 0, 1], [0, 0.1, 1]]\ndiameter = 0.28", "10 degrees apart"),
        ("no toml", "ball.toml"),
    ],
)
def test_a_bad_file_is_a_clear_error(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ValueError, match=words.replace("[", r"\[")):
        ball_target(None, None, write(tmp_path, text), True)


@settings(max_examples=40)
@given(st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
def test_any_other_file_is_a_value_error(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.mktemp("any") / "ball.toml"
    path.write_bytes(content)
    with suppress(ValueError):
        assert all(math.isclose(float(np.linalg.norm(marker)), 1.0) for marker in read_ball(path).markers)
