"""What `track` and `learn` say of black pictures, of pictures that change in size, and of files that do not decode."""

import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from blue_ball import CENTERS, RADIUS, SIZE, Matchset, Picture, ball_picture
from matchset.app.target.frame_picker import is_black
from matchset.app.track.rows import read_tracks
from strange_clips import needs_opencv5

BLACK = 7  # frames


@pytest.fixture(scope="module")
def dark_start(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The ball's video behind seven frames of black with a little noise."""
    path = tmp_path_factory.mktemp("dark") / "dark.mp4"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, SIZE)
    for index in range(BLACK):
        writer.write(np.random.default_rng(index).integers(0, 12, (SIZE[1], SIZE[0], 3)).astype(np.uint8))
    for center in CENTERS:
        writer.write(ball_picture(center))
    writer.release()
    return path


def one_error(capsys: pytest.CaptureFixture[str]) -> str:
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    assert lines[0].startswith("error: ")
    return lines[0].removeprefix("error: ")


@pytest.mark.parametrize(
    "words",
    [
        ("track", "--pick", "50,60"),
        ("track", "--pick", "50,60@3"),
        ("track", "--gray", "dark", "--pick", "50,60"),
        ("locate", "--fov", "60", "--diameter", "0.3", "--pick", "50,60"),
        ("learn", "--pick", "50,60"),
        ("learn", "--frame", "2"),
    ],
)
def test_a_click_on_a_black_picture_says_where_it_ends(
    matchset: Matchset, dark_start: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...]
) -> None:
    assert matchset(words[0], dark_start, *words[1:]) == 2
    error = one_error(capsys)
    assert "is black; the first after it that is not is frame 7: choose that one, --pick X,Y@7" in error
    assert list(Path().iterdir()) == []


def test_learn_skips_black_pictures_and_its_command_works(
    matchset: Matchset, dark_start: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("learn", dark_start) == 0
    (printed,) = re.findall(r"--pick (\d+,\d+@(\d+))$", capsys.readouterr().out, re.MULTILINE)
    assert int(printed[1]) >= BLACK
    assert matchset("track", dark_start, "--pick", printed[0], "-o", "out") == 0
    found = [row.found for row in read_tracks("out/tracks.csv")]
    assert found == [False] * BLACK + [True] * len(CENTERS)


def test_a_video_that_is_black_throughout_says_so(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    Path("black").mkdir()
    for index in range(3):
        cv2.imwrite(f"black/{index}.png", np.zeros((SIZE[1], SIZE[0], 3), np.uint8))
    assert matchset("learn", "black") == 2
    assert one_error(capsys) == "the video holds no frames but black ones"
    assert matchset("track", "black", "--pick", "50,60") == 2
    assert one_error(capsys) == "frame 0 is black, and so is what follows"


def test_a_small_light_in_the_night_is_not_black() -> None:
    night = np.zeros((480, 640), np.uint8)
    assert is_black(night)
    assert is_black(night[:1, :1])
    cv2.circle(night, (200, 300), 5, 80, cv2.FILLED)
    assert not is_black(night)
    assert not is_black(np.dstack([night] * 3))


def test_the_rate_can_be_given(matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", "-o", "out", "--fps", "240") == 0
    times = [row.time for row in read_tracks("out/tracks.csv")]
    assert times == pytest.approx([index / 240.0 for index in range(len(CENTERS))], abs=1e-6)
    capsys.readouterr()
    assert matchset("track", ball_video, "--pick", "50,60", "--fps", "0") == 2
    assert one_error(capsys) == "fps must be positive, got 0.0"


def test_pictures_that_change_in_size_end_the_run_and_what_was_done_is_whole(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("frames").mkdir()
    for index, center in enumerate(CENTERS):
        picture = ball_picture(center)
        cv2.imwrite(f"frames/{index}.png", picture if index < 20 else picture[:100])
    assert matchset("track", "frames", "--pick", "50,60", "-o", "out", "--video", "out.webm") == 2
    assert "error: frames: frame 20 is 160 x 100 in color, those before it are 160 x 120" in capsys.readouterr().err
    assert [row.found for row in read_tracks("out/tracks.csv")] == [True] * 20
    video = cv2.VideoCapture("out.webm")
    assert sum(video.grab() for _ in range(30)) == 20


def motion_jpeg(path: Path, pictures: list[Picture]) -> Path:
    """Write pictures of any sizes as a stream of JPEGs."""
    quality = [cv2.IMWRITE_JPEG_QUALITY, 95]
    path.write_bytes(b"".join(cv2.imencode(".jpg", picture, quality)[1].tobytes() for picture in pictures))
    return path


@needs_opencv5
def test_a_size_that_changes_inside_a_file_is_brought_to_the_first(matchset: Matchset, tmp_path: Path) -> None:
    sizes = [SIZE] * 10 + [(320, 240)] * 10 + [(240, 180)] * 10
    pictures = [
        cv2.resize(ball_picture(center), size).astype(np.uint8) for center, size in zip(CENTERS, sizes, strict=True)
    ]
    path = motion_jpeg(tmp_path / "sizes.mjpeg", pictures)
    assert matchset("track", path, "--pick", "50,60", "-o", "out") == 0
    for row, (x, y) in zip(read_tracks("out/tracks.csv"), CENTERS, strict=True):
        assert row.shape is not None
        assert [row.shape[name] for name in ("x", "y", "radius")] == pytest.approx([x, y, RADIUS], abs=1.5)


@needs_opencv5
@pytest.mark.parametrize("size", [(160, 200), (240, 120), (200, 300)])
def test_a_ball_that_another_aspect_ratio_flattens_is_lost(
    matchset: Matchset, tmp_path: Path, size: tuple[int, int]
) -> None:
    wall = np.full((size[1], size[0], 3), 150, np.uint8)
    wall[: SIZE[1], : SIZE[0]] = ball_picture(CENTERS[15])
    path = motion_jpeg(tmp_path / "sizes.mjpeg", [*map(ball_picture, CENTERS[:15]), *[wall] * 10])
    assert matchset("track", path, "--pick", "50,60", "-o", "out") == 0
    assert [row.found for row in read_tracks("out/tracks.csv")] == [True] * 15 + [False] * 10


def test_what_cannot_be_read_leaves_every_file_as_it_is(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("out.webm", "ball.npz", "out/tracks.csv"):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_text("precious")
    unfinished = b"\0\0\0\x10ftypisom\0\0\0\0\0\x01\0\0mdat" + bytes(500)
    for name, content in {"half.mp4": unfinished, "noise.avi": bytes(range(256)) * 20, "riff.avi": b"RIFF"}.items():
        Path(name).write_bytes(content)
        assert matchset("track", name, "--pick", "5,5", "--video", "out.webm", "-o", "out", "--force") == 2
        assert name in one_error(capsys)
        assert matchset("learn", name, "--pick", "5,5", "-o", "ball.npz", "--force") == 2
        assert name in one_error(capsys)
    assert all(Path(name).read_text() == "precious" for name in ("out.webm", "ball.npz", "out/tracks.csv"))
