import json
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from matchset.app.track.rows import TrackRow, read_tracks, track_row, track_table
from matchset.app.track.score import read_truth
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

NAMES = ("x", "y", "radius")


def track(std: float = 0.1) -> Track[Circle]:
    return Track(Circle(10.123456, 20.0, 5.0), np.eye(3) * std**2, 0.93, np.zeros((4, 2)), 1.5)


def test_a_table_is_read_back_as_it_was_written(tmp_path: Path) -> None:
    rows = [
        track_row(0, track()),
        track_row(1, Lost('it left, so "it" said\nthe picture', 1.6)),
        track_row(5, track(2.0)),
    ]
    with track_table(tmp_path / "tracks.csv", NAMES, tmp_path / "tracks.jsonl") as table:
        for row in rows:
            table.write(row)
    assert read_tracks(tmp_path / "tracks.csv") == rows
    lines = (tmp_path / "tracks.jsonl").read_text().splitlines()
    assert [json.loads(line)["frame"] for line in lines] == [0, 1, 5]
    assert json.loads(lines[1])["x"] is None


def test_the_columns_are_those_of_the_design(tmp_path: Path) -> None:
    with track_table(tmp_path / "tracks.csv", NAMES) as table:
        table.write(track_row(7, track()))
        table.write(track_row(8, Lost("gone", 2.0)))
    head, found, lost = (tmp_path / "tracks.csv").read_text().splitlines()
    assert head == "frame,time,found,x,y,radius,x_std,y_std,radius_std,support,reason"
    assert found == "7,1.5,1,10.1235,20.0,5.0,0.1,0.1,0.1,0.93,"
    assert lost == "8,2.0,0,,,,,,,,gone"


def test_an_infinite_variance_leaves_its_cell_empty(tmp_path: Path) -> None:
    with track_table(tmp_path / "tracks.csv", NAMES) as table:
        table.write(track_row(0, msgspec.structs.replace(track(), covariance=np.diag([np.inf, np.nan, 0.25]))))
    text = (tmp_path / "tracks.csv").read_text()
    assert "nan" not in text
    assert "inf" not in text
    assert read_tracks(tmp_path / "tracks.csv")[0].std == {"radius": 0.5}


def test_every_row_is_on_disk_before_the_next_one(tmp_path: Path) -> None:
    table = track_table(tmp_path / "tracks.csv", NAMES)
    for index in range(3):
        table.write(track_row(index, track()))
        assert len(read_tracks(tmp_path / "tracks.csv")) == index + 1
    table.close()


def test_a_table_of_another_program_is_read(tmp_path: Path) -> None:
    path = tmp_path / "other.csv"
    path.write_text("\ufeffframe,found,radius,y,x\r\n4,1,3,2,1\r\n\r\n2,0,,,\r\n")
    assert read_tracks(path) == [TrackRow(2, 0.0), TrackRow(4, 0.0, {"radius": 3.0, "y": 2.0, "x": 1.0}, {})]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        ("frame,found\n", "line 1: there is no column x, y, radius"),
        ("frame,found,x,y,radius,x\n", "named twice"),
        ("frame,found,x,y,radius\n0,1,1,2\n", "line 2: 5 cells were expected, got 4"),
        ("frame,found,x,y,radius\n0,1,1,nan,3\n", "line 2: y must be a number, got 'nan'"),
        ("frame,found,x,y,radius\n0,2,1,1,3\n", "line 2: found must be 0 or 1, got '2'"),
        ("frame,found,x,y,radius\n-1,1,1,1,3\n", "line 2: frame must be an integer from 0, got '-1'"),
        ("frame,found,x,y,radius\n0,0,,,\n0,0,,,\n", "line 3: frame 0 was given before"),
        ('frame,found,x,y,radius\n0,"0', "is not a CSV table"),
    ],
)
def test_a_broken_table_says_where(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "tracks.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"tracks\.csv") as caught:
        read_tracks(path)
    assert words in str(caught.value)


def test_a_missing_table_is_a_value_error(tmp_path: Path) -> None:
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(ValueError, match="cannot read"):
            read_tracks(path)


TRUTH = "video,frame,x,y,r,visible,method\n"


def test_truth_is_read_by_its_rules(tmp_path: Path) -> None:
    path = tmp_path / "truth.csv"
    path.write_text(TRUTH + "a.mp4,9,1,2,3,1,eye|lowconf\na.mp4,5,,,,0,eye:absent\na.mp4,7,4,5,6,1,eye\n")
    absent, good, low = read_truth(path)
    assert (absent.frame, absent.circle, absent.tight) == (5, None, False)
    assert (good.frame, good.circle, good.tight) == (7, (4.0, 5.0, 6.0), True)
    assert (low.frame, low.lowconf, low.tight) == (9, True, False)


def test_truth_of_several_videos_needs_a_choice(tmp_path: Path) -> None:
    path = tmp_path / "truth.csv"
    path.write_text(TRUTH + "a.mp4,1,1,1,1,1,eye\nb.mp4,1,2,2,2,1,eye\n")
    with pytest.raises(ValueError, match=r"several videos \(a.mp4, b.mp4\)"):
        read_truth(path)
    assert read_truth(path, "b.mp4")[0].circle == (2.0, 2.0, 2.0)
    with pytest.raises(ValueError, match=r"no rows of the video 'c\.mp4'"):
        read_truth(path, "c.mp4")


def test_a_truth_radius_must_be_positive(tmp_path: Path) -> None:
    path = tmp_path / "truth.csv"
    path.write_text(TRUTH + "a.mp4,1,1,1,0,1,eye\n")
    with pytest.raises(ValueError, match="line 2: the radius must be positive"):
        read_truth(path)


line = st.text(alphabet='0123456789.,-"\n\r aeinx_é\0', max_size=60)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.one_of(st.binary(max_size=200), line.map(str.encode)), st.booleans())
def test_any_bytes_are_read_or_refused_in_words(tmp_path: Path, data: bytes, with_head: bool) -> None:
    for head, read in (
        (b"frame,time,found,x,y,radius,x_std,support,reason\n", read_tracks),
        (TRUTH.encode(), read_truth),
    ):
        path = tmp_path / "any.csv"
        path.write_bytes((head if with_head else b"") + data)
        problem = "any.csv"
        try:
            read(path)
        except ValueError as error:
            problem = str(error)
        assert "any.csv" in problem
