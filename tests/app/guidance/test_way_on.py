"""What is said and drawn where nothing, or hardly anything, was found."""

import shlex
from pathlib import Path

import cv2
import numpy as np
import pytest

from blue_ball import CENTERS, SIZE, Matchset, ball_picture
from matchset.app.guidance.rejected import best_rejected
from matchset.app.guidance.why_picture import DrawnEvidence, percent, why_picture
from matchset.app.track.rows import read_tracks
from matchset.image.color import ColorModel
from matchset.shapes.circle import Circle
from matchset.shapes.rectangle import Rectangle

EVERYTHING = "0,0,0:179,255,255"
NOTHING = "50,200,200:60,255,255"


def proposed(text: str) -> list[str]:
    """The words of the only command in a text, without the program's name."""
    (line,) = [line for line in text.splitlines() if line.startswith("  matchset ")]
    return shlex.split(line)[1:]


@pytest.mark.parametrize(
    ("hsv", "words"),
    [(EVERYTHING, "the color covers 100 % of frame 0: narrow it"), (NOTHING, "nothing in frame 0 has this color")],
)
def test_a_run_that_found_nothing_says_why_and_what_to_type(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str], hsv: str, words: str
) -> None:
    assert matchset("track", ball_video, "--hsv", hsv) == 1
    out = capsys.readouterr().out
    assert words in out
    assert "was rejected: " in out
    assert "runs/0001-track/why.png" in out
    picture = cv2.imread("runs/0001-track/why.png")
    assert picture is not None
    assert picture.shape[1] > 800
    command = proposed(out)
    assert command[:2] == ["track", str(ball_video)]
    assert matchset(*command) == 0
    assert all(row.found for row in read_tracks("runs/0002-track/tracks.csv"))
    assert not Path("runs/0002-track/why.png").exists()
    assert "why: " not in capsys.readouterr().out


def test_a_color_of_much_else_is_doubted_though_something_is_found(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("frames").mkdir()
    for index in range(5):
        image = ball_picture((50.0 + index, 60.0))
        image[:, 100:] = ball_picture((80.0, 60.0))[60, 80]  # a wall of the ball's color
        cv2.imwrite(f"frames/{index}.png", image)
    assert matchset("track", "frames", "--hsv", "100,60,60:130,255,255") == 0
    said = capsys.readouterr().err
    assert "note: the color covers " in said
    assert "something else may have been followed" in said
    assert matchset("track", "frames", "--pick", "50,60") == 0
    assert "something else" not in capsys.readouterr().err


@pytest.mark.usefixtures("no_path_picture")
def test_a_located_ball_keeps_its_other_options(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("locate", ball_video, "--fov", "61.5", "--diameter", "0.2", "--hsv", NOTHING) == 1
    command = proposed(capsys.readouterr().out)
    assert command[0] == "locate"
    assert command[command.index("--fov") + 1] == "61.5"
    assert command[command.index("--diameter") + 1] == "0.2"
    assert Path("runs/0001-locate/why.png").is_file()
    assert matchset(*command) == 0


def test_a_ball_seen_for_a_moment_counts_as_hardly_found(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("frames").mkdir()
    for index in range(30):
        cv2.imwrite(f"frames/{index:02d}.png", ball_picture((50.0, 60.0) if index < 2 else None))
    assert matchset("track", "frames", "--pick", "50,60") == 0
    out = capsys.readouterr().out
    assert "found in 2 of 30 frames" in out
    assert "why: frame 2: " in out
    assert Path("runs/0001-track/why.png").is_file()


def test_with_json_on_stdout_the_words_go_to_stderr(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", ball_video, "--hsv", NOTHING, "--print") == 1
    out, err = capsys.readouterr()
    assert all(line.startswith("{") for line in out.splitlines())
    assert "why: " in err


@pytest.mark.usefixtures("no_path_picture")
def test_a_refused_click_leaves_a_picture_and_a_command(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    Path("frames").mkdir()
    flat = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
    for index, center in enumerate([None, *CENTERS[:5]]):
        cv2.imwrite(f"frames/{index}.png", flat if center is None else ball_picture(center))
    for words in (("track", "frames"), ("locate", "frames", "--fov", "60", "--diameter", "0.2"), ("learn", "frames")):
        assert matchset(*words, "--pick", "30,30") == 2
        err = capsys.readouterr().err
        assert sum(line.startswith("error: ") for line in err.splitlines()) == 1
        (why,) = sorted(Path("runs").glob(f"*-{words[0]}/why.png"))
        assert str(why) in err
        assert matchset(*proposed(err)) == 0
        capsys.readouterr()


@pytest.mark.parametrize("family", [Circle, Rectangle])
def test_the_best_rejected_outline_is_where_the_ball_is(family: type[Circle]) -> None:
    image = ball_picture((80.0, 60.0))
    found = best_rejected(image, family, ColorModel.hsv((0, 0, 0), (179, 255, 255)))
    assert found is None or found.reason
    blue = best_rejected(image, family, ColorModel.pick(image, 80, 60))
    assert blue is not None
    assert np.hypot(blue.shape.x - 80.0, blue.shape.y - 60.0) < 8.0


@pytest.mark.parametrize("shape", [(848, 480, 3), (240, 320, 3), (1080, 1920, 3), (40, 30), (12, 900, 3)])
def test_the_picture_of_a_failure_suits_any_size(shape: tuple[int, ...]) -> None:
    image = np.full(shape, 90, np.uint8)
    color = ColorModel.light()
    picture = why_picture("frame 7", image, color, DrawnEvidence(Circle(9.0, 9.0, 5.0), (10.0, 8.0)), ["word " * 80])
    assert max(picture.shape) < 2000
    alone = why_picture("frame 7", image, None, DrawnEvidence(), ["word " * 80])
    assert alone.shape[1] < picture.shape[1]


def test_a_small_share_is_not_called_zero() -> None:
    assert [percent(value) for value in (0.0, 0.04, 0.5, 12.34, 100.0)] == [
        "0.0 %",
        "< 0.1 %",
        "0.5 %",
        "12 %",
        "100 %",
    ]


@pytest.mark.parametrize("hidden", [False, True])
def test_learn_says_where_nothing_looks_much_like_a_ball(
    matchset: Matchset, hidden: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = ball_picture((80.0, 60.0))
    if hidden:
        picture[:, 81:] = 150  # a half of a ball
    cv2.imwrite("ball.png", picture)
    assert matchset("learn", "ball.png") == 0
    assert ("None of them looks much like a ball" in capsys.readouterr().out) == hidden
