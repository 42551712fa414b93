"""The examples on real pictures, where they are at hand; none of them is ever copied into the repository."""

import re
import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from benchmarks.shapes.cases import corner_error
from benchmarks.shapes.tags import reference

ROOT = Path(__file__).resolve().parents[1]
STILLS = ROOT.parent / "shared" / "data" / "stills"
Run = Callable[..., list[str]]
# Corners of the picture on the tea box's front, px, from frames enlarged and looked at: good to 2 px.
BORDER = 5.0  # px: width of the border printed around the picture; any of its edges is followed rightly
PANEL = {
    0: [(335, 133), (516, 188), (506, 216), (334, 158)],
    190: [(198, 162), (389, 203), (389, 237), (206, 197)],
    304: [(172, 229), (362, 297), (359, 331), (176, 265)],
    437: [(343, 173), (522, 189), (514, 220), (341, 203)],
}

pytestmark = pytest.mark.skipif(not STILLS.exists(), reason=f"the real pictures are not here: {STILLS}")


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run an example with words behind it; the lines that it prints."""

    def call(name: str, *words: object) -> list[str]:
        monkeypatch.setattr(sys, "argv", [name, *map(str, words)])
        runpy.run_path(str(ROOT / "examples" / name))
        return capsys.readouterr().out.splitlines()

    return call


def numbers(line: str) -> list[float]:
    return [float(each) for each in re.findall(r"-?\d+(?:\.\d+)?", line)]


def test_all_copper_coins_are_found_though_they_touch(run: Run) -> None:
    found = [numbers(line)[:3] for line in run("detect_coins.py", STILLS / "coins.jpg", "dark")]
    assert len(found) == 24
    assert all(23.0 < radius < 25.0 for _, _, radius in found)


def test_most_old_coins_are_found_and_nothing_else(run: Run) -> None:
    found = np.array([numbers(line)[:3] for line in run("detect_coins.py", STILLS / "skimage_coins.png", "light")])
    assert len(found) >= 22  # of 24; two are as dark as the ground on one side
    assert (found[:, 2] > 15.0).all()
    assert (found[:, 2] < 35.0).all()
    for row in (55, 125, 195, 265):  # they lie in four rows of six
        assert 4 <= (np.abs(found[:, 1] - row) < 25.0).sum() <= 6


@pytest.mark.parametrize(
    ("click", "places"),
    [
        ((376, 82), [(377, 81), (294, 320), (347, 237)]),  # all the blue ones
        ((33, 228), [(33, 228), (98, 259), (219, 306), (287, 213)]),  # all the red ones, not the orange ones
        ((268, 118), [(268, 118), (386, 171)]),  # green; a third one is cut by the picture's corner
    ],
)
def test_sweets_of_one_color_are_found(run: Run, click: tuple[int, int], places: list[tuple[float, float]]) -> None:
    found = [numbers(line)[:3] for line in run("detect_picture.py", STILLS / "smarties.png", *click)]
    assert sorted((x, y) for x, y, _ in found) == [pytest.approx(place, abs=3.0) for place in sorted(places)]
    assert all(25.0 < radius < 29.0 for _, _, radius in found)


@pytest.mark.parametrize(
    ("number", "rough", "ball"), [(1, (152, 127, 29), (150, 128)), (2, (175, 110, 30), (169, 112))]
)
def test_a_gray_ball_is_found_from_a_near_start(
    run: Run, number: int, rough: tuple[int, int, int], ball: tuple[int, int]
) -> None:
    """Half before a dark door and half before a light one, held by two hands: only a start that is near will do."""
    dark, *_ = run("begin_roughly.py", STILLS / f"basketball{number}.png", *rough)
    x, y, radius = numbers(dark)[:3]
    assert (x, y) == pytest.approx(ball, abs=4.0)
    assert radius == pytest.approx(29.0, abs=3.0)


def test_the_picture_on_a_tea_box_is_followed_to_the_end(run: Run) -> None:
    rough = ("333,135", "515,188", "505,213", "333,160")
    lines = run("track_print.py", STILLS / "box.mp4", *rough)
    assert len(lines) == 455
    assert [line for line in lines if "lost" in line] == []
    for frame, corners in PANEL.items():
        found = np.array(numbers(lines[frame])[1:9]).reshape(4, 2)
        assert corner_error(found, np.array(corners, float)) < BORDER, frame


@pytest.mark.parametrize("path", sorted(STILLS.glob("apriltag*.txt")), ids=lambda path: path.stem)
def test_the_border_of_the_largest_tag_is_found_from_its_box(run: Run, path: Path) -> None:
    truth = max(reference(path), key=lambda corners: float(np.ptp(corners, axis=0).min()))
    box = (*truth.min(axis=0), *truth.max(axis=0))
    (line,) = run("printed_mark.py", path.with_suffix(".jpg"), *np.rint(box))
    assert corner_error(np.array(numbers(line)).reshape(4, 2), truth) < 1.0
