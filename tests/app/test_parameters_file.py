import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from blue_ball import Matchset, ball_picture
from matchset.app.parameters_file import parameters_toml, tracker_parameters
from matchset.app.track.rows import TrackRow, read_tracks
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.parameters import TrackerParameters


def read(folder: Path, text: str) -> TrackerParameters:
    path = folder / "tracker.toml"
    path.write_text(text)
    return tracker_parameters(path)


def numbers(struct: Any) -> Iterator[tuple[Any, str]]:
    """Every parameter that is no struct, with the struct it belongs to."""
    for name in struct.__struct_fields__:
        value = getattr(struct, name)
        if isinstance(value, msgspec.Struct):
            yield from numbers(value)
        else:
            yield struct, name


def test_what_is_printed_is_read_back(tmp_path: Path) -> None:
    parameters, constants = TrackerParameters(), TrackerConstants()
    assert read(tmp_path, parameters_toml(parameters)).resolved() == constants
    match = msgspec.structs.replace(constants.match, full_step=0.0703125)
    changed = TrackerParameters(coast=0.125, constants=msgspec.structs.replace(constants, match=match))
    assert read(tmp_path, parameters_toml(changed)) == changed


def test_a_file_may_hold_some_of_them(tmp_path: Path) -> None:
    found = read(tmp_path, "coast = 1\n[match]\nfull_step = 0.07\n").resolved()
    assert found.coast == 1.0
    assert found.match.full_step == 0.07
    assert msgspec.structs.replace(found, coast=0.35, match=TrackerConstants().match) == TrackerConstants()
    limits = read(
        tmp_path, "[adaptation]\nmax_drift = 1.5\nforeign_below = -1\n[brightness]\nsamples = 48\n"
    ).resolved()
    assert (limits.adaptation.max_drift, limits.adaptation.foreign_below, limits.brightness.samples) == (1.5, -1.0, 48)
    assert read(tmp_path, "") == tracker_parameters(None) == TrackerParameters()


def test_every_parameter_is_printed_with_its_meaning_and_default() -> None:
    text = parameters_toml(TrackerParameters())
    lines = text.splitlines()
    for struct, name in numbers(TrackerConstants()):
        (first, *_) = [place for place, line in enumerate(lines) if line.removeprefix("# ").startswith(f"{name} = ")]
        assert lines[first - 1].startswith("# Default: "), name
        assert lines[first - 2].startswith("# "), f"{type(struct).__name__}.{name} has no description"
    assert all(len(line) <= 100 for line in lines if line.startswith("#"))
    assert tomllib.loads(text)["match"]["full_step"] == TrackerConstants().match.full_step


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("coats = 1.0", "there is no parameter 'coats'; 'matchset params' prints all"),
        ("[match]\nfull_steps = 1.0", "there is no parameter 'match.full_steps'"),
        ("[matches]\nfull_step = 1.0", "there is no parameter 'matches'"),
        ("match = 3", "match must be a table, got 3"),
        ('coast = "long"', "coast must be a number, got 'long'"),
        ("coast = true", "coast must be a number, got True"),
        ("coast = -0.1", "coast must be 0 or more, got -0.1"),
        ("coast = nan", "coast must be a number up to 1e+06, got nan"),
        ("coast = inf", "coast must be a number up to 1e+06, got inf"),
        (f"[search]\ncells = 1{'0' * 400}", "search.cells must be a number up to 1e+06, got 1000"),
        ("[search]\ncells = 0", "search.cells must be 1 or more, got 0"),
        ("[match]\nmargin = 2.5", "match.margin must be a whole number, got 2.5"),
        ("[search]\nwhole_frame = 1", "search.whole_frame must be true or false, got 1"),
        ("coast = ", "is not TOML"),
        ("version = 2", "version must be 1, got 2: it is of another matchset"),
        ("looks = 2.5", "looks must be a whole number, got 2.5"),
        ("agility = 1.5", "agility must be 1 or less, got 1.5"),
    ],
)
def test_a_wrong_file_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], text: str, words: str
) -> None:
    Path("wrong.toml").write_text(text)
    cv2.imwrite("ball.png", ball_picture((50.0, 60.0)))
    before = sorted(Path().iterdir())
    for command in (
        ("params",),
        ("track", "ball.png", "--pick", "50,60"),
        ("locate", "ball.png", "--pick", "50,60", "--fov", "60", "--diameter", "0.28"),
    ):
        assert matchset(*command, "--params", "wrong.toml") == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith("error: wrong.toml")
        assert words in line
    assert sorted(Path().iterdir()) == before
    assert matchset("params", "--params", "none.toml") == 2
    assert capsys.readouterr().err == "error: no such file: none.toml\n"


@settings(max_examples=60)
@given(st.binary(max_size=100) | st.text(max_size=100).map(str.encode))
def test_any_other_file_is_read_or_refused_with_its_name(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.mktemp("any") / "tracker.toml"
    path.write_bytes(content)
    problem = str(path)
    try:
        tracker_parameters(path)
    except ValueError as error:
        problem = str(error)
    assert str(path) in problem


def test_the_printed_parameters_change_nothing_and_a_changed_number_changes_tracking(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def track(folder: str, *options: str) -> list[TrackRow]:
        assert matchset("track", ball_video, "--pick", "50,60", "-o", folder, *options) in (0, 1)
        capsys.readouterr()
        return read_tracks(f"{folder}/tracks.csv")

    assert matchset("params") == 0
    Path("same.toml").write_text(capsys.readouterr().out)
    Path("other.toml").write_text("[fit]\nmax_iterations = 1\n[match]\nmargin = 2\n")
    plain = track("plain")
    assert track("same", "--params", "same.toml") == plain
    other = track("other", "--params", "other.toml")
    assert len(other) == len(plain)
    assert other != plain
    assert np.all([row.found for row in plain])


def test_a_search_of_one_candidate_finds_one_ball(matchset: Matchset, ball_video: Path) -> None:
    Path("one.toml").write_text("[search]\ncandidates = 1\n")
    assert matchset("track", ball_video, "--hsv", "100,100,50:130,255,255", "--params", "one.toml", "-o", "out") == 0
    assert all(row.found for row in read_tracks("out/tracks.csv"))
