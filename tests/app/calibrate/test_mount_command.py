"""`matchset calibrate --mount` in rendered pictures: a sphere with its marker, seen by a camera that is turned."""

import math
import re
import tomllib
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from blue_ball import Matchset
from matchset.app.calibrate.mount_command import parse_place
from matchset.control.mount.camera_mount import mounting, turn_about_down
from matchset.flight.chain.config import read_flight
from matchset.localization.markers.ball_colors import pick_marker

CAMERA = ms.CameraModel(width=640, height=480, fx=400.0, fy=400.0, cx=319.5, cy=239.5)
RADIUS, MARKER = 0.14, 0.03
MOUNT = math.radians(-3.0), math.radians(5.0), math.radians(2.0)
MARKER_YAW = math.radians(10.0)
PLACES = (0.0, -0.19, 1.5), (0.6, 0.1, 1.2), (-0.5, -0.4, 1.3)  # right, down, forward
TYPED = "0,0.19,1.5", "0.6,-0.1,1.2", "-0.5,0.4,1.3"
BALL, SPOT = np.array((190.0, 70.0, 30.0)), np.array((150.0, 40.0, 170.0))


def picture(place: tuple[float, float, float], seed: int) -> npt.NDArray[np.uint8]:
    """A blue ball with a purple marker before a gray wall, two by two rays a pixel."""
    x, y = np.meshgrid((np.arange(1280.0) - 0.5) / 2.0, (np.arange(960.0) - 0.5) / 2.0)
    rays = CAMERA.rays(np.column_stack((x.ravel(), y.ravel())))
    turn = mounting(*MOUNT)
    center = turn.T @ np.array(place)
    out = turn.T @ turn_about_down(-MARKER_YAW) @ np.array((0.0, 0.0, -1.0))
    along = rays @ center
    inside = along**2 - center @ center + RADIUS**2
    surface = (along - np.sqrt(np.maximum(inside, 0.0)))[:, None] * rays - center
    spot = surface @ out > RADIUS * math.cos(math.asin(MARKER / RADIUS))
    image = np.where((inside > 0.0)[:, None], np.where(spot[:, None], SPOT, BALL), 150.0).reshape(960, 1280, 3)
    small = cv2.resize(image, (640, 480), interpolation=cv2.INTER_AREA)
    noise = np.random.default_rng(seed).normal(0.0, 2.0, small.shape)
    return np.asarray(np.clip(cv2.GaussianBlur(small, (0, 0), 0.8) + noise, 0.0, 255.0), np.uint8)


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A picture of each place, and the colors of ball and marker."""
    folder = tmp_path_factory.mktemp("mount")
    made = []
    for number, place in enumerate(PLACES):
        made.append(folder / f"place_{number}.png")
        cv2.imwrite(str(made[-1]), picture(place, number))
    sample = picture(PLACES[0], 9)
    middle = CAMERA.project((mounting(*MOUNT).T @ np.array(PLACES[0]))[None])[0]
    ms.ColorModel.pick(sample, middle[0] - 25.0, middle[1]).save(folder / "ball.npz")
    marker = mounting(*MOUNT).T @ (
        np.array(PLACES[0]) + RADIUS * turn_about_down(-MARKER_YAW) @ np.array((0.0, 0.0, -1.0))
    )
    pick_marker(sample, *CAMERA.project(marker[None])[0]).save(folder / "marker.npz")
    CAMERA.save(folder / "camera.toml")
    return made


def words(sources: list[Path], *places: str) -> list[str]:
    folder = sources[0].parent
    places = tuple(word for place in places for word in ("--place", place))
    return ["--mount", "--camera-file", str(folder / "camera.toml"), "--color", str(folder / "ball.npz"), *places]


def test_mount_and_marker_are_measured_and_flown_with(
    matchset: Matchset, sources: list[Path], capsys: pytest.CaptureFixture[str]
) -> None:
    marker = "--marker-color", str(sources[0].parent / "marker.npz")
    assert matchset("calibrate", *map(str, sources), *words(sources, *TYPED), *marker, "-o", "mount.toml") == 0
    said = capsys.readouterr().out
    assert re.search(r"place 2: 1\.3\d m away, measured 1\.35 m", said)
    assert "fly --config mount.toml" in said
    mount = read_flight(Path("mount.toml")).pilot.follower.mount
    assert (mount.yaw, mount.pitch) == pytest.approx(MOUNT[:2], abs=math.radians(0.4))
    assert mount.roll == pytest.approx(MOUNT[2], abs=math.radians(0.8))
    assert mount.marker_yaw == pytest.approx(MARKER_YAW, abs=math.radians(1.0))
    assert mount.marker_elevation == pytest.approx(0.0, abs=math.radians(1.0))
    assert mount.pitch_sigma < math.radians(1.0)


def test_a_video_is_read_until_the_ball_was_held_at_each_place(matchset: Matchset, sources: list[Path]) -> None:
    writer = cv2.VideoWriter("held.avi", cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (640, 480))
    for number, place in enumerate(PLACES[:2]):
        still = picture(place, number)
        for _ in range(22):
            writer.write(still)
    writer.release()
    assert matchset("calibrate", "held.avi", *words(sources, *TYPED[:2]), "-o", "mount.toml") == 0
    table = tomllib.loads(Path("mount.toml").read_text())["flight"]["pilot"]["follower"]["mount"]
    assert (table["yaw"], table["pitch"]) == pytest.approx(MOUNT[:2], abs=math.radians(0.6))
    assert "marker_yaw" not in table


def test_what_does_not_fit_is_said_in_one_line(
    matchset: Matchset, sources: list[Path], capsys: pytest.CaptureFixture[str]
) -> None:
    files = list(map(str, sources))
    swapped = words(sources, TYPED[1], TYPED[0], TYPED[2])
    assert matchset("calibrate", *files, *swapped, "-o", "no.toml") == 1
    assert "degrees beside it" in capsys.readouterr().err
    cv2.imwrite("empty.png", np.full((480, 640, 3), 150, np.uint8))
    assert matchset("calibrate", "empty.png", *words(sources, TYPED[0]), "-o", "no.toml") == 1
    assert "the ball was not found at place 1" in capsys.readouterr().err
    assert not Path("no.toml").exists()


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (["--place", "0,0,1"], "belong to --mount"),
        (["--mount"], "--mount needs --camera-file"),
        (["--mount", "--camera-file", "c.toml"], "--mount needs --place"),
        (["--mount", "--camera-file", "c.toml", "--place", "0,0,1"], "--mount needs --color"),
        (["--mount", "--board", "9x6"], "--mount takes neither"),
        (
            ["a", "--mount", "--camera-file", "c.toml", "--place", "0,0,1", "--color", "b.npz"],
            "each of the 1 places, got 2 sources",
        ),
        (["--mount", "--camera-file", "c.toml", "--place", "0,0,-1", "--color", "b.npz"], "ahead, m, as in 0,0.19,1.5"),
    ],
)
def test_options_that_do_not_belong_together(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], typed: list[str], said: str
) -> None:
    assert matchset("calibrate", "0", *typed) == 2
    assert said in capsys.readouterr().err


def test_a_place_is_right_up_and_ahead() -> None:
    np.testing.assert_array_equal(parse_place("0.1,0.2,1.5"), (0.1, -0.2, 1.5))
    for text in ("1,2", "a,b,c", "0,0,0", "nan,0,1"):
        with pytest.raises(ValueError, match="--place is how far"):
            parse_place(text)
