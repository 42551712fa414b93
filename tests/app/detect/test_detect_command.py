"""`matchset detect`: the one that was clicked, or all like it; how many are left out is said."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from blue_ball import Matchset

BLUE, RED = (190, 70, 30), (40, 40, 200)
CENTERS = [(50 + 60 * column, 50 + 60 * row) for row in range(3) for column in range(4)]
ODD = (300, 110)


@pytest.fixture
def photograph(tmp_path: Path) -> Path:
    """Twelve blue discs and a red one."""
    image = np.full((220, 350, 3), 150, np.uint8)
    for center, color in [*((each, BLUE) for each in CENTERS), (ODD, RED)]:
        cv2.circle(image, center, 20, color, cv2.FILLED, cv2.LINE_AA)
    noise = np.random.default_rng(3).integers(-3, 4, image.shape)
    path = tmp_path / "my photograph.png"
    cv2.imwrite(str(path), (cv2.GaussianBlur(image, (0, 0), 0.8).astype(int) + noise).clip(0, 255).astype(np.uint8))
    return path


def rows(out: str) -> list[list[float]]:
    return [
        [float(word) for word in line.split()]
        for line in out.splitlines()
        if line.strip()[:1].isdigit() and "." in line
    ]


def test_all_are_listed_and_drawn(matchset: Matchset, photograph: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("detect", photograph, "--pick", "50,50", "--all", "-o", "found.png") == 0
    out = capsys.readouterr().out
    assert out.splitlines()[-1] == "12 found"
    places = {(round(row[1]), round(row[2])) for row in rows(out)}
    assert len(places) == 12
    assert all(min(np.hypot(x - a, y - b) for a, b in CENTERS) < 2.0 for x, y in places)
    assert cv2.imread("found.png") is not None


def test_what_is_left_out_is_said_by_number(
    matchset: Matchset, photograph: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("detect", photograph, "--pick", "50,50", "--all", "--most", "5") == 0
    out = capsys.readouterr().out
    assert len(rows(out)) == 5
    assert out.splitlines()[-1] == "5 of 12 shown: --most 12 shows more"
    assert Path("runs/0001-detect/found.png").is_file()


@pytest.mark.parametrize("words", [(), ("--all",)])
def test_the_one_unlike_the_rest_is_alone(
    words: tuple[str, ...], matchset: Matchset, photograph: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("detect", photograph, "--pick", "300,110", *words) == 0
    (row,) = rows(capsys.readouterr().out)
    assert row[1:4] == pytest.approx([300.0, 110.0, 20.0], abs=1.0)


def test_without_all_it_is_the_clicked_one(
    matchset: Matchset, photograph: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("detect", photograph, "--pick", "172,108") == 0
    (row,) = rows(capsys.readouterr().out)
    assert row[1:4] == pytest.approx([170.0, 110.0, 20.0], abs=1.0)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--most", "5"), "--most is of several: give --all"),
        (("-o", "found.csv"), "-o names a picture"),
    ],
)
def test_what_is_refused(
    words: tuple[str, ...], said: str, matchset: Matchset, photograph: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("detect", photograph, "--pick", "50,50", *words) == 2
    assert said in capsys.readouterr().err
