"""The commands on a bag: `--topic`, times in the table, one line for what cannot be read."""

import shlex
from pathlib import Path

import pytest

import bags
from blue_ball import CENTERS, RADIUS, Matchset, ball_picture
from matchset.app.track.rows import read_tracks

START = 1_700_000_000 * bags.NANO
STEP = 33_333_333


def flight(folder: Path, topics: tuple[str, ...] = ("/cam/image_raw",), count: int = len(CENTERS)) -> Path:
    bags.need_rosbags()
    types = bags.store(ros1=True)
    messages = []
    for k, center in enumerate(CENTERS[:count]):
        pixels = ball_picture(center)
        height, width = pixels.shape[:2]
        message = bags.image(types, START + k * STEP, pixels, "bgr8", (height, width))
        messages += [(topic, START + k * STEP, message) for topic in topics]
    return bags.write_bag(folder, "ros1", messages)


def test_a_bag_is_tracked_like_a_video(matchset: Matchset, tmp_path: Path) -> None:
    path = flight(tmp_path)
    assert matchset("track", path, "--pick", "50,60", "--video", "out.webm") == 0
    rows = read_tracks("runs/0001-track/tracks.csv")
    assert [row.time for row in rows] == pytest.approx(
        [1.7e9 + k * STEP / bags.NANO for k in range(len(rows))], abs=1e-5
    )
    for row, (x, y) in zip(rows, CENTERS, strict=True):
        assert row.shape is not None
        assert [row.shape[name] for name in ("x", "y", "radius")] == pytest.approx([x, y, RADIUS], abs=1.0)


def test_a_topic_is_chosen_and_kept_in_the_next_command(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = flight(tmp_path, ("/left/image_raw", "/right/image_raw"), 12)
    assert matchset("track", path, "--pick", "50,60") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert "/left/image_raw (sensor_msgs/Image, 12), /right/image_raw (sensor_msgs/Image, 12)" in line
    assert matchset("track", path, "--topic", "/up", "--pick", "50,60") == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    words = path, "--topic", "/right/image_raw"
    assert matchset("track", *words) == 2
    assert "--topic /right/image_raw' shows where the ball is" in capsys.readouterr().err
    assert matchset("learn", *words, "--frame", "0") == 0
    printed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  matchset track")]
    assert matchset(*shlex.split(printed[0])[1:]) == 0
    assert matchset("learn", *words, "--pick", "50,60", "-o", "ball.npz") == 0
    assert "--topic /right/image_raw --color ball.npz" in capsys.readouterr().out
    assert matchset("locate", *words, "--pick", "50,60", "--fov", "60", "--diameter", "0.28", "-o", "poses") == 0
    assert len(Path("poses/poses.csv").read_text().splitlines()) == 13


@pytest.mark.parametrize("command", ["track", "learn"])
def test_a_damaged_bag_is_one_line(
    command: str, matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = flight(tmp_path, count=3)
    path.write_bytes(path.read_bytes()[:-200])
    assert matchset(command, path, *(("--pick", "50,60") if command == "track" else ())) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: {path} cannot be read as a bag: ")
