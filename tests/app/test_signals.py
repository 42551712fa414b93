import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from matchset.app.locate.rows import read_poses
from matchset.app.track.rows import read_tracks

FRAMES = 1500
SIZE = 96, 72


@pytest.fixture(scope="module")
def long_video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("long") / "long.mp4"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, SIZE)
    image = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
    cv2.circle(image, (40, 36), 20, (190, 70, 30), cv2.FILLED, cv2.LINE_AA)
    for _ in range(FRAMES):
        writer.write(image)
    writer.release()
    return path


@pytest.fixture
def tracking(long_video: Path, tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A run that cannot end before its output is read: a pipe holds a few hundred of its 1500 lines."""
    words = ["track", str(long_video), "--pick", "40,36", "--print", "-o", "out", "--video", "out.webm"]
    process = subprocess.Popen(
        [sys.executable, "-m", "matchset.cli", *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    yield process
    process.kill()
    process.communicate()


def test_a_signal_leaves_whole_files(tracking: subprocess.Popen[str], tmp_path: Path) -> None:
    assert tracking.stdout is not None
    assert tracking.stderr is not None
    lines = [tracking.stdout.readline() for _ in range(5)]
    tracking.send_signal(signal.SIGTERM)
    lines += tracking.stdout.read().splitlines()  # communicate() would lose what readline() has read ahead
    err = tracking.stderr.read()
    assert tracking.wait(timeout=60) == 143, err
    assert "Traceback" not in err
    rows = read_tracks(tmp_path / "out" / "tracks.csv")
    assert 5 <= len(rows) == len(lines) < FRAMES
    video = cv2.VideoCapture(str(tmp_path / "out.webm"))
    assert next(count for count in range(FRAMES) if not video.grab()) == len(rows)


def test_a_signal_leaves_whole_files_of_poses_and_their_picture(long_video: Path, tmp_path: Path) -> None:
    words = ["locate", str(long_video), "--fov", "60", "--diameter", "0.28", "--pick", "40,36", "--print", "-o", "out"]
    process = subprocess.Popen(
        [sys.executable, "-m", "matchset.cli", *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    lines = [process.stdout.readline() for _ in range(5)]
    process.send_signal(signal.SIGINT)
    lines += process.stdout.read().splitlines()
    err = process.stderr.read()
    assert process.wait(timeout=60) == 130, err
    assert "Traceback" not in err
    process.stdout.close()
    process.stderr.close()
    assert 5 <= len(read_poses(tmp_path / "out" / "poses.csv")) == len(lines) < FRAMES
    picture = cv2.imread(str(tmp_path / "out" / "poses.png"))
    assert picture is not None


def test_a_reader_that_leaves_ends_the_run_quietly(tracking: subprocess.Popen[str], tmp_path: Path) -> None:
    assert tracking.stdout is not None
    assert tracking.stdout.readline().startswith('{"frame":0')
    tracking.stdout.close()
    assert tracking.stderr is not None
    err = tracking.stderr.read()
    assert tracking.wait(timeout=60) == 0
    assert "Traceback" not in err
    assert "BrokenPipe" not in err
    rows = read_tracks(tmp_path / "out" / "tracks.csv")
    assert 0 < len(rows) < FRAMES
    assert (tmp_path / "out.webm").stat().st_size > 0


def test_head_of_a_short_output_is_quiet(long_video: Path, tmp_path: Path) -> None:
    command = f"{sys.executable} -m matchset.cli learn '{long_video}' | true"
    done = subprocess.run(["bash", "-o", "pipefail", "-c", command], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
