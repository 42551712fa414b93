"""What `track --all` says of the first picture: how many balls, doubtful, left out; doubtful ones are drawn dashed."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from blue_ball import Matchset
from doubtful_ball import BALLS, FLAT, RADIUS, SIZE, picture
from matchset.app.several.crowd import CrowdParameters, DoubtfulBalls
from matchset.app.several.painter import TargetsPainter, draw_doubtful, target_words
from matchset.app.several.target_rows import TargetsRow

FIRST = "first picture: "
PICK = f"{BALLS[1][0]},{BALLS[1][1]}"
HSV = "100,100,50:130,255,255"
GRAY, BLUE = (150, 150, 150), (200, 60, 30)


@pytest.fixture(scope="module")
def crowd(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("crowd") / "balls", lambda _: picture(0))


def written(folder: Path, draw: Any, count: int = 6) -> Path:
    folder.mkdir()
    for index in range(count):
        cv2.imwrite(str(folder / f"{index}.png"), draw(index))
    return folder


def plain(color: tuple[int, int, int]) -> Any:
    """Pictures of one color, and of noise."""
    return lambda number: np.clip(color + np.random.default_rng(number).normal(0.0, 3.0, (240, 320, 3)), 0, 255).astype(
        np.uint8
    )


def firsts(out: str) -> list[str]:
    return [line.removeprefix(FIRST) for line in out.splitlines() if line.startswith(FIRST)]


def found_at(clock: float, x: float, y: float, radius: float = 14.0) -> ms.Track[ms.Circle]:
    return ms.Track(ms.Circle(x, y, radius), np.eye(3), 1.0, np.empty((0, 2)), clock)


def test_the_first_picture_is_counted_at_once_and_at_the_end(
    matchset: Matchset, crowd: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ("track", crowd, "--pick", PICK, "--all", "--no-video", "-o")
    assert matchset(*command, "out") == 0
    out = capsys.readouterr().out
    assert firsts(out) == ["3 balls like it; 1 more is doubtful"] * 2
    assert out.startswith(FIRST)
    assert matchset(*command, "few", "--most", "2") == 0
    assert firsts(capsys.readouterr().out) == ["3 balls like it; 1 left out, since --most is 2; 1 more is doubtful"] * 2
    head = Path("out/tracks.csv").read_text().splitlines()[0]
    assert head.endswith("reason,identity,label,alternatives")
    assert matchset(*command, "both", "--smooth") == 0
    assert firsts(capsys.readouterr().out) == ["3 balls like it; 1 more is doubtful"] * 2
    assert matchset(*command, "lines", "--print") == 0
    told = capsys.readouterr()
    assert (len(firsts(told.err)), firsts(told.out)) == (2, [])


def test_what_is_picked_without_all_is_not_counted(
    matchset: Matchset, crowd: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ("track", crowd, "--pick", PICK, "--pick", f"{BALLS[0][0]},{BALLS[0][1]}", "--no-video", "-o", "out")
    assert matchset(*command) == 0
    assert not firsts(capsys.readouterr().out)


def test_a_ball_unlike_the_rest_is_one_like_it(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def draw(number: int) -> npt.NDArray[np.uint8]:
        image = picture(number, flat=False)
        cv2.circle(image, FLAT, RADIUS, (30, 30, 210), cv2.FILLED, cv2.LINE_AA)
        return image

    odd = written(tmp_path / "odd", draw)
    assert matchset("track", odd, "--pick", f"{FLAT[0]},{FLAT[1]}", "--all", "--no-video", "-o", "out") == 0
    out = capsys.readouterr().out
    assert firsts(out) == ["1 ball like it"] * 2
    assert "1 target in 6 frames" in out


@pytest.mark.parametrize(
    ("color", "words"),
    [(GRAY, "; nothing in it has the color"), (BLUE, "; the color covers 100 % of it: narrow it, unless the balls do")],
)
def test_a_picture_full_of_the_color_or_without_it_says_so(
    matchset: Matchset,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    color: tuple[int, int, int],
    words: str,
) -> None:
    scene = written(tmp_path / "scene", plain(color))
    assert matchset("track", scene, "--hsv", HSV, "--all", "--no-video", "-o", "out") == 1
    assert firsts(capsys.readouterr().out) == [f"no ball like it{words}"] * 2


def test_more_that_are_left_out_later_are_told_at_the_end(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def draw(number: int) -> npt.NDArray[np.uint8]:
        image = picture(0, flat=False)
        if number < 3:
            image[:, 130:] = picture(1, flat=False)[:, :1]
        return image

    late = written(tmp_path / "late", draw, 12)
    assert matchset("track", late, "--pick", PICK, "--all", "--most", "2", "--no-video", "-o", "out") == 0
    out = capsys.readouterr().out
    assert firsts(out) == ["2 balls like it"] * 2
    assert "\nlater up to 1 at once left out, since --most is 2\n" in out


class Seen:
    """What is needed of a tracker."""

    def __init__(self) -> None:
        self.doubtful: list[Any] = []
        self.left_out, self.finds = 0, True
        self.colors = {"0": ms.ColorModel.pick(picture(0), *BALLS[1])}


def test_what_is_doubtful_stays_until_it_is_followed_or_gone() -> None:
    tracker, limits = Seen(), CrowdParameters()
    doubtful = DoubtfulBalls(tracker)  # type: ignore[arg-type]

    def see(clock: float, *targets: Any, flat: bool = True, left_out: int = 0) -> int:
        doubtful.update(ms.Frame(picture(0, flat), clock, round(30 * clock)), targets, left_out)
        return len(doubtful.tracks)

    tracker.doubtful = [found_at(0.0, *FLAT, 11.0)]
    assert see(0.0) == 1
    tracker.doubtful = []
    assert see(0.5 * limits.kept) == 1
    assert doubtful.at(FLAT[0] + 8.0, FLAT[1]) is doubtful.tracks[0]
    assert doubtful.at(FLAT[0] + 18.0, FLAT[1]) is None
    assert see(1.1 * limits.kept) == 0
    for ends in ({"flat": False}, {}):
        tracker.doubtful = [found_at(4.0, *FLAT, 11.0)]
        assert see(4.0) == 1
        tracker.doubtful = []
        followed: list[ms.Target[Any]] = [] if ends else [ms.Target(0, "0", found_at(4.1, *FLAT), 0.0)]
        assert see(4.1, *followed, **ends) == 0
    expected: ms.Target[Any] = ms.Target(0, "0", ms.Lost("hidden", 5.0, ms.Circle(*FLAT, 14.0)), 0.0)
    tracker.doubtful = [found_at(5.0, *FLAT, 11.0)]
    assert see(5.0, expected) == 0


def test_the_number_that_is_left_out_does_not_flicker() -> None:
    tracker = Seen()
    doubtful = DoubtfulBalls(tracker)  # type: ignore[arg-type]
    told = []
    for number, (count, finds) in enumerate([(2, True), (0, True), (1, True), (0, False), (0, True)]):
        tracker.left_out, tracker.finds = count, finds
        doubtful.update(ms.Frame(picture(0), 0.3 * number, number), [], number == 2)
        told.append(doubtful.left_out)
    assert told == [2, 2, 2, 2, 0]


def test_doubtful_ones_are_dashed_and_a_name_in_doubt_has_a_question_mark() -> None:
    image = np.full((SIZE[1], SIZE[0], 3), 90, np.uint8)
    draw_doubtful(image, [found_at(0.0, 160.0, 120.0, 40.0)])
    turns = np.linspace(0.0, 2.0 * np.pi, 720)
    rim = image[np.rint(120 + 40 * np.sin(turns)).astype(int), np.rint(160 + 40 * np.cos(turns)).astype(int)].max(
        axis=1
    )
    assert 0.3 < (rim > 150).mean() < 0.8
    sure: ms.Target[Any] = ms.Target(3, "blue", found_at(0.0, 160.0, 120.0), 0.0)
    unsure: ms.Target[Any] = ms.Target(3, "blue", found_at(0.0, 160.0, 120.0), 0.0, alternatives=(5,))
    assert [target_words(labels)(each) for labels in (False, True) for each in (sure, unsure)] == [
        "3",
        "3?",
        "3 blue",
        "3? blue",
    ]
    painter, frame = TargetsPainter(SIZE, target_words(False)), ms.Frame(image, 0.0, 0)
    rows: list[TargetsRow[Any]] = [
        TargetsRow(0, 0.0, (), doubtful) for doubtful in ((), (found_at(0.0, 160.0, 120.0),))
    ]
    one, other = (painter.paint(frame, [], row) for row in rows)
    assert (one[SIZE[1] :] != other[SIZE[1] :]).any()  # the strip says how many
