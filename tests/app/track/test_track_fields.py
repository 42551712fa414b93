"""`matchset track --fields`: a row for each half-frame, and the same option in the next command."""

import csv
from pathlib import Path

import cv2
import pytest

from blue_ball import Matchset
from interlaced_videos import ball_clip, circle_at, pictures_of
from matchset.app.cli_options import ViewOptions


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "interlaced"
    made.mkdir()
    for index, picture in enumerate(pictures_of(ball_clip())):
        cv2.imwrite(str(made / f"{index}.png"), picture)
    return made


@pytest.mark.parametrize("fields", ["top", "auto"])
def test_every_half_frame_has_a_row(
    matchset: Matchset, folder: Path, fields: str, capsys: pytest.CaptureFixture[str]
) -> None:
    clip = ball_clip()
    x, y = clip.first_click
    assert matchset("track", folder, "--pick", f"{x:.0f},{y:.0f}", "--fields", fields, "-o", "out", "--no-video") == 0
    with Path("out/tracks.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [int(row["frame"]) for row in rows] == list(range(24))
    for row in rows:
        where = circle_at(clip, float(row["time"]))
        assert (float(row["x"]), float(row["y"])) == pytest.approx(where[:2], abs=1.0)
    said = capsys.readouterr().err
    assert said.count("the pictures are interlaced, the top field first") == (fields == "auto")


def test_a_wrong_word_is_one_line(matchset: Matchset, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("track", folder, "--pick", "5,5", "--fields", "odd") == 2
    assert "fields must be one of frames, top, bottom, auto, got 'odd'" in capsys.readouterr().err


def test_the_next_command_keeps_it() -> None:
    assert ViewOptions(fields="bottom").words == ("--fields", "bottom")
    assert ViewOptions().words == ()
