import itertools
import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from benchmarks.clicks.scenes import draw

from blue_ball import Matchset, ball_picture
from matchset.app.guidance.large_frames import LargeFrameParameters, reduced, rescaled
from matchset.app.track import learn_command
from matchset.image.candidates import Candidate, find_candidates
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.sim.clips.clip import Clip

DATA = Path(__file__).parents[4] / "shared" / "data"


def commands(capsys: pytest.CaptureFixture[str]) -> list[list[str]]:
    lines = capsys.readouterr().out.splitlines()
    return [shlex.split(line)[1:] for line in lines if line.startswith("  matchset ")]


def test_the_printed_commands_work_as_they_stand(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("learn", ball_video) == 0
    shown = commands(capsys)
    assert [words[0] for words in shown] == ["track"]
    assert "--pick" in shown[0]
    for words in shown:
        assert str(ball_video) in words
        assert matchset(*words) == 0
    picture = cv2.imread("runs/0001-learn/frame-0.png")
    assert picture is not None
    assert picture.shape[1] > 160


def test_a_pick_saves_a_color_and_a_mask(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("learn", ball_video, "--frame", "3", "--pick", "56,60", "-o", "my colors/ball.npz") == 0
    mask = ColorModel.load("my colors/ball.npz").mask(ball_picture((56.0, 60.0)))
    assert mask[60, 56] == 255
    assert mask[5, 5] == 0
    assert Path("my colors/ball-mask.png").is_file()
    (words,) = commands(capsys)
    assert matchset(*words) == 0
    assert matchset("learn", ball_video, "--pick", "56,60@3", "-o", "my colors/ball.npz") == 2
    assert "exists: choose another name" in capsys.readouterr().err


def test_what_was_clicked_on_a_ball_with_a_marker_is_said_and_may_be_the_marker(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    image, ball, spot = draw("spotted", 4)
    assert spot is not None
    cv2.imwrite("spotted.png", image)
    click = f"{spot[0]:.0f},{spot[1]:.0f}"
    others = ColorModel.pick(image, round(spot[0]), round(spot[1])).alternatives
    number = 1 + [each.name for each in others].index("ball around it")
    for name, more in (("first", ()), ("whole", ("--reading", str(number))), ("marker", ("--marker",))):
        assert matchset("learn", "spotted.png", "--pick", click, *more, "-o", f"{name}.npz") == 0
        assert ("the click is taken for: " in capsys.readouterr().err) == (name != "marker")
    on_ball = round(ball[1] + 0.8 * ball[2]), round(ball[0])
    pixels = np.array([[image[round(spot[1]), round(spot[0])], image[on_ball]]])
    assert (ColorModel.load("marker.npz").scores(pixels)[0] > 0).tolist() == [True, False]
    assert ColorModel.load("whole.npz").scores(pixels)[0, 1] > 0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--pick", "56,60@3", "--frame", "4"), "--pick says frame 3, --frame says 4"),
        (("--pick", "560,60"), "does not lie in"),
        (("--pick", "56,60", "-o", "ball.txt"), "must end in .npz"),
        (("-o", "ball.npz"), "names a picture"),
        (("--marker",), "say what a --pick means: give one"),
        (("--reading", "2"), "say what a --pick means: give one"),
        (("--pick", "56,60", "--marker", "--reading", "2"), "one of --marker and --reading, not both"),
        (("--pick", "56,60", "--reading", "9"), "reading 9 of the click (56, 60): there are"),
        (("--frame", "99"), "there is no frame 99"),
    ],
)
def test_misuse_is_one_line(
    matchset: Matchset,
    ball_video: Path,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    words: str,
) -> None:
    assert matchset("learn", ball_video, *options) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert words in line


def test_a_picture_without_a_ball_ends_with_one(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    cv2.imwrite("wall.png", ball_picture(None))
    assert matchset("learn", "wall.png") == 1
    assert "nothing ball-like" in capsys.readouterr().out
    assert Path("runs/0001-learn/frame-0.png").is_file()


@pytest.mark.parametrize("gray", [False, True], ids=["color", "gray"])
def test_a_large_picture_is_shown_small_and_its_ball_is_found(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], gray: bool
) -> None:
    image = cv2.resize(ball_picture((56.0, 60.0)), None, fx=13, fy=13, interpolation=cv2.INTER_CUBIC)
    assert max(image.shape) > LargeFrameParameters().longest_px
    cv2.imwrite("large.png", cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if gray else image)
    assert matchset("learn", "large.png") == 0
    (words,) = commands(capsys)
    grid = cv2.imread("runs/0001-learn/frame-0.png")
    assert grid is not None
    assert max(grid.shape) < 2000
    assert Path("runs/0001-learn/frame-0.png").stat().st_size < 2e6
    assert matchset(*words) == 0
    assert matchset("learn", "large.png", "--pick", words[-1]) == 0
    mask = cv2.imread(str(next(Path("runs").glob("*-learn/ball-mask.png"))))
    assert mask is not None
    assert max(mask.shape) < 4000


def test_candidates_are_the_same_in_both_copies_of_a_large_frame() -> None:
    frame = Frame(np.zeros((3000, 4000, 3), np.uint8), 1.5, 7)
    small = reduced(frame)
    assert (small.image.shape, small.time, small.index) == ((1440, 1920, 3), 1.5, 7)
    assert reduced(small) is small
    candidate = Candidate(100.0, 50.0, 20.0, (1919, 1439), 0.7)
    whole = rescaled(candidate, small, frame)
    assert 3990 < whole.pick[0] < 4000
    assert 2990 < whole.pick[1] < 3000
    assert whole.radius == pytest.approx(20.0 * 4000 / 1920)
    back = rescaled(whole, frame, small)
    assert (back.x, back.y, back.radius) == pytest.approx((100.0, 50.0, 20.0))
    assert back.pick == (1919, 1439)


class FakeCamera:
    """A camera before which the ball lies still."""

    live, length, warnings = True, None, ()

    def __init__(self, _source: str, **_: object) -> None:
        self.index = -1

    def __iter__(self) -> Iterator[Frame]:
        return self

    def until(self, stopped: Callable[[], bool]) -> Iterator[Frame]:
        return itertools.takewhile(lambda _: not stopped(), self)

    def __next__(self) -> Frame:
        self.index += 1
        return Frame(ball_picture((56.0, 60.0)), 0.1 * self.index, self.index)

    def __enter__(self) -> "FakeCamera":
        return self

    def __exit__(self, *error: Any) -> None: ...


def test_before_a_camera_the_candidates_colors_are_saved(
    matchset: Matchset, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("matchset.media.video.Video", FakeCamera)
    assert matchset("learn", "0") == 0
    track, learn = commands(capsys)
    assert track == ["track", "0", "--color", "runs/0001-learn/candidate-1.npz"]
    assert ColorModel.load(track[-1]).mask(ball_picture((56.0, 60.0)))[60, 56] == 255
    assert learn[:2] == ["learn", "runs/0001-learn/frame-15-still.png"]
    assert Path(learn[1]).is_file()


def test_before_a_camera_it_names_the_colors_that_it_saved(
    matchset: Matchset, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    image = ball_picture((56.0, 60.0))
    cv2.circle(image, (130, 30), 12, (30, 200, 60), -1)
    cv2.circle(image, (128, 95), 12, (30, 60, 200), -1)

    class ThreeBalls(FakeCamera):
        def __next__(self) -> Frame:
            return Frame(image, 0.1, super().__next__().index)

    real = learn_command._color_of
    monkeypatch.setattr("matchset.media.video.Video", ThreeBalls)
    monkeypatch.setattr(learn_command, "_color_of", lambda frame, c: real(frame, c) if c.x < 129.0 else None)
    assert matchset("learn", "0") == 0
    out = capsys.readouterr().out
    saved = {path.name for path in Path("runs/0001-learn").glob("*.npz")}
    first, others = re.search(r"number (\d), type \(saved beside it: the colors of ([\d, ]+)\)", out).groups()  # type: ignore[union-attr]
    assert saved == {f"candidate-{number}.npz" for number in (first, *others.split(", "))}
    assert re.search(r"No color could be learned of: \d\n", out)


@pytest.mark.parametrize("preset", ["clean", "typical", "bad"])
def test_the_ball_of_a_rendered_room_is_among_nine(preset: str) -> None:
    clip = Clip(frames=300, seed=4, preset=preset)
    background = clip.background()
    for index in (0, 150, 299):
        circle = clip.truth(index).circle
        assert circle is not None
        found = find_candidates(clip.render(index, background).image)
        assert 1 <= len(found) <= 9
        assert any(
            np.hypot(c.x - circle.x, c.y - circle.y) < 0.3 * circle.radius and 0.7 < c.radius / circle.radius < 1.4
            for c in found
        )


def test_the_same_picture_gives_the_same_numbers() -> None:
    image = Clip(preset="bad").render(0, Clip(preset="bad").background()).image
    assert find_candidates(image) == find_candidates(image.copy())


@pytest.mark.parametrize("shape", [(1, 1, 3), (3, 2000), (40, 40), (7, 9, 3)])
def test_candidates_of_odd_pictures(shape: tuple[int, ...]) -> None:
    assert find_candidates(np.zeros(shape, np.uint8)) == []
    noise: npt.NDArray[Any] = np.random.default_rng(0).integers(0, 255, shape, np.uint8)
    find_candidates(noise)


@pytest.mark.skipif(not DATA.is_dir(), reason="real footage is not here: ../shared/data")
def test_the_real_ball_is_number_one() -> None:
    video = cv2.VideoCapture(str(DATA / "green_ball_hand" / "video.mp4"))
    for _ in range(60):
        video.grab()
    best = find_candidates(np.asarray(video.read()[1], np.uint8))[0]
    assert np.hypot(best.x - 426.75, best.y - 145.82) < 5.0
    assert best.radius == pytest.approx(28.8, abs=4.0)
