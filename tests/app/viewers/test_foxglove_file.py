"""What `track` and `locate` write for Foxglove: pictures, outlines, poses and camera, at the times of the frames."""

import csv
import hashlib
import math
import re
import resource
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import matchset as ms
from blue_ball import Matchset
from foxglove_messages import Read, read_foxglove_file
from marked_balloon import BLUE, FOV_DEG, PURPLE, flight, write_video
from matchset.app.disk import SpaceParameters, UnfinishedFileError
from matchset.app.several.painter import color_of
from matchset.app.track.loop import TrackedFrame
from matchset.app.track.rows import track_row
from matchset.app.viewers.foxglove_file import ALL, LINE_LIST, LINE_LOOP, FoxgloveFile
from matchset.app.viewers.options import ViewerOptions
from matchset.app.viewers.run import ViewerParameters, viewed
from matchset.app.viewers.viewed_frame import CORNER, ViewedFrame, ViewedTarget, viewed_frame
from matchset.flight.recording.mcap_file import McapReader
from several_balls import FRAMES, RADIUS, SIZE, picture, places, write_pictures

LENS = "--fov", "60", "--diameter", "0.3"
SOURCE = "balls", False


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("viewed") / "balls")


def of(topic: str, read: list[Read]) -> list[Read]:
    return [each for each in read if each.topic == topic]


def points_of(line: dict[str, Any]) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([(each["x"], each["y"]) for each in line["points"]])


def rows_of(path: str) -> list[dict[str, str]]:
    with Path(path).open() as file:
        return list(csv.DictReader(file))


def test_the_pictures_are_those_of_the_video_at_their_times(matchset: Matchset, balls: Path) -> None:
    assert matchset("track", balls, "--pick", "60,60", "--no-video", "-o", "out", "--mcap", "out.mcap") == 0
    images = of("/camera/image", read_foxglove_file(Path("out.mcap")))
    assert [each.number for each in images] == list(range(FRAMES))
    assert {(each.message["format"], each.message["frame_id"]) for each in images} == {("jpeg", "camera")}
    for row, each in zip(rows_of("out/tracks.csv"), images, strict=True):
        assert each.time == pytest.approx(1e9 * float(row["time"]), abs=1000)
        stamp = each.message["timestamp"]
        assert 10**9 * stamp["seconds"] + stamp["nanos"] == each.time
    for before, after in zip(ms.Video(str(balls)), ms.Video("out.mcap", topic="/camera/image"), strict=True):
        assert after.time == pytest.approx(before.time, abs=1e-6)
        assert np.abs(before.image.astype(int) - after.image).mean() < 3.0


def test_the_outline_of_one_ball_is_that_of_the_table(matchset: Matchset, balls: Path) -> None:
    assert matchset("track", balls, "--pick", "60,60", "--no-video", "-o", "out", "--mcap", "out.mcap") == 0
    read = read_foxglove_file(Path("out.mcap"))
    assert {each.topic for each in read} == {"/camera/image", "/camera/outlines"}
    for row, each in zip(rows_of("out/tracks.csv"), of("/camera/outlines", read), strict=True):
        (line,), (text,) = each.message["points"], each.message["texts"]
        assert line["type"] == LINE_LOOP
        away = points_of(line) - CORNER - (float(row["x"]), float(row["y"]))
        assert np.hypot(*away.T) == pytest.approx(float(row["radius"]), abs=2e-3)
        assert text["text"] == "0"
        color = line["outline_color"]
        assert [round(255 * color[part]) for part in "bgr"] == list(color_of(0))


def test_several_balls_have_names_colors_poses_and_spheres(matchset: Matchset, balls: Path) -> None:
    picks = "--pick", "60,60", "--pick", "160,190"
    assert matchset("locate", balls, *LENS, *picks, "--no-video", "-o", "out", "--mcap", "out.mcap") == 0
    read, rows = read_foxglove_file(Path("out.mcap")), rows_of("out/poses.csv")
    for each in of("/camera/outlines", read):
        assert len(each.message["points"]) == 2
        words = [text["text"].split() for text in each.message["texts"]]
        assert [(name, label, unit) for name, label, _, unit in words] == [("0", "1", "m"), ("1", "2", "m")]
        colors = [[round(255 * line["outline_color"][part]) for part in "bgr"] for line in each.message["points"]]
        assert colors == [list(color_of(0)), list(color_of(1))]
    for identity in (0, 1):
        poses = of(f"/targets/{identity}/pose", read)
        own = [row for row in rows if row["identity"] == str(identity) and row["found"] == "1"]
        for row, pose in zip(own, poses, strict=True):
            assert pose.number == int(row["frame"])
            assert pose.message["frame_id"] == "camera"
            for name in "xyz":
                assert pose.message["pose"]["position"][name] == pytest.approx(float(row[name]), abs=1e-6)
            assert pose.message["pose"]["orientation"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    for each in of("/targets/scene", read):
        ((deletion,), entities) = each.message["deletions"], each.message["entities"]
        assert deletion["type"] == ALL
        assert [entity["id"] for entity in entities] == ["0", "1"]
        for entity in entities:
            (sphere,) = entity["spheres"]
            assert sphere["size"] == {"x": 0.3, "y": 0.3, "z": 0.3}
            told = {pair["key"]: pair["value"] for pair in entity["metadata"]}
            assert told["identity"] == entity["id"]
            assert re.fullmatch(r"\d\.\d+ ±0\.\d+ m", told["z"])


def test_camera_sphere_and_outline_lie_on_each_other(matchset: Matchset, balls: Path) -> None:
    """Foxglove counts pixels from the corner of the first one: outlines and camera matrix do, too."""
    assert matchset("locate", balls, *LENS, "--pick", "60,60", "--no-video", "-o", "out", "--mcap", "out.mcap") == 0
    read = read_foxglove_file(Path("out.mcap"))
    cameras = of("/camera/calibration", read)
    assert len(cameras) == FRAMES
    k = np.array(cameras[0].message["K"]).reshape(3, 3)
    assert (cameras[0].message["width"], cameras[0].message["height"]) == SIZE
    assert k[0, 0] == pytest.approx(0.5 * SIZE[0] / math.tan(math.radians(30.0)))
    assert k[:2, 2].tolist() == [SIZE[0] / 2, SIZE[1] / 2]
    assert cameras[0].message["distortion_model"] == "plumb_bob"
    assert np.array(cameras[0].message["P"]).reshape(3, 4)[:, :3] == pytest.approx(k)
    for outline in of("/camera/outlines", read):
        center = points_of(outline.message["points"][0]).mean(axis=0)
        assert center - CORNER == pytest.approx(places(outline.number)[0], abs=0.5)


def test_a_ball_before_the_camera_lies_in_its_outline(tmp_path: Path) -> None:
    camera = ms.CameraModel(width=320, height=240, fx=300.0, fy=310.0, cx=150.0, cy=110.0)
    track = ms.Track(ms.Circle(150.0, 110.0, 30.0), np.eye(3), 1.0, np.empty((0, 2)), 0.0)
    place = np.array((0.0, 0.0, 1.5))
    pose = ms.Pose(position=place, rotation_matrix=None, covariance=np.eye(6), observed="position", time=0.0)
    with FoxgloveFile(tmp_path / "a.mcap", camera, 0.3) as file:
        file.write(ViewedFrame(0, 0.0, b"jpeg", (ViewedTarget(ms.Target(0, "", track, 0.0), pose),)))
    read = read_foxglove_file(tmp_path / "a.mcap")
    k = np.array(of("/camera/calibration", read)[0].message["K"]).reshape(3, 3)
    ring = points_of(of("/camera/outlines", read)[0].message["points"][0])
    assert ring.mean(axis=0) == pytest.approx((k @ place)[:2] / place[2], abs=1e-9)


def test_a_marker_turns_the_pose(matchset: Matchset, tmp_path: Path) -> None:
    write_video(str(tmp_path / "flight.avi"), flight())
    lens = "--fov", f"{FOV_DEG}", "--diameter", "0.28", "--end", "8", "--no-video"
    assert matchset("locate", "flight.avi", *lens, "--pick", BLUE, "--marker-pick", PURPLE, "--mcap", "m.mcap") == 0
    turned = [
        each.message["pose"]["orientation"]
        for each in of("/targets/0/pose", read_foxglove_file(Path("m.mcap")))
        if each.message["pose"]["orientation"]["w"] != 1.0
    ]
    assert turned
    for each in turned:
        assert math.hypot(*each.values()) == pytest.approx(1.0)


def test_tables_are_the_same_with_and_without(matchset: Matchset, balls: Path) -> None:
    for folder, more in (("plain", ()), ("viewed", ("--mcap", "out.mcap"))):
        assert matchset("locate", balls, *LENS, "--pick", "60,60", "--jsonl", "-o", folder, *more) == 0
    for name in ("poses.csv", "poses.jsonl", "summary.png"):
        first, second = (hashlib.sha256(Path(each, name).read_bytes()).digest() for each in ("plain", "viewed"))
        assert first == second


def test_the_file_is_listed(matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for command in (("track",), ("track", "--all"), ("locate", *LENS), ("locate", *LENS, "--all")):
        name = "".join(command[0:1]) + str(len(command)) + ".mcap"
        assert matchset(command[0], balls, *command[1:], "--pick", "60,60", "--no-video", "--mcap", name) == 0
        assert f"  {name}\n" in capsys.readouterr().out
        assert Path(name).exists()


def lost(predicted: ms.Circle | None) -> ViewedFrame:
    target: ms.Target[Any] = ms.Target(4, "red", ms.Lost("hidden", 2.5, predicted), 0.0)
    return ViewedFrame(75, 2.5, b"jpeg", (ViewedTarget(target),))


def test_where_a_lost_target_should_be_is_dashed_and_what_is_nowhere_is_not_drawn(tmp_path: Path) -> None:
    camera = ms.CameraModel.from_fov(*SIZE, 1.0)
    with FoxgloveFile(tmp_path / "a.mcap", camera, 0.3) as file:
        file.write(lost(ms.Circle(100.0, 80.0, 20.0)))
        file.write(lost(None))
        file.write(ViewedFrame(77, 2.6, b"", ()))  # could not be decoded
    read = read_foxglove_file(tmp_path / "a.mcap")
    dashed, nothing = (each.message for each in of("/camera/outlines", read))
    (line,), (text,) = dashed["points"], dashed["texts"]
    assert line["type"] == LINE_LIST
    assert np.hypot(*(points_of(line) - CORNER - (100.0, 80.0)).T) == pytest.approx(20.0, abs=0.1)
    assert text["text"] == "4 red"
    assert nothing["points"] == nothing["texts"] == []
    assert all(each.message["entities"] == [] for each in of("/targets/scene", read))
    assert len(of("/camera/image", read)) == 2


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--mcap", "out.bag"), "--mcap names a file that ends in .mcap, got 'out.bag'"),
        (("--rerun", "out.mcap"), "--rerun names a file that ends in .rrd, got 'out.mcap'"),
        (("--mcap", "a.mcap", "--mot", "a.mcap"), "a.mcap and a.mcap are one file"),
    ],
)
def test_a_wrong_name_is_one_line_and_leaves_nothing(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], words: str
) -> None:
    assert matchset("track", balls, "--pick", "60,60", *options) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    ("package", "option", "advised"),
    [("mcap", "--mcap=out.mcap", "'mcap>=1.6'"), ("rerun", "--rerun=out.rrd", "'rerun-sdk>=0.41'")],
)
def test_a_missing_package_is_said_before_anything_is_read(
    matchset: Matchset,
    balls: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    package: str,
    option: str,
    advised: str,
) -> None:
    monkeypatch.setattr("matchset.app.viewers.options.find_spec", lambda name: None if name == package else name)
    for command in (("track", balls), ("locate", balls, *LENS)):
        assert matchset(*command, "--pick", "60,60", option) == 2
        assert f"needs the package {package}: pip install {advised}" in capsys.readouterr().err
    assert list(Path().iterdir()) == []


def test_what_exists_stays_unless_it_may_be_overwritten(matchset: Matchset, balls: Path) -> None:
    Path("out.mcap").write_bytes(b"mine")
    command = "track", balls, "--pick", "60,60", "--no-video", "--mcap", "out.mcap"
    assert matchset(*command) == 2
    assert Path("out.mcap").read_bytes() == b"mine"
    assert matchset(*command, "--force") == 0
    assert len(read_foxglove_file(Path("out.mcap"))) == 2 * FRAMES


def tracked(index: int) -> TrackedFrame:
    frame = ms.Frame(picture(index), index / 30.0, index)
    x, y = places(index)[0]
    answer = ms.Track(ms.Circle(x, y, RADIUS), np.eye(3), 1.0, np.empty((0, 2)), frame.time)
    return TrackedFrame(frame, answer, track_row(index, answer))


def test_what_is_written_so_far_is_there_if_the_program_is_killed(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(b"mine")
    run = viewed((tracked(k) for k in range(9)), ViewerOptions(mcap=path), ("balls", True))
    for _ in range(5):
        next(run)
    assert path.read_bytes() == b"mine"  # until the new one is finished
    beside = tmp_path / "a.part.mcap"
    reader = McapReader(beside)
    assert [each.topic for each in reader] == ["/camera/image", "/camera/outlines"] * 5
    assert reader.cut_off
    run.close()  # type: ignore[attr-defined]
    assert not beside.exists()
    assert len(read_foxglove_file(path)) == 10


@pytest.mark.parametrize("there", [True, False])
def test_it_ends_while_there_is_room_for_the_tables_and_the_run_goes_on(tmp_path: Path, there: bool) -> None:
    nothing, path = ViewerParameters(space=SpaceParameters(keep_free=1e12, keep_share=1.0)), tmp_path / "a.mcap"
    if there:
        path.write_bytes(b"mine")
    run = viewed((tracked(k) for k in range(9)), ViewerOptions(mcap=path), ("balls", True), None, nothing)
    seen: list[TrackedFrame] = []
    with pytest.raises(UnfinishedFileError, match=r"stopped, since only .* MB are free on its disk; it holds 0 of 9"):
        seen.extend(run)
    assert len(seen) == 9
    assert [each.read_bytes() for each in tmp_path.iterdir()] == ([b"mine"] if there else [])


def test_a_run_without_a_frame_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(b"mine")
    assert list(viewed(iter(list[TrackedFrame]()), ViewerOptions(mcap=path), ("balls", True))) == []
    assert path.read_bytes() == b"mine"


def test_a_file_that_cannot_be_begun_leaves_what_was_there(tmp_path: Path) -> None:
    path, before = tmp_path / "a.mcap", resource.getrlimit(resource.RLIMIT_FSIZE)
    path.write_bytes(b"mine")
    resource.setrlimit(resource.RLIMIT_FSIZE, (4, before[1]))
    try:
        with pytest.raises(OSError, match="too large"):
            FoxgloveFile(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert [each.read_bytes() for each in tmp_path.iterdir()] == [b"mine"]


def test_what_does_not_fit_ends_with_a_whole_frame(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, before[1]))
    unguarded = ViewerParameters(space=SpaceParameters(keep_free=0.0))
    path = tmp_path / "a.mcap"
    seen: list[TrackedFrame] = []
    try:
        run = viewed((tracked(k) for k in range(20)), ViewerOptions(mcap=path), SOURCE, None, unguarded)
        with pytest.raises(UnfinishedFileError, match=r"it holds (\d+) of 20 frames") as raised:
            seen.extend(run)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert len(seen) == 20
    reader = McapReader(path)
    topics = [each.topic for each in reader]
    assert f"holds {len(topics) // 2} of 20" in str(raised.value)
    assert len(topics) >= 4
    assert topics == ["/camera/image", "/camera/outlines"] * (len(topics) // 2)
    assert reader.cut_off


def test_a_signal_leaves_a_whole_file(tmp_path: Path) -> None:
    writer = cv2.VideoWriter(str(tmp_path / "long.mp4"), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, SIZE)
    image = picture(0)
    for _ in range(1500):
        writer.write(image)
    writer.release()
    words = ["track", "long.mp4", "--pick", "60,60", "--print", "-o", "out", "--mcap", "out.mcap"]
    process = subprocess.Popen(
        [sys.executable, "-m", "matchset.cli", *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    with process.stdout as out, process.stderr as err:
        lines = [out.readline() for _ in range(5)]
        process.send_signal(signal.SIGINT)
        lines += out.read().splitlines()
        assert process.wait(timeout=60) == 130, err.read()
    read = read_foxglove_file(tmp_path / "out.mcap")
    assert 5 <= len(of("/camera/image", read)) == len(lines) < 1500


def test_the_quality_of_pictures_is_checked() -> None:
    with pytest.raises(ValueError, match="quality must be"):
        ViewerParameters(quality=0)
    assert len(viewed_frame(tracked(0), 20).jpeg) < len(viewed_frame(tracked(0), 95).jpeg) / 2
