"""`detect` finds all equal discs of a picture from one click: touching ones, in gray, hidden in part; each once."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.tracking.ball.places.uncovered_places import UncoveredPlaceParameters, uncovered_places

Image = npt.NDArray[np.uint8]
Color = tuple[int, int, int]
BROWN, BLUE = (40, 70, 110), (190, 70, 30)
RADIUS = 20.0
TOUCHING = [
    (60.0 + 40.0 * column + 20.0 * (row % 2), 50.0 + 35.0 * row) for row in range(4) for column in range(4 - row % 2)
]
UNLIKE = (260.0, 60.0)


def picture(centers: Sequence[tuple[float, float]], color: Color = BROWN, unlike: bool = False) -> Image:
    """Discs with darker rims on a bright table; among them one of another color, if asked for."""
    image = np.full((240, 320, 3), 225, np.uint8)
    colored = [(center, color) for center in centers] + ([(UNLIKE, BLUE)] if unlike else [])
    for (x, y), own in colored:
        place = round(x * 16), round(y * 16)
        dark = tuple(0.6 * value for value in own)
        cv2.circle(image, place, round(RADIUS * 16), dark, cv2.FILLED, cv2.LINE_AA, 4)
        cv2.circle(image, place, round((RADIUS - 2.0) * 16), own, cv2.FILLED, cv2.LINE_AA, 4)
    noise = np.random.default_rng(7).integers(-4, 5, image.shape)
    return (cv2.GaussianBlur(image, (0, 0), 0.8).astype(int) + noise).clip(0, 255).astype(np.uint8)


def found_of(found: Sequence[ms.Track[ms.Circle]], centers: Sequence[tuple[float, float]]) -> list[int]:
    """How many answers each center has."""
    shapes = [each.shape for each in found if abs(each.shape.radius - RADIUS) < 4.0]
    return [sum(math.hypot(shape.x - x, shape.y - y) < 4.0 for shape in shapes) for x, y in centers]


@pytest.mark.parametrize("gray", [False, True])
def test_all_touching_discs_are_found_each_once(gray: bool) -> None:
    image = picture(TOUCHING)
    shown = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8) if gray else image
    for click in (TOUCHING[0], TOUCHING[5]):
        found = ms.detect(shown, ms.Circle, ms.ColorModel.pick(shown, *click), limit=40)
        assert found_of(found, TOUCHING) == [1] * len(TOUCHING)
        assert len(found) == len(TOUCHING)


def test_no_more_than_the_limit_and_the_best_of_one_alone() -> None:
    image = picture(TOUCHING)
    color = ms.ColorModel.pick(image, *TOUCHING[0])
    assert len(ms.detect(image, ms.Circle, color, limit=5)) == 5
    assert len(ms.detect(image, ms.Circle, color, limit=1)) == 1


def test_a_click_on_the_one_unlike_the_rest_gives_that_one() -> None:
    image = picture(TOUCHING, unlike=True)
    (found,) = ms.detect(image, ms.Circle, ms.ColorModel.pick(image, *UNLIKE), limit=40)
    assert found_of([found], [UNLIKE]) == [1]
    others = ms.detect(image, ms.Circle, ms.ColorModel.pick(image, *TOUCHING[0]), limit=40)
    assert found_of(others, [UNLIKE]) == [0]


def test_a_lone_disc_has_no_company() -> None:
    image = picture([(160.0, 120.0)])
    (found,) = ms.detect(image, ms.Circle, ms.ColorModel.pick(image, 160, 120), limit=40)
    assert found_of([found], [(160.0, 120.0)]) == [1]


def test_places_are_where_no_known_disc_covers_the_color() -> None:
    image = picture(TOUCHING)
    color = ms.ColorModel.pick(image, *TOUCHING[0])
    lab = cv2.cvtColor(np.full((1, 1, 3), BROWN, np.float32) / np.float32(255.0), cv2.COLOR_BGR2Lab)[0, 0]
    known = [(x, y, RADIUS) for x, y in TOUCHING[1:]]
    colors = [lab.astype(np.float64)]
    limits = UncoveredPlaceParameters()
    place, *_ = uncovered_places(image, (colors, color), RADIUS, (known, []), 5, limits)
    assert math.dist(place[:2], TOUCHING[0]) < 0.3 * RADIUS
    others = uncovered_places(image, (colors, color), RADIUS, (known, [place]), 5, limits)
    assert all(math.dist(each[:2], place[:2]) > 0.4 * RADIUS for each in others)
    assert len(uncovered_places(image, (colors, color), RADIUS, ([], []), 40, limits)) >= len(TOUCHING)
