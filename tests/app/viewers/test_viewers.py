"""What `--mcap` and `--rerun` write is read back by the packages of Foxglove and Rerun."""

import csv
import json
import os
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

from matchset.app.locate.rows import read_poses
from matchset.app.several.painter import PALETTE
from matchset.app.viewers.foxglove_file import FoxgloveFile
from matchset.app.viewers.viewed_frame import CORNER, ViewedFrame
from several_balls import FRAMES, SIZE, picture, write_pictures

ROOT = Path(__file__).resolve().parents[3]
VIEWERS = ROOT / ".viewers"
HERE = Path(__file__).parent

pytestmark = pytest.mark.skipif(
    not (VIEWERS / "ready").exists(), reason="the packages of Foxglove and Rerun are missing: run make viewers"
)

LENS = "--fov", "60", "--diameter", "0.3"
PICKS = "--pick", "60,60", "--pick", "160,190"


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("read") / "balls")


def command(*words: object) -> list[str]:
    (packages,) = VIEWERS.glob("lib/python*/site-packages")
    return [sys.executable, str(HERE / "with_rerun.py"), str(packages), *map(str, words)]


def run(folder: Path, *words: object) -> None:
    done = subprocess.run(command(*words), cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr[-3000:]


def asked(program: str, path: Path) -> dict[str, Any]:
    """What a program of the other environment prints of a file."""
    words = [str(VIEWERS / "bin" / "python"), str(HERE / program), str(path)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def write_long_video(path: Path, frames: int) -> None:
    """A ball at rest in noise, so that no two pictures are packed alike."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, SIZE)
    image, rng = picture(0).astype(np.int16), np.random.default_rng(0)
    for _ in range(frames):
        writer.write((image + rng.integers(-4, 5, image.shape, np.int16)).clip(0, 255).astype(np.uint8))
    writer.release()


def rerun_command(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(VIEWERS / "bin" / "rerun"), *map(str, words)], capture_output=True, text=True, timeout=120, check=False
    )


def printed_pictures(path: Path) -> int:
    """How many pictures Rerun's program finds in a file, also in one that ends in the middle of a message."""
    rows = re.findall(r"with (\d+) rows .* - /camera/image - ", rerun_command("rrd", "print", path).stdout)
    return sum(map(int, rows))


def test_foxglove_encodes_the_same_bytes_under_the_same_schemas(balls: Path, tmp_path: Path) -> None:
    run(tmp_path, "locate", balls, *LENS, *PICKS, "--no-video", "-o", "out", "--mcap", "a.mcap")
    seen = asked("peer_foxglove.py", tmp_path / "a.mcap")
    assert seen["schemas equal"]
    assert seen["messages"] == seen["bytes equal"] == seen["indexed"] == 6 * FRAMES
    for identity in (0, 1):
        rows = read_poses(tmp_path / "out" / "poses.csv", identity)
        for row, (stamp, place) in zip(rows, seen["topics"][f"/targets/{identity}/pose"], strict=True):
            assert row.values is not None
            assert 1e-9 * stamp == pytest.approx(row.time, abs=1e-6)
            assert place == pytest.approx([row.values[name] for name in "xyz"], abs=1e-6)
    assert {tuple(name for name, _ in each) for _, each in seen["topics"]["/targets/scene"]} == {("0", "1")}
    assert {each[0][1] for _, each in seen["topics"]["/targets/scene"]} == {0.3}
    assert all(image == ["jpeg", "ffd8"] for _, image in seen["topics"]["/camera/image"])
    assert {count for _, each in seen["topics"]["/camera/outlines"] for _, count in each} == {64}


def test_rerun_opens_the_file_for_foxglove_too(balls: Path, tmp_path: Path) -> None:
    run(tmp_path, "locate", balls, *LENS, *PICKS, "--no-video", "-o", "out", "--mcap", "a.mcap")
    checked = rerun_command("mcap", "check", tmp_path / "a.mcap")
    assert checked.returncode == 0, checked.stderr
    done = rerun_command("mcap", "convert", tmp_path / "a.mcap", "-o", tmp_path / "a.rrd")
    assert done.returncode == 0, done.stderr[-2000:]
    entities = asked("peer_rerun.py", tmp_path / "a.rrd")["entities"]
    assert len(entities["/camera/image"]["columns"]["EncodedImage:blob"]) == FRAMES
    assert "Pinhole:image_from_camera" in entities["/camera/calibration"]["columns"]
    assert "InstancePoses3D:translations" in entities["/targets/0/pose"]["columns"]


def test_rerun_reads_pictures_outlines_poses_and_numbers(balls: Path, tmp_path: Path) -> None:
    (tmp_path / "a.rrd").write_bytes(b"mine")
    run(tmp_path, "locate", balls, *LENS, *PICKS, "--no-video", "-o", "out", "--rerun", "a.rrd", "--force")
    assert [each.name for each in tmp_path.glob("*.rrd")] == ["a.rrd"]
    verified = rerun_command("rrd", "verify", tmp_path / "a.rrd")
    assert verified.returncode == 0, verified.stdout + verified.stderr
    seen = asked("peer_rerun.py", tmp_path / "a.rrd")
    assert (seen["recordings"], seen["blueprints"]) == (1, 1)
    entities = seen["entities"]
    image = entities["/camera/image"]
    assert image["timelines"] == ["capture_time", "frame"]
    assert image["columns"]["frame"] == list(range(FRAMES))
    assert image["columns"]["EncodedImage:blob"] == ["ffd8"] * FRAMES
    (k,) = entities["/camera"]["columns"]["Pinhole:image_from_camera"]
    assert k[0][6:8] == [SIZE[0] / 2, SIZE[1] / 2]
    (classes,) = entities["/"]["columns"]["AnnotationContext:context"]
    assert len(classes[0]) == len(PALETTE)
    for identity in (0, 1):
        rows = read_poses(tmp_path / "out" / "poses.csv", identity)
        ball = entities[f"/targets/{identity}"]["columns"]
        assert ball["Ellipsoids3D:half_sizes"][0][0] == pytest.approx([0.15] * 3)
        for row, place, time in zip(rows, ball["Transform3D:translation"], ball["capture_time"], strict=True):
            assert row.values is not None
            assert 1e-9 * time == pytest.approx(row.time, abs=1e-6)
            assert place[0] == pytest.approx([row.values[name] for name in "xyz"], abs=1e-5)
        numbers = entities[f"/measured/z/{identity}"]["columns"]["Scalars:scalars"]
        for row, numbered in zip(rows, numbers, strict=True):
            assert row.values is not None
            assert row.std is not None
            z, sigma = row.values["z"], row.std["z"]
            assert numbered == pytest.approx([z, z - sigma, z + sigma], abs=3e-6)
        lines = entities[f"/camera/outlines/{identity}"]["columns"]
        assert {tuple(each) for each in lines["LineStrips2D:class_ids"]} == {(identity,)}


def test_rerun_reads_what_was_tracked_without_a_camera(balls: Path, tmp_path: Path) -> None:
    run(tmp_path, "track", balls, "--pick", "60,60", "--no-video", "-o", "out", "--rerun", "a.rrd")
    entities = asked("peer_rerun.py", tmp_path / "a.rrd")["entities"]
    assert not {"/camera", "/targets/0"} & entities.keys()
    with (tmp_path / "out" / "tracks.csv").open() as file:
        rows = list(csv.DictReader(file))
    radii = [each[0] for each in entities["/measured/radius/0"]["columns"]["Scalars:scalars"]]
    assert radii == pytest.approx([float(row["radius"]) for row in rows], abs=1e-4)
    for row, strips in zip(rows, entities["/camera/outlines/0"]["columns"]["LineStrips2D:strips"], strict=True):
        away = np.array(strips[0]) - CORNER - (float(row["x"]), float(row["y"]))
        assert np.hypot(*away.T) == pytest.approx(float(row["radius"]), abs=2e-3)


def test_times_of_a_bag_are_dates(tmp_path: Path) -> None:
    begin = 1_790_000_000.25
    with FoxgloveFile(tmp_path / "bag.mcap") as file:
        for k in range(5):
            coded = cv2.imencode(".jpg", picture(k))[1].tobytes()
            file.write(ViewedFrame(k, begin + k / 30.0, coded, ()))
    run(tmp_path, "track", "bag.mcap", "--pick", "60,60", "--no-video", "-o", "out", "--rerun", "a.rrd")
    image = asked("peer_rerun.py", tmp_path / "a.rrd")["entities"]["/camera/image"]
    assert image["columns"]["capture_time"] == pytest.approx([1e9 * (begin + k / 30.0) for k in range(5)], abs=2000)
    assert image["kinds"]["capture_time"].startswith("timestamp")


def test_what_rerun_could_not_write_is_said(tmp_path: Path) -> None:
    def short_of_room() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1_600_000, resource.RLIM_INFINITY))

    write_long_video(tmp_path / "long.avi", 500)
    words = command("track", "long.avi", "--pick", "60,60", "--no-video", "-o", "out", "--rerun", "a.rrd")
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, preexec_fn=short_of_room, check=False)
    assert done.returncode == 2, done.stderr
    told = re.fullmatch(
        r"error: a\.rrd: File too large; it holds at most (\d+) of 500 frames", done.stderr.splitlines()[-1]
    )
    assert told is not None, done.stderr
    with (tmp_path / "out" / "tracks.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 500
    assert 0 < printed_pictures(tmp_path / "a.rrd") <= int(told[1])


def test_where_a_ball_is_lost_its_curve_has_a_gap(tmp_path: Path) -> None:
    frames = write_pictures(tmp_path / "frames")
    for k in range(10, 15):
        image = picture(k)
        image[:] = image[0, 0]
        cv2.imwrite(str(frames / f"{k:04d}.png"), image)
    run(tmp_path, "track", frames, "--pick", "60,60", "--no-video", "-o", "out", "--rerun", "a.rrd")
    with (tmp_path / "out" / "tracks.csv").open() as file:
        found = [row["found"] == "1" for row in csv.DictReader(file)]
    assert not all(found)
    entities = asked("peer_rerun.py", tmp_path / "a.rrd")["entities"]
    curve = entities["/measured/x/0"]
    assert curve["cleared"] == [k for k in range(1, FRAMES) if found[k - 1] and not found[k]]
    assert curve["columns"]["frame"] == [k for k in range(FRAMES) if found[k]]
    assert len(entities["/camera/image"]["columns"]["frame"]) == FRAMES


@pytest.mark.parametrize(("signalled", "code"), [(signal.SIGINT, 130), (signal.SIGKILL, -9)])
def test_a_run_that_is_stopped_leaves_what_rerun_reads(tmp_path: Path, signalled: signal.Signals, code: int) -> None:
    write_long_video(tmp_path / "long.avi", 1000)
    words = command("track", "long.avi", "--pick", "60,60", "--print", "-o", "out", "--rerun", "a.rrd")
    process = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stderr is not None
    with process.stdout as out, process.stderr as err:
        lines = [out.readline() for _ in range(400)]
        os.kill(process.pid, signalled)
        lines += out.read().splitlines()
        assert process.wait(timeout=60) == code, err.read()
    pictures = printed_pictures(tmp_path / "a.rrd")
    if signalled == signal.SIGINT:
        assert pictures == len(lines) < 1000
        assert rerun_command("rrd", "verify", tmp_path / "a.rrd").returncode == 0
    else:
        assert 0 < pictures < 1000
