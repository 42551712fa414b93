import csv
import itertools
import json
import math
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from blue_ball import Matchset
from marked_balloon import BLUE, CAMERA, FOV_DEG, FRAMES, PURPLE, SIZE, flight, place, turn, write_video
from matchset.app.locate.rows import PoseRow, read_poses
from matchset.app.track.loop import UNDECODED
from matchset.image.errors import LinkError
from matchset.image.frame import Frame

BALL = "--fov", f"{FOV_DEG}", "--diameter", "0.28"
SIDES = ((0.0, 0.0, 1.0), (math.sin(0.9), 0.0, math.cos(0.9)), (-math.sin(0.6), -0.0, math.cos(0.6)))


@pytest.fixture(scope="session")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("flight") / "flight.avi"
    write_video(str(path), flight())
    return path


def check_positions(rows: list[PoseRow]) -> None:
    assert [row.frame for row in rows] == list(range(FRAMES))
    for row in rows:
        assert row.values is not None, row.reason
        assert row.std is not None
        error = np.array([row.values[name] for name in "xyz"]) - place(row.time)
        assert np.abs(error).max() < 0.02
        assert all(0.0 < row.std[name] < 0.05 for name in "xyz")
        assert ("yaw" in row.values) == ("side" in row.values) == (row.observed != "position")
        if row.observed != "position":
            assert row.values["yaw"] == pytest.approx(math.atan2(row.values["x"], row.values["z"]), abs=2e-6)


def test_a_ball_is_placed_in_every_frame(matchset: Matchset, flown: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("locate", flown, *BALL, "--pick", BLUE, "--jsonl", "--video", "out.webm") == 0
    rows = read_poses("runs/0001-locate/poses.csv")
    check_positions(rows)
    assert {row.observed for row in rows} == {"position"}
    assert not any("side" in (row.values or {}) for row in rows)
    assert len(Path("runs/0001-locate/poses.jsonl").read_text().splitlines()) == FRAMES
    assert frames_of(Path("out.webm")) == FRAMES
    picture = cv2.imread("runs/0001-locate/poses.png")
    assert picture is not None
    assert picture.shape[0] > 700
    out = capsys.readouterr().out
    assert "found in 20 of 20 frames (100.0 %)" in out
    assert "runs/0001-locate/poses.png" in out
    left_out = "± leaves out errors of the camera and of the diameter: say how large they are by"
    assert out.count("leaves out") == 1
    assert f"{left_out} --focal-sigma and --diameter-sigma\n" in out
    lines = [json.loads(line) for line in Path("runs/0001-locate/poses.jsonl").read_text().splitlines()]
    assert {line["yaw"] for line in lines} == {None}


@pytest.mark.usefixtures("no_path_picture")
def test_what_is_told_of_camera_and_diameter_counts_in_every_row(
    matchset: Matchset, flown: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = *BALL, "--pick", BLUE, "--end", "0.2s", "--no-video"
    assert matchset("locate", flown, *options, "-o", "plain") == 0
    assert matchset("locate", flown, *options, "--focal-sigma", "0.05", "--diameter-sigma", "0.004", "-o", "told") == 0
    assert capsys.readouterr().out.count("leaves out") == 1  # of the first run
    for plain, told in zip(read_poses("plain/poses.csv"), read_poses("told/poses.csv"), strict=True):
        assert plain.values == told.values
        assert plain.values is not None
        assert plain.std is not None
        assert told.std is not None
        share = math.hypot(0.05, 0.004 / 0.28)
        assert told.std["z"] == pytest.approx(math.hypot(plain.std["z"], share * plain.values["z"]), rel=0.05)
        assert plain.std["z"] < 0.3 * told.std["z"]


@pytest.mark.usefixtures("no_path_picture")
def test_a_calibrated_camera_brings_its_own(
    matchset: Matchset, flown: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    CAMERA.with_focal_sigma(0.01).save("camera.toml")
    options = "--camera", "camera.toml", "--diameter", "0.28", "--pick", BLUE, "--end", "0.2s", "--no-video"
    assert matchset("locate", flown, *options, "-o", "file") == 0
    assert (
        "± leaves out errors of the diameter: say how large they are by --diameter-sigma\n" in capsys.readouterr().out
    )
    assert matchset("locate", flown, *options, "--focal-sigma", "0.04", "-o", "typed") == 0
    file, typed = read_poses("file/poses.csv"), read_poses("typed/poses.csv")
    for one, other in zip(file, typed, strict=True):
        assert one.values is not None
        assert one.std is not None
        assert other.std is not None
        assert one.std["z"] > 0.0095 * one.values["z"]
        assert other.std["z"] == pytest.approx(0.04 * one.values["z"], rel=0.06)


def frames_of(path: Path) -> int:
    video = cv2.VideoCapture(str(path))
    return next(count for count in range(100_000) if not video.grab())


@pytest.mark.usefixtures("no_path_picture")
def test_one_marker_gives_the_numbers_of_the_paper(matchset: Matchset, flown: Path) -> None:
    CAMERA.save("camera.toml")
    options = "--camera", "camera.toml", "--diameter", "0.28", "--pick", BLUE, "--marker-pick", f"{PURPLE}@0"
    assert matchset("locate", flown, *options, "-o", "out", "--video", "out.webm") == 0
    rows = read_poses("out/poses.csv")
    check_positions(rows)
    for row in rows:
        assert row.observed == "level"
        assert row.values is not None
        seen = -turn(row.time).inv().apply(place(row.time))
        found = [row.values["side"], -row.values["height"], row.values["heading"]]
        assert found == pytest.approx(seen.tolist(), abs=0.06)
    with Path("out/poses.csv").open() as file:
        head = ",".join(next(csv.reader(file)))
    assert head == (
        "frame,time,found,x,y,z,x_std,y_std,z_std,side,height,heading,yaw,"
        "side_std,height_std,heading_std,yaw_std,observed,reason"
    )


@pytest.mark.usefixtures("no_path_picture")
def test_several_markers_come_from_a_file(matchset: Matchset) -> None:
    write_video("three.avi", flight(SIDES))
    lines = "\n".join(f"  [{10 * x}, {10 * y}, {10 * z}]," for x, y, z in SIDES)
    Path("ball.toml").write_text(f"diameter = 0.28\nmarker_diameter = 0.06\nmarkers = [\n{lines}\n]\n")
    options = "--fov", FOV_DEG, "--markers", "ball.toml", "--pick", BLUE, "--marker-pick", PURPLE, "--no-video"
    assert matchset("locate", "three.avi", *options, "-o", "out") == 0
    rows = read_poses("out/poses.csv")
    check_positions(rows)
    assert {row.observed for row in rows} == {"full"}
    assert not (Path("out") / "poses.jsonl").exists()


def one_error(capsys: pytest.CaptureFixture[str]) -> str:
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    assert lines[0].startswith("error: ")
    return lines[0].removeprefix("error: ")


PICK = "--pick", BLUE


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--diameter", "0.28", *PICK), "say what the camera is like: --camera FILE"),
        ((*BALL, *PICK, "--camera", "good.toml"), "one of the two"),
        ((*PICK, "--fov", "0", "--diameter", "0.28"), "--fov must lie between 0 and 180 degrees, got 0"),
        ((*PICK, "--fov", "180", "--diameter", "0.28"), "--fov must lie between 0 and 180 degrees, got 180"),
        ((*PICK, "--fov", "nan", "--diameter", "0.28"), "--fov must lie between 0 and 180 degrees, got nan"),
        ((*PICK, "--fov", "60"), "say how large the ball is: --diameter 0.28, in m"),
        ((*PICK, "--fov", "60", "--diameter", "0"), "a ball's diameter must be positive, got 0.0 m"),
        ((*PICK, "--fov", "60", "--diameter", "-0.28"), "a ball's diameter must be positive, got -0.28 m"),
        ((*PICK, "--fov", "60", "--diameter", "nan"), "a ball's diameter must be positive, got nan m"),
        (
            (*BALL, *PICK, "--focal-sigma", "1"),
            "--focal-sigma is a share of the focal length, from 0 to 1: 0.05 is 5 %",
        ),
        ((*BALL, *PICK, "--focal-sigma", "nan"), "--focal-sigma is a share of the focal length"),
        ((*BALL, *PICK, "--diameter-sigma", "-0.01"), "diameter_sigma must be 0 or more"),
        ((*BALL, *PICK, "--diameter-sigma", "0.28"), "less than the diameter of 0.28 m, got 0.28 m"),
        ((*PICK, "--camera", "none.toml", "--diameter", "0.28"), "no such camera file: none.toml"),
        ((*PICK, "--camera", "bad.toml", "--diameter", "0.28"), "bad.toml: fx must be a positive number of px"),
        ((*PICK, "--camera", "large.toml", "--diameter", "0.28"), "the picture is 320 x 240 px, the camera's are 640"),
        ((*BALL, *PICK, "--marker-diameter", "0.06"), "--marker-diameter needs the markers' color"),
        ((*BALL, *PICK, "--markers", "ball.toml"), "--markers needs the markers' color"),
        ((*BALL, *PICK, "--marker-pick", PURPLE, "--marker-diameter", "0.3"), "a marker must be smaller than its ball"),
        ((*BALL, *PICK, "--marker-pick", PURPLE, "--marker-color", "a.npz"), "give one of --marker-pick and"),
        ((*BALL, *PICK, "--marker-pick", "7"), "--marker-pick is X,Y or X,Y@FRAME"),
        ((*BALL, *PICK, "--marker-pick", "5,5@99"), "there is no frame 99"),
        ((*BALL, *PICK, "--marker-color", "none.npz"), "none.npz"),
        ((*BALL, *PICK, "--marker-pick", PURPLE, "--markers", "none.toml"), "no such file: none.toml"),
        (BALL, "say what to follow"),
        ((*BALL, *PICK, "--video", "out.gif"), "must end in .mp4, .webm, .avi"),
    ],
)
def test_misuse_is_one_line_and_leaves_nothing(
    matchset: Matchset,
    flown: Path,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    words: str,
) -> None:
    CAMERA.save("good.toml")
    text = Path("good.toml").read_text()
    Path("bad.toml").write_text(text.replace(f"fx = {CAMERA.fx!r}", "fx = -1.0"))
    Path("large.toml").write_text(text.replace("width = 320", "width = 640"))
    before = sorted(Path().iterdir())
    assert matchset("locate", flown, *options) == 2
    assert words in one_error(capsys)
    assert sorted(Path().iterdir()) == before


@pytest.mark.usefixtures("no_path_picture")
def test_nothing_is_overwritten(matchset: Matchset, flown: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = "locate", flown, *BALL, "--pick", BLUE, "--no-video", "-o", "out"
    assert matchset(*command) == 0
    capsys.readouterr()
    assert matchset(*command) == 2
    assert one_error(capsys) == "the folder out is not empty: choose another, or overwrite with --force"
    assert matchset(*command, "--force") == 0


def test_a_ball_that_is_never_found_ends_with_one_and_no_picture(matchset: Matchset, flown: Path) -> None:
    assert matchset("locate", flown, *BALL, "--hsv", "50,250,250:55,255,255", "--end", 3, "-o", "out") == 1
    rows = read_poses("out/poses.csv")
    assert len(rows) == 3
    assert all(row.reason and row.values is None for row in rows)
    assert "nan" not in Path("out/poses.csv").read_text().lower()
    assert not Path("out/poses.png").exists()


@pytest.mark.usefixtures("no_path_picture")
def test_a_broken_frame_has_a_row_that_says_so(matchset: Matchset) -> None:
    Path("frames").mkdir()
    for frame in flight():
        cv2.imwrite(f"frames/{frame.index:02d}.png", frame.image)
    Path("frames/07.png").write_bytes(b"\x89PNG broken")
    assert matchset("locate", "frames", *BALL, "--pick", BLUE, "-o", "out", "--video", "out.webm") == 0
    rows = read_poses("out/poses.csv")
    assert [row.frame for row in rows] == list(range(FRAMES))
    assert [row.reason for row in rows if not row.found] == [UNDECODED]


@pytest.mark.usefixtures("no_path_picture")
def test_print_writes_json_alone_to_stdout(matchset: Matchset, flown: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("locate", flown, *BALL, "--pick", BLUE, "--print", "-o", "out") == 0
    captured = capsys.readouterr()
    lines = [json.loads(line) for line in captured.out.splitlines()]
    assert [line["frame"] for line in lines] == list(range(FRAMES))
    assert [line["z"] for line in lines] == [(row.values or {})["z"] for row in read_poses("out/poses.csv")]
    assert all(line["side"] is None for line in lines)
    assert "poses.png" in captured.err


class FakeCamera:
    """A camera that shows a flight and is pulled out at its end."""

    live, fps, length, broken, warnings, dropped, pixel_aspect = True, 30.0, None, 0, (), 0, 1.0
    width, height = SIZE

    def __init__(self, _source: str, **_: object) -> None:
        self.frames = iter(flight())

    def __iter__(self) -> Iterator[Frame]:
        return self

    def until(self, stopped: Callable[[], bool]) -> Iterator[Frame]:
        return itertools.takewhile(lambda _: not stopped(), self)

    def __next__(self) -> Frame:
        frame = next(self.frames, None)
        if frame is None:
            raise LinkError("camera 0 went away")
        return Frame(frame.image, time.monotonic(), frame.index)

    def __enter__(self) -> "FakeCamera":
        return self

    def __exit__(self, *error: Any) -> None: ...


@pytest.mark.usefixtures("no_path_picture")
@pytest.mark.parametrize(("at", "begin"), [("@0", 0), ("@2", 2)])
def test_a_camera_that_goes_away_leaves_whole_files(
    matchset: Matchset,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    at: str,
    begin: int,
) -> None:
    """The marker may be clicked in a later frame than the ball; no frame is told twice."""
    monkeypatch.setattr("matchset.media.video.Video", FakeCamera)
    options = "--pick", BLUE, "--marker-pick", PURPLE + at, "--print", "-o", "out", "--video", "out.webm"
    assert matchset("locate", "0", *BALL, *options) == 3
    captured = capsys.readouterr()
    lines = [json.loads(line) for line in captured.out.splitlines()]
    assert [line["frame"] for line in lines] == [0, *range(max(begin, 1), FRAMES)]
    assert all(line["found"] and line["observed"] == "level" and "age_ms" in line for line in lines)
    assert "error: camera 0 went away" in captured.err
    assert len(read_poses("out/poses.csv")) == frames_of(Path("out.webm")) == len(lines)
    assert Path("out/poses.png").exists()


def test_a_video_that_cannot_be_written_is_one_line(
    matchset: Matchset, flown: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(flown, "out.webm")
    assert matchset("locate", flown, *BALL, "--pick", BLUE, "--video", "out.webm") == 2
    assert one_error(capsys).startswith("out.webm exists")
