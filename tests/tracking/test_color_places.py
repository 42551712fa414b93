"""Places of a ball's color: a disc that stands out is found, and what was looked at in vain is left out."""

import math

import numpy as np
import pytest
from scenes import BLUE, Picture, blue, scene, with_ball

from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.places.color_places import ColorPlaceParameters, places_of_color

LIMITS = ColorPlaceParameters()
COLOR = blue()
LAB = lab_of(np.array(BLUE, np.uint8).reshape(1, 1, 3)).reshape(3).astype(np.float64)
EVERYWHERE = 1000.0


def found(
    image: Picture,
    radius: float,
    *,
    at: tuple[float, float] = (160.0, 120.0),
    reach: float = EVERYWHERE,
    turn: int = 0,
    in_vain: list[tuple[float, float]] | None = None,
    limits: ColorPlaceParameters = LIMITS,
) -> list[Circle3]:
    return places_of_color(
        image, (LAB, COLOR), ((*at, radius), reach), turn, [(*each, 0.0) for each in in_vain or []], limits
    )


def off(circle: Circle3, ball: tuple[float, float, float]) -> float:
    return math.dist(circle[:2], ball[:2])


@pytest.mark.parametrize("ball", [(201.3, 70.6, 20.0), (40.0, 200.5, 12.0), (300.0, 30.0, 6.0), (90.2, 33.7, 3.0)])
def test_a_disc_of_the_color_comes_first(ball: tuple[float, float, float]) -> None:
    places = found(scene(ball), ball[2])
    assert off(places[0], ball) < 0.5 * ball[2]
    assert places[0][2] == pytest.approx(LIMITS.larger * ball[2])


def test_of_several_all_are_found_each_once_and_no_more_than_the_most() -> None:
    balls = [(60.0, 60.0, 15.0), (240.0, 70.0, 15.0), (150.0, 180.0, 15.0)]
    places = found(scene(*balls), 15.0)
    assert len(places) == LIMITS.most == 3
    assert sorted(min(range(3), key=lambda k: off(place, balls[k])) for place in places) == [0, 1, 2]


def test_the_ball_comes_before_a_disc_of_another_color() -> None:
    orange = 30, 120, 230
    image = with_ball(scene((60.0, 60.0, 15.0)), 200.0, 100.0, 15.0, orange)
    assert off(found(image, 15.0)[0], (60.0, 60.0, 15.0)) < 7.5
    by_lab = ColorPlaceParameters(table=0.0)
    places = found(image, 15.0, limits=by_lab)
    assert min(off(place, (200.0, 100.0, 15.0)) for place in places) > 15.0


def test_a_wall_of_the_color_does_not_stand_out() -> None:
    blue_wall = np.broadcast_to(np.array(BLUE, np.uint8), (240, 320, 3)).copy()
    assert found(blue_wall, 15.0) == []


def test_what_was_looked_at_in_vain_is_left_out() -> None:
    ball = 60.0, 60.0, 15.0
    in_vain = list[tuple[float, float]]()
    for _ in range(8):
        places = found(scene(ball), 15.0, in_vain=in_vain)
        assert all(math.dist(place[:2], each) > 0.3 * 15.0 for place in places for each in in_vain)
        in_vain += [place[:2] for place in places]
    assert found(scene(ball), 15.0, in_vain=in_vain) == []
    other = 240.0, 170.0, 15.0
    assert off(found(scene(ball, other), 15.0, in_vain=in_vain)[0], other) < 7.5


def test_only_the_window_is_read() -> None:
    one, other = (60.0, 60.0, 15.0), (240.0, 170.0, 15.0)
    (place,) = found(scene(one, other), 15.0, at=(230.0, 160.0), reach=60.0)
    assert off(place, other) < 7.5
    assert found(scene(one), 15.0, at=(900.0, 160.0), reach=60.0) == []


def test_a_large_window_is_read_by_turns_and_no_part_is_left_out() -> None:
    limits = ColorPlaceParameters(cells=4000)
    parts = math.ceil(160 * 120 / 4000)
    assert parts == 5
    for y in (10.0, 48.0, 96.0, 120.0, 145.0, 230.0):
        ball = 200.0, y, 4.0
        turns = [bool(found(scene(ball), 4.0, turn=turn, limits=limits)) for turn in range(2 * parts)]
        assert 1 <= sum(turns[:parts]) <= 2, "where parts meet both see it"
        assert turns[:parts] == turns[parts:]


def test_gray_pictures_have_places_by_lightness() -> None:
    image = np.ascontiguousarray(scene((201.0, 70.0, 15.0))[:, :, 2:])
    level = lab_of(np.full((1, 1, 1), BLUE[2], np.uint8)).reshape(3).astype(np.float64)
    places = places_of_color(image, (level, COLOR), ((160.0, 120.0, 15.0), EVERYWHERE), 0, [], LIMITS)
    assert off(places[0], (201.0, 70.0, 15.0)) < 7.5


def test_a_ball_that_came_nearer_is_proposed_as_large_as_it_is() -> None:
    ball = 150.0, 110.0, 40.0
    first = found(scene(ball), 15.0)[0]
    assert off(first, ball) < 0.1 * ball[2]
    assert first[2] == pytest.approx(ball[2], rel=0.25)  # the network is led on from there
