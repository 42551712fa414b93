"""Finders of others: they find what was clicked, and what they found is kept."""

import importlib.util
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from benchmarks.crowds import cases
from benchmarks.crowds.cases import Case
from benchmarks.crowds.followers import NAMES, absent, version
from benchmarks.crowds.peers.finders import finder
from benchmarks.crowds.peers.finders.color_range import Range
from benchmarks.crowds.peers.finders.finder import FINDERS, found_by, parameters_of, taught
from benchmarks.crowds.peers.peer import PEERS, Detection, first_of
from benchmarks.crowds.peers.search import climbed

import matchset as ms

BALLS = ((120.0, 100.0, 22.0), (300.0, 260.0, 18.0), (470.0, 120.0, 25.0))
RED, BLUE = (30, 20, 210), (200, 60, 30)
NEEDS = {"edges": hasattr(cv2, "ximgproc"), "spots": importlib.util.find_spec("trackpy") is not None}


def picture(gray: bool = False) -> np.ndarray:
    """Draw red balls, and a blue one between them; bright ones on a gray board."""
    image = np.full((360, 600, 3), 120, np.uint8)
    for (x, y, r), color in zip((*BALLS, (200.0, 220.0, 20.0)), (RED, RED, RED, BLUE), strict=True):
        shown = (240, 240, 240) if gray else color
        if not gray or color is RED:
            cv2.circle(image, (round(16 * x), round(16 * y)), round(16 * r), shown, -1, cv2.LINE_AA, 4)
    return np.ascontiguousarray(image[..., 0]) if gray else image


def found(name: str, gray: bool = False, **other: Any) -> list[Detection]:
    if not NEEDS.get(name, True):
        pytest.skip(f"what {name} needs is not installed here")
    image = picture(gray)
    return taught(name, image, ms.Circle(*BALLS[0]), parameters_of(name) | other)(image)


@pytest.mark.parametrize("gray", [False, True])
@pytest.mark.parametrize("name", FINDERS)
def test_what_looks_like_the_clicked_is_found_and_nothing_else(name: str, gray: bool) -> None:
    wide = {"wide": 1.3} if name == "spots" else {}  # trackpy is off the middle of what is wider than it looks
    centers = sorted(each[:2] for each in found(name, gray, **wide))
    assert len(centers) == len(BALLS)
    assert all(math.dist(one, ball[:2]) < 1.5 for one, ball in zip(centers, sorted(BALLS), strict=True))


@pytest.mark.parametrize("name", ["recipe", "edges"])
def test_radii_are_those_of_the_balls(name: str) -> None:
    for (_, _, r, _), ball in zip(sorted(found(name)), sorted(BALLS), strict=True):
        assert r == pytest.approx(ball[2], abs=2.5)


def test_a_red_of_any_side_of_the_circle_of_hues_is_one_color() -> None:
    image = picture()
    parameters = first_of(FINDERS["recipe"]) | {"blur": 1, "opened": 0, "hue": 8}
    colors = Range(image, ms.Circle(*BALLS[0]), parameters)
    for shift in (-5, 0, 5):
        hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
        hsv[..., 0] = (hsv[..., 0].astype(int) + shift) % 180
        mask = colors.mask(np.asarray(cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR), np.uint8))
        assert mask[100, 120] == 255
        assert mask[220, 200] == 0


def test_what_was_found_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(finder, "FOLDER", tmp_path / "crowds")
    case = Case("billiards", 2, 0.2, 200)
    first = found_by("recipe", case)
    assert len(first.found) == len(first.truth) == 6
    monkeypatch.setattr(finder, "taught", None)
    assert found_by("recipe", case).truth == first.truth


def test_rows_of_a_finder_do_not_depend_on_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    before = version("recipe"), version("norfair"), version("matchset")
    whole = cases.checksum
    monkeypatch.setattr("benchmarks.crowds.followers.checksum", lambda folders: whole(folders) + "x" * len(folders))
    after = version("recipe"), version("norfair"), version("matchset")
    assert [one == other for one, other in zip(before, after, strict=True)] == [True, False, False]
    assert "least" in before[0]


def test_a_peer_says_what_it_is_fed_with() -> None:
    fed = {key: peer.finder for key, peer in PEERS.items()}
    assert [key for key, name in fed.items() if not name] == ["norfair", "byte_track", "oc_sort", "sort"]
    assert {name for name in fed.values() if name} == set(FINDERS)
    assert not absent("matchset")
    assert set(PEERS) < set(NAMES)


def test_parameters_of_finders_are_among_those_that_were_tried() -> None:
    for name, choices in FINDERS.items():
        stored = parameters_of(name)
        assert stored.keys() == choices.keys()
        assert all(value in choices[each] for each, value in stored.items())


def test_a_climb_finds_the_best_and_tries_nothing_twice() -> None:
    tried = []

    def merit(parameters: dict[str, Any]) -> float:
        tried.append(tuple(parameters.values()))
        return -abs(float(parameters["a"] * parameters["b"]) - 6.0) - 0.1 * float(parameters["c"])

    best, most, tries = climbed({"a": (1, 2, 3), "b": (1, 2), "c": (1, 0)}, merit, together=2)
    assert best == {"a": 3, "b": 2, "c": 0}
    assert (most, tries) == (0.0, len(set(tried)))
    assert len(tried) == tries
