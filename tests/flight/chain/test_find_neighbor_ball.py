"""Of several balls the one that can be the neighbor's."""

import math

import numpy as np
import pytest

import matchset as ms
from matchset.localization.neighbor_ball import AssociationParameters, find_neighbor_ball, in_lights

CAMERA = ms.CameraModel.from_fov(640, 480, math.radians(90.0))
BLUE, ROOM = (200, 70, 30), (120, 140, 150)
RADIUS = 0.14  # m
NEXT, AFTER = (
    (0.3, -0.5, 1.0),
    (0.0, -0.3, 2.9),
)  # the neighbor, and its neighbor: farther off, and whole in the picture
THERE = np.array([0.0, -0.19, 1.5])


def room(*places: tuple[float, float, float], light: float = 1.0, index: int = 0) -> ms.Frame:
    """Draw balls at places, m, as discs with exact coverage, in a share of the light of the room."""
    rows, columns = np.indices((480, 640))
    image = np.full((480, 640, 3), ROOM, np.float64)
    for place in places:
        (x, y), size = CAMERA.project(np.array([place]))[0], CAMERA.fx * RADIUS / place[2]
        cover = np.clip(size + 0.5 - np.hypot(columns - x, rows - y), 0.0, 1.0)[..., np.newaxis]
        image = (1.0 - cover) * image + cover * light * np.array(BLUE)
    return ms.Frame(np.rint(image).astype(np.uint8), index / 30.0, index)


@pytest.fixture
def color() -> ms.ColorModel:
    x, y = CAMERA.project(np.array([AFTER]))[0]
    return ms.ColorModel.pick(room(AFTER).image, x, y)


@pytest.mark.parametrize("after", [AFTER, (0.0, -0.19, 2.1)], ids=["too far", "nearer to the place"])
def test_of_those_that_may_be_it_the_nearest_is_taken(color: ms.ColorModel, after: tuple[float, float, float]) -> None:
    localizer = ms.Localizer(CAMERA, ms.BallTarget(2.0 * RADIUS))
    ball = find_neighbor_ball(room(after, NEXT), (color,), localizer, THERE, 1.0, 6)
    assert ball is not None
    np.testing.assert_allclose((ball.x, ball.y), CAMERA.project(np.array([NEXT]))[0], atol=1.0)


def test_a_ball_too_far_off_is_none(color: ms.ColorModel) -> None:
    localizer = ms.Localizer(CAMERA, ms.BallTarget(2.0 * RADIUS))
    assert find_neighbor_ball(room(AFTER), (color,), localizer, THERE, 1.0, 6) is None
    assert find_neighbor_ball(room(), (color,), localizer, THERE, 1.0, 6) is None


@pytest.mark.parametrize("light", [0.35, 0.5, 0.7, 1.0])
def test_a_ball_in_the_shade_is_found_within_three_pictures(color: ms.ColorModel, light: float) -> None:
    localizer = ms.Localizer(CAMERA, ms.BallTarget(2.0 * RADIUS))
    lights = in_lights(color, AssociationParameters().shade)
    pictures = [room(NEXT, light=light, index=index) for index in range(3)]
    found = [find_neighbor_ball(picture, lights, localizer, THERE, 1.0, 6) for picture in pictures]
    balls = [ball for ball in found if ball is not None]
    assert balls
    for ball in balls:
        np.testing.assert_allclose((ball.x, ball.y), CAMERA.project(np.array([NEXT]))[0], atol=1.0)


@pytest.mark.parametrize("shade", [0.0, -0.5, 1.5, math.nan])
def test_a_shade_is_a_share_of_the_light(shade: float) -> None:
    with pytest.raises(ValueError, match="shade must be"):
        AssociationParameters(shade=shade)
