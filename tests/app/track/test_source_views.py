"""`--turn`, `--mirror`, `--stored-pixels`, `--stream`: pictures, clicks, camera files and next commands go together."""

import shlex
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import shown_clips
from blue_ball import CENTERS, RADIUS, SIZE, Matchset, ball_picture
from matchset.app.cli_options import TurnOptions, ViewOptions
from matchset.app.locate.rows import read_poses
from matchset.app.track.rows import read_tracks
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.live.files.file_feed import FileFeed
from matchset.live.sources.found_sources import Source
from matchset.live.sources.opening import Opening, open_feed
from mjpeg_server import MjpegServer
from shown_clips import write_clip

WIDTH, HEIGHT = SIZE
FLOWN = "--link", "serial:///dev/null", "--fov", "60", "--camera"  # its source follows


def moved(turn: int, mirror: bool, x: float, y: float) -> tuple[float, float]:
    """Where a pixel comes to."""
    places = {0: (x, y), 90: (HEIGHT - 1 - y, x), 180: (WIDTH - 1 - x, HEIGHT - 1 - y), 270: (y, WIDTH - 1 - x)}
    wide = HEIGHT if turn % 180 else WIDTH
    across, down = places[turn]
    return (wide - 1 - across, down) if mirror else (across, down)


@pytest.mark.parametrize(("turn", "mirror"), [(90, False), (180, False), (270, True), (0, True)])
def test_clicks_and_results_are_in_the_turned_picture(
    matchset: Matchset, ball_video: Path, turn: int, mirror: bool
) -> None:
    words = ["--turn", turn, *(["--mirror"] if mirror else [])]
    x, y = moved(turn, mirror, *CENTERS[0])
    assert matchset("track", ball_video, *words, "--pick", f"{x},{y}", "--no-video", "-o", "out") == 0
    rows = read_tracks("out/tracks.csv")
    assert len(rows) == len(CENTERS)
    for row, center in zip(rows, CENTERS, strict=True):
        assert row.shape is not None
        expected = [*moved(turn, mirror, *center), RADIUS]
        assert [row.shape[name] for name in ("x", "y", "radius")] == pytest.approx(expected, abs=1.0)


def test_the_next_command_has_them_too(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("learn", ball_video, "--turn", 90, "--mirror", "--frame", 0) == 0
    printed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("  matchset track")]
    assert "--turn 90 --mirror" in printed[0]
    assert matchset(*shlex.split(printed[0])[1:], "--no-video", "-o", "out") == 0
    assert all(row.shape is not None for row in read_tracks("out/tracks.csv"))
    assert matchset("track", ball_video, "--turn", 90) == 2
    assert "--turn 90' shows where the ball is" in capsys.readouterr().err


def test_the_next_command_of_a_camera_has_them_too(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    with MjpegServer(lambda number: ball_picture(CENTERS[number % len(CENTERS)])) as server:
        assert matchset("learn", server.url, "--turn", 90, "--mirror") == 0
        url = server.url
    printed = [line for line in capsys.readouterr().out.splitlines() if " track " in line]
    assert f"track {url} --turn 90 --mirror --color" in printed[0]


def test_learn_says_what_is_done_to_the_pictures(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = shown_clips.ball_picture((240, 180), (80.0, 90.0, 30.0), 4 / 3)
    clip = write_clip(tmp_path / "hdv.mp4", [[picture] * 6], ratio=Fraction(4, 3))
    for words in (("--frame", "0"), (), ("--pick", "107,90", "-o", "ball.npz")):
        assert matchset("learn", clip, *words) == 0
        assert capsys.readouterr().err.count("note: pixels are not square, 4:3: pictures of 240 x 180 px are made") == 1


@pytest.mark.usefixtures("no_path_picture")
@pytest.mark.parametrize(("turn", "mirror"), [(90, False), (180, False), (0, True)])
def test_a_camera_file_is_turned_with_the_pictures(
    matchset: Matchset, ball_video: Path, turn: int, mirror: bool
) -> None:
    lens = -0.1, 0.0, 0.01, 0.0, 0.0
    camera = CameraModel(width=WIDTH, height=HEIGHT, fx=150.0, fy=150.0, cx=70.0, cy=66.0, distortion=lens)
    camera.save("camera.toml")
    known = "--camera", "camera.toml", "--diameter", "0.28", "--no-video"
    first = f"{CENTERS[0][0]},{CENTERS[0][1]}"
    assert matchset("locate", ball_video, *known, "--pick", first, "-o", "plain") == 0
    words = ["--turn", turn, *(["--mirror"] if mirror else [])]
    x, y = moved(turn, mirror, *CENTERS[0])
    assert matchset("locate", ball_video, *known, *words, "--pick", f"{x},{y}", "-o", "turned") == 0
    matrix = {90: [[0, -1], [1, 0]], 180: [[-1, 0], [0, -1]], 0: [[-1, 0], [0, 1]]}[turn]
    for plain, turned in zip(read_poses("plain/poses.csv"), read_poses("turned/poses.csv"), strict=True):
        assert plain.values is not None
        assert turned.values is not None
        expected = np.array(matrix) @ [plain.values["x"], plain.values["y"]]
        assert [turned.values["x"], turned.values["y"]] == pytest.approx(expected.tolist(), abs=0.01)
        assert turned.values["z"] == pytest.approx(plain.values["z"], rel=0.01)


@pytest.mark.parametrize(
    "words",
    [
        ("track", "--pick", "50,60"),
        ("learn",),
        ("locate", "--fov", "60", "--diameter", "0.28", "--pick", "50,60"),
        ("calibrate", "--board", "9x6", "--square", "0.025"),
        ("live", "--no-browser", "--port", "0"),
        ("fly", *FLOWN),
        ("preflight", *FLOWN),
    ],
)
def test_a_turn_by_45_is_one_line(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...]
) -> None:
    color = ball_video.with_name("color.npz")
    ColorModel.hsv((100, 100, 60), (130, 255, 255)).save(color)
    colors = ("--color", color, "--marker-color", color) if "--camera" in words else ()
    assert matchset(*words, ball_video, *colors, "--turn", 45) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "turn must be 0, 90, 180 or 270 degrees, clockwise, got 45" in line
    assert not list(Path().iterdir())


@pytest.mark.usefixtures("no_path_picture")
def test_nothing_is_located_in_pixels_that_are_not_square(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    clip = write_clip(
        tmp_path / "hdv.mp4",
        [[shown_clips.ball_picture((240, 180), (80.0 + 2 * k, 90.0, 30.0), 4 / 3) for k in range(6)]],
        ratio=Fraction(4, 3),
    )
    known = "locate", clip, "--fov", "60", "--diameter", "0.28", "--no-video"
    assert matchset(*known, "--stored-pixels", "--pick", "80,90", "-o", "out") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "pixels are 1.333 times as wide as high" in line
    assert "leave out --stored-pixels" in line
    assert not Path("out").exists()
    assert matchset(*known, "--pick", "107,90", "-o", "out") == 0
    noted = capsys.readouterr()
    assert (noted.out + noted.err).count(
        "pixels are not square, 4:3: pictures of 240 x 180 px are made 320 x 180 px"
    ) == 1


def test_the_page_turns_pictures_and_the_camera_beside_them(ball_video: Path, tmp_path: Path) -> None:
    path = tmp_path / "ball.mp4"
    path.write_bytes(ball_video.read_bytes())
    CameraModel.from_fov(WIDTH, HEIGHT, 1.0).save(path.with_suffix(".toml"))
    notes: list[str] = []
    view = ViewOptions(mounted=TurnOptions(turn=270))
    opening = Opening(lambda _: None, notes.append, view=view)
    with open_feed(Source("given", str(path), "a clip"), opening) as feed:
        assert isinstance(feed, FileFeed)
        assert feed.camera is not None
        assert (feed.camera.width, feed.camera.height) == (HEIGHT, WIDTH)
        assert feed.tracking.size == (HEIGHT, WIDTH)
    with open_feed(Source("file", str(path), "of the menu"), opening) as feed:
        assert isinstance(feed, FileFeed)
        assert feed.tracking.size == (WIDTH, HEIGHT)


def test_the_page_shows_square_pictures_and_no_others(matchset: Matchset, tmp_path: Path) -> None:
    picture = shown_clips.ball_picture((240, 180), (80.0, 90.0, 30.0), 4 / 3)
    clip = write_clip(tmp_path / "hdv.mp4", [[picture] * 6], ratio=Fraction(4, 3))
    with open_feed(Source("given", str(clip), "a clip"), Opening(lambda _: None, lambda _: None)) as feed:
        assert isinstance(feed, FileFeed)
        assert feed.tracking.size == (320, 180)
    for option in ("--stored-pixels", "--damaged"):
        assert matchset("live", clip, "--no-browser", "--port", 0, option) == 2


@pytest.mark.parametrize("turn", [0, 90, 180, 270])
@pytest.mark.parametrize("mirror", [False, True])
def test_what_undoes_options(turn: int, mirror: bool) -> None:
    mounted = TurnOptions(turn=turn, mirror=mirror)
    camera = CameraModel(width=64, height=48, fx=50.0, fy=51.0, cx=30.0, cy=20.0)
    back = camera.turned(**mounted.arguments).turned(**mounted.undone.arguments)
    assert back == camera
