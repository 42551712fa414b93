"""`matchset locate` with several balls: poses by identity, and what is refused."""

import csv
import math
from pathlib import Path

import cv2
import numpy as np
import pytest

import matchset as ms
from blue_ball import Matchset
from matchset.app.locate.rows import read_poses
from matchset.app.several.painter import color_of
from matchset.sim.clips.multi_ball_clip import MultiBallClip, PositionFunction
from matchset.sim.clips.truth import sphere_outline
from several_balls import FRAMES, RADIUS, SIZE, picture, places, write_pictures

LENS = "--fov", "60", "--diameter", "0.3"
FOCAL = 0.5 * SIZE[0] / math.tan(math.radians(30.0))


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("several") / "balls")


def test_each_ball_has_poses_under_its_identity(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("locate", balls, *LENS, "--pick", "60,60", "--pick", "160,190", "--jsonl", "-o", "out") == 0
    with Path("out/poses.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[-3:] == ["identity", "label", "alternatives"]
    assert {(row["identity"], row["label"]) for row in rows} == {("0", "1"), ("1", "2")}
    for identity, ball in ((0, 0), (1, 2)):
        poses = read_poses("out/poses.csv", identity)
        assert len(poses) >= FRAMES - 2
        for pose in poses:
            x, _ = places(pose.frame)[ball]
            assert pose.values is not None
            assert pose.values["z"] == pytest.approx(0.15 * FOCAL / RADIUS, rel=0.07)
            assert pose.values["x"] / pose.values["z"] == pytest.approx((x - SIZE[0] / 2) / FOCAL, abs=0.03)
    with pytest.raises(ValueError, match=r"holds several targets \(0, 1\)"):
        read_poses("out/poses.csv")
    for name in ("summary.png", "poses.png"):
        assert Path("out", name).exists()
    assert "2 targets in 24 frames" in capsys.readouterr().out


def test_a_named_color_locates_all_of_it(matchset: Matchset, balls: Path) -> None:
    ms.ColorModel.pick(picture(0), 60, 60).save("blue.npz")
    assert matchset("locate", balls, *LENS, "--color", "sea=blue.npz", "--print", "-o", "out") == 0
    assert len(read_poses("out/poses.csv", 0)) > FRAMES / 2 < len(read_poses("out/poses.csv", 1))


def test_one_ball_is_located_as_ever(matchset: Matchset, balls: Path) -> None:
    assert matchset("locate", balls, *LENS, "--pick", "60,60", "--no-video", "-o", "out") == 0
    assert Path("out/poses.csv").read_text().splitlines()[0].endswith(",observed,reason")
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(picture(0), 60, 60), start=(60, 60))
    localizer = ms.Localizer(ms.CameraModel.from_fov(*SIZE, math.radians(60.0)), ms.BallTarget(0.3))
    for frame, row in zip(ms.Video(str(balls)), read_poses("out/poses.csv"), strict=True):
        pose = localizer.update(tracker.update(frame))
        assert isinstance(pose, ms.Pose)
        assert row.values is not None
        assert np.array([row.values[name] for name in "xyz"]) == pytest.approx(pose.position, abs=1e-6)


def test_the_paths_have_the_colors_of_their_identities(matchset: Matchset, balls: Path) -> None:
    command = "locate", balls, *LENS, "--pick", "60,60", "--pick", "160,190", "--no-video"
    assert matchset(*command, "-o", "out") == 0
    paths = cv2.imread("out/poses.png")
    assert paths is not None
    for identity in (0, 1):
        assert (np.abs(paths.astype(int) - color_of(identity)).max(axis=2) < 8).sum() > 100
    assert (np.abs(paths.astype(int) - color_of(2)).max(axis=2) < 8).sum() == 0


def test_smooth_locates_each_ball_in_every_frame(matchset: Matchset, balls: Path) -> None:
    command = "locate", balls, *LENS, "--pick", "60,60", "--all", "--no-video", "--smooth"
    assert matchset(*command, "-o", "out") == 0
    for identity in (0, 1):
        assert [pose.frame for pose in read_poses("out/poses.csv", identity) if pose.values] == list(range(FRAMES))


def test_each_ball_has_its_own_marker(matchset: Matchset) -> None:
    """Two balloons at different places; the marker of each faces the camera."""
    camera = ms.CameraModel.from_fov(640, 480, math.radians(60.0))
    wide = MultiBallClip(camera=camera, paths=[path_of(-0.35), path_of(0.35)], frames=12, preset="clean")
    writer = cv2.VideoWriter("marked.avi", cv2.VideoWriter.fourcc(*"FFV1"), 30.0, (640, 480))
    for frame in wide:
        writer.write(frame.image)
    writer.release()
    left, right = (sphere_outline(camera, np.array(path_of(x)(0.0)), 0.14).circle() for x in (-0.35, 0.35))
    clicks = [f"{each.x:.0f},{each.y + 0.6 * each.radius:.0f}" for each in (left, right)]
    marker = f"{left.x:.0f},{left.y:.0f}"
    command = "locate", "marked.avi", "--fov", "60", "--diameter", "0.28", "--marker-pick", marker, "--no-video"
    assert matchset(*command, "--pick", clicks[0], "--pick", clicks[1], "-o", "out") == 0
    for identity, x in ((0, -0.35), (1, 0.35)):
        poses = read_poses("out/poses.csv", identity)
        assert len(poses) == 12
        turned = [pose.values for pose in poses if pose.values is not None and "yaw" in pose.values]
        assert len(turned) > 8
        for values in turned:
            assert values["x"] == pytest.approx(x, abs=0.03)
            seen_from = [values[name] for name in ("side", "height", "heading")]  # straight before each marker, m
            assert seen_from == pytest.approx([0.0, 0.0, math.hypot(0.35, 0.02, 1.6)], abs=0.1)


def path_of(x: float) -> PositionFunction:
    return lambda _: (x, 0.02, 1.6)


def test_where_nothing_is_found_a_picture_says_why(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = "locate", balls, *LENS, "--hsv", "50,200,200:60,255,255", "--all", "--no-video"
    assert matchset(*command, "-o", "out") == 1
    assert "nothing in frame 0 has this color" in capsys.readouterr().out
    assert Path("out/why.png").exists()
    assert not Path("out/poses.png").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((*LENS, "--most", "2"), "--most is of several targets"),
        ((*LENS, "--all", "--marker-diameter", "0.06"), "--marker-diameter needs the markers' color"),
        ((*LENS, "--all", "--mavlink", "mavlink:udpout:127.0.0.1:14550"), "--mavlink is of one ball"),
        (("--fov", "60", "--all"), "say how large the ball is"),
        (("--diameter", "0.3", "--all"), "say what the camera is like"),
    ],
)
def test_misuse_is_one_line(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], words: str
) -> None:
    assert matchset("locate", balls, "--pick", "60,60", *options) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert words in line
    assert list(Path().iterdir()) == []
