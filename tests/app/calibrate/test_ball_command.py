"""`matchset calibrate` with a ball, in rendered pictures: the exact cone of a sphere."""

import math
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from blue_ball import Matchset
from matchset.app.calibrate import ball_command
from matchset.app.calibrate.ball_command import parse_distances
from matchset.app.calibrate.still_ball import still_intervals
from matchset.tracking.track import Track

CAMERA = ms.CameraModel(width=320, height=240, fx=260.0, fy=260.0, cx=159.5, cy=119.5)
RADIUS = 0.14
TAPED = 0.4, 0.8, 1.2  # to the nearest point
HSV = "--hsv", "100,80,60:130,255,255"


def ball(distance: float, aside: float = 0.0, seed: int = 0) -> npt.NDArray[np.uint8]:
    """A blue ball whose center is `distance` away, and by `aside` rad to the right."""
    x, y = np.meshgrid(np.arange(320.0), np.arange(240.0))
    rays = CAMERA.rays(np.column_stack((x.ravel(), y.ravel()))).reshape(240, 320, 3)
    axis = np.array([math.sin(aside), 0.02, math.cos(aside)])
    angle = np.arccos(np.clip(rays @ (axis / np.linalg.norm(axis)), -1.0, 1.0))
    cover = np.clip((math.asin(RADIUS / distance) - angle) * CAMERA.fx + 0.5, 0.0, 1.0)[..., None]
    image = 150.0 + cover * (np.array((190.0, 70.0, 30.0)) - 150.0)
    noise = np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return np.asarray(np.clip(cv2.GaussianBlur(image, (0, 0), 0.8) + noise, 0.0, 255.0), np.uint8)


def write(path: Path, places: list[tuple[float, float]]) -> Path:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (320, 240))
    for seed, place in enumerate(places):
        writer.write(ball(*place, seed=seed))
    writer.release()
    return path


@pytest.fixture(scope="module")
def one_video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Held for 25 frames at each distance, moved between."""
    places: list[tuple[float, float]] = []
    for near, far in zip(TAPED, (*TAPED[1:], None), strict=True):
        places += [(near + RADIUS, 0.002 * math.sin(i)) for i in range(25)]
        if far is not None:
            places += [(near + RADIUS + (far - near) * i / 25.0, 0.1 * math.sin(i / 4.0)) for i in range(1, 25)]
    return write(tmp_path_factory.mktemp("ball") / "ball.avi", places)


def focal_ratio(path: str) -> float:
    """Error of the focal length over its standard deviation."""
    camera = ms.CameraModel.load(path)
    assert camera.covariance is not None
    assert camera.fx == pytest.approx(260.0, rel=0.03)
    return abs(camera.fx - 260.0) / math.sqrt(camera.covariance[0, 0])


def test_one_video_with_three_still_moments(
    matchset: Matchset, one_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = "--ball-diameter", "0.28", "--at", "0.4,0.8,1.2", *HSV
    assert matchset("calibrate", one_video, *words, "-o", "camera.toml") == 0
    assert focal_ratio("camera.toml") < 2.0
    said = capsys.readouterr().out
    assert "focal length" in said
    assert "at 1.20 m the ball looks" in said
    assert matchset("calibrate", one_video, *words[:3], "1.2,0.8,0.4", *HSV, "-o", "b.toml") == 1
    assert "are these in the same order?" in capsys.readouterr().err
    assert matchset("calibrate", one_video, *words[:3], "0.4,0.6,0.8,1.2", *HSV, "-o", "b.toml") == 1
    assert "held still at 3 distances, 4 were given" in capsys.readouterr().err
    assert matchset("calibrate", one_video, *words[:3], "0.3,0.8,2.4", *HSV, "-o", "b.toml") == 1
    assert "do not fit the ball" in capsys.readouterr().err
    assert not Path("b.toml").exists()


def test_a_picture_for_each_distance(matchset: Matchset) -> None:
    names = []
    for index, taped in enumerate(TAPED):
        names.append(f"{index}.png")
        cv2.imwrite(names[-1], ball(taped + RADIUS, 0.05 * index, seed=index))
    words = "--ball-diameter", "0.28", "--at", "0.4,0.8,1.2"
    assert matchset("calibrate", *names, *words, "--pick", "160,120", "-o", "camera.toml") == 0
    assert focal_ratio("camera.toml") < 2.5
    Path("all").mkdir()
    for name in names:
        Path(name).rename(Path("all") / name)
    assert matchset("calibrate", "all", *words, *HSV, "-o", "other.toml") == 0
    assert focal_ratio("other.toml") < 2.5


class FakeCamera(ms.Video):
    """A camera before which someone holds a ball."""

    def __init__(self, source: str, **_: object) -> None:
        super().__init__(Path(source))
        self.live, self.length = True, None


def test_before_a_camera(matchset: Matchset, one_video: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It ends by itself once the ball was held at the last distance."""
    monkeypatch.setattr(ball_command, "Video", FakeCamera)
    words = "--ball-diameter", "0.28", "--at", "0.4,0.8", *HSV
    assert matchset("calibrate", one_video, *words, "-o", "camera.toml") == 0
    assert focal_ratio("camera.toml") < 2.0


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("--at", "0.4,0.8"), 2, "give --board 9x6"),
        (("--ball-diameter", "0.28"), 2, "needs --at"),
        (("--ball-diameter", "0", "--at", "0.4,0.8", *HSV), 2, "--ball-diameter must be positive"),
        (("--ball-diameter", "0.28", "--at", "0.4,-0.8", *HSV), 2, "--at is a list of distances"),
        (("--ball-diameter", "0.28", "--at", "0.4;0.8", *HSV), 2, "--at is a list of distances"),
        (("--ball-diameter", "0.28", "--at", "0.4,0.8"), 2, "say what to follow"),
        (("wall.png", "--ball-diameter", "0.28", "--at", "0.4,0.8,1.2", *HSV), 2, "or one for each; got 2"),
        (("--ball-diameter", "0.28", "--at", "0.4,0.8", *HSV, "-o", "camera.yaml"), 2, "must end in .toml"),
        (("--ball-diameter", "0.28", "--at", "0.4,0.8", *HSV), 1, "held still at 0 distances, 2 were given"),
        (("wall.png", "--ball-diameter", "0.28", "--at", "0.4,0.8", *HSV), 1, "the ball was not found at 0.4 m"),
    ],
)
def test_misuse_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], code: int, said: str
) -> None:
    cv2.imwrite("wall.png", np.full((240, 320, 3), 150, np.uint8))
    assert matchset("calibrate", "wall.png", *words) == code
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert said in line


def track(x: float, radius: float) -> Track[ms.Circle]:
    return Track(ms.Circle(x, 100.0, radius), np.eye(3), 1.0, np.zeros((3, 2)), 0.0)


def test_still_moments() -> None:
    still = [(i, track(100.0, 40.0 + 0.2 * (i % 2))) for i in range(20)]
    moving = [(20 + i, track(100.0 + 9.0 * i, 40.0 - i)) for i in range(15)]
    again = [(35 + i, track(230.0, 25.0)) for i in range(30)]
    first, second = still_intervals(still + moving + again)
    assert (first.first, second.last) == (0, 64)
    assert first.radius == pytest.approx(40.1, abs=0.2)
    assert second.radius == 25.0
    assert len(second.outlines) == pytest.approx(30, abs=2)
    assert still_intervals(still[:10]) == []
    (one,) = still_intervals([*still, *[(40 + i, track(180.0, 40.5)) for i in range(20)]])
    assert len(one.outlines) == 40


def test_distances() -> None:
    assert parse_distances("0.5, 1,1.5") == [0.5, 1.0, 1.5]
    for text in ("", "a", "0.5,,1", "0", "nan", "inf"):
        with pytest.raises(ValueError, match="--at is"):
            parse_distances(text)
