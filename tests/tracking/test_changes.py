"""What has moved since a ball was seen: areas and centers of arrivals, cameras that move, and look-alikes at rest."""

import math

import cv2
import numpy as np
import pytest
from scenes import BLUE, Picture, blue, with_ball

from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.places.changes import (
    Arrival,
    ChangeParameters,
    PictureChanges,
    Reference,
    arrivals,
    changes_since,
    reference_of,
    share_before,
)

LIMITS = ChangeParameters()
COLOR = blue()
PIXEL = np.array(BLUE, np.float32)
BEGIN = 60.0, 60.0, 8.0


def room(left: int = 0, top: int = 0) -> Picture:
    """Part of a large gray wall with many boards on it, from a pixel on."""
    random = np.random.default_rng(4)
    wall = np.full((400, 500, 3), 140, np.uint8)
    for _ in range(200):
        x, y, width, height = random.integers((0, 0, 8, 8), (490, 390, 30, 30)).tolist()
        wall[y : y + height, x : x + width] = int(random.integers(90, 190))
    return np.ascontiguousarray(wall[top : top + 240, left : left + 320])


def shown(*balls: Circle3, left: int = 0, top: int = 0) -> Picture:
    image = room(left, top)
    for ball in balls:
        image = with_ball(image, *ball)
    return image


def streak(ball: Circle3, way: tuple[float, float], blur: float = 0.0) -> Picture:
    """A ball that moves by a way while the picture is taken, and is out of focus."""
    rows, columns = np.indices((240, 320), np.float64)
    along = np.linspace(-0.5, 0.5, 65)
    covers = [
        np.clip(ball[2] - np.hypot(columns - ball[0] - part * way[0], rows - ball[1] - part * way[1]) + 0.5, 0.0, 1.0)
        for part in along
    ]
    cover = np.mean(covers, axis=0)
    soft = cv2.GaussianBlur(cover, (0, 0), blur) if blur else cover
    image = room()
    mixed = image + soft[:, :, np.newaxis] * (PIXEL - image)
    return np.asarray(np.rint(mixed), np.uint8)


def reference(*balls: Circle3) -> Reference:
    """Reference with the ball, the first of some."""
    return reference_of(shown(*balls), balls[0], 0.0, LIMITS)


def changes(image: Picture, before: Reference) -> PictureChanges:
    found = changes_since(image, before, LIMITS)
    assert found is not None
    return found


def arrived(image: Picture, radius: float = BEGIN[2]) -> list[Arrival]:
    before = reference((*BEGIN[:2], radius))
    return arrivals(changes(image, before), PIXEL, radius, LIMITS)


def share(image: Picture, before: Reference, circle: Circle3, *, moved: bool = True) -> float:
    return share_before(changes(image, before), (COLOR, PIXEL), circle, LIMITS, moved=moved)


@pytest.mark.parametrize("blur", [0.0, 1.5, 3.0])
@pytest.mark.parametrize("way", [(0.0, 0.0), (14.0, 0.0), (-12.0, 20.0)])
@pytest.mark.parametrize("radius", [6.0, 8.0, 14.0])
def test_an_arrival_has_the_area_and_the_center_of_the_ball_whatever_its_blur(
    radius: float, way: tuple[float, float], blur: float
) -> None:
    (arrival,) = arrived(streak((200.3, 150.6, radius), way, blur), radius)
    assert (arrival.x, arrival.y) == pytest.approx((200.3, 150.6), abs=0.15 * radius)
    assert arrival.radius == pytest.approx(radius, rel=0.15)


def test_nothing_arrives_where_the_ball_rests_or_only_leaves() -> None:
    assert arrived(shown(BEGIN)) == []
    assert arrived(shown()) == []


def test_another_color_does_not_arrive_nor_does_another_mass() -> None:
    orange = 30, 120, 230
    assert arrived(with_ball(room(), 200.0, 150.0, 8.0, orange)) == []
    for factor in (1.1 * LIMITS.growth, 0.9 / LIMITS.growth):
        assert arrived(shown((200.0, 150.0, factor * 8.0))) == []


def test_of_several_the_likeliest_mass_comes_first() -> None:
    found = arrived(shown((200.0, 150.0, 12.0), (100.0, 180.0, 8.2), (250.0, 60.0, 6.0)))
    assert [round(each.x, -1) for each in found] == [100.0, 250.0, 200.0]


def test_a_still_camera_sees_no_changes() -> None:
    assert changes(shown(BEGIN), reference(BEGIN)).share == 0.0


@pytest.mark.parametrize("moved", [(12, 0), (0, 8), (20, 12), (28, 24)])
def test_a_camera_that_moves_by_whole_pixels_leaves_no_changes(moved: tuple[int, int]) -> None:
    left, top = moved
    before = reference(BEGIN)
    ball = BEGIN[0] - left, BEGIN[1] - top, BEGIN[2]
    seen = changes(shown(ball, left=left, top=top), before)
    inside = seen.changed[: (240 - top) // 4 - 1, : (320 - left) // 4 - 1]
    assert np.count_nonzero(inside) < 0.02 * inside.size
    assert seen.share < 0.5 * LIMITS.moved_share
    assert seen.reference.circle == pytest.approx(ball, abs=1.0)


def test_a_ball_is_seen_to_arrive_while_the_camera_moves() -> None:
    image = shown((200.0, 150.0, 8.0), left=20, top=12)
    found = arrivals(changes(image, reference(BEGIN)), PIXEL, 8.0, LIMITS)
    assert any(math.dist(each[:2], (200.0, 150.0)) < 2.0 and abs(each.radius - 8.0) < 1.5 for each in found)


def test_light_that_changes_everything_says_nothing() -> None:
    columns = np.indices((240, 320))[1]
    for side in (columns < 135, columns > 185):  # a lamp on one side
        lit = np.clip(shown(BEGIN).astype(np.int64) + 60 * side[:, :, np.newaxis], 0, 255).astype(np.uint8)
        assert changes_since(lit, reference(BEGIN), LIMITS) is None


def test_a_look_alike_at_rest_was_there_before_and_an_arrived_ball_was_not() -> None:
    rest, new = (240.0, 60.0, 8.0), (200.0, 150.0, 8.0)
    before, image = reference(BEGIN, rest), shown(new, rest)
    for moved in (True, False):
        assert share(image, before, rest, moved=moved) > 0.9
        assert share(image, before, new, moved=moved) < 0.1


def test_the_place_of_the_ball_itself_does_not_count() -> None:
    before = reference(BEGIN)
    assert share(shown(BEGIN), before, BEGIN) < 0.1
    near = BEGIN[0] + 6.0, BEGIN[1], BEGIN[2]
    assert share(shown(near), before, near) < 0.2


def test_a_look_alike_that_has_moved_a_little_counts_only_if_it_is_asked_for() -> None:
    rest, moved = (240.0, 60.0, 8.0), (248.0, 60.0, 8.0)
    before, image = reference(BEGIN, rest), shown(moved)
    assert share(image, before, moved) > 0.9
    assert share(image, before, moved, moved=False) < share(image, before, moved)


def test_what_has_not_changed_though_a_ball_would_have_changed_it_was_there_before() -> None:
    assert share(shown(BEGIN), reference(BEGIN), (200.0, 150.0, 8.0)) > 0.9


def test_outside_of_the_picture_nothing_was_there() -> None:
    assert share(shown(BEGIN), reference(BEGIN), (900.0, 900.0, 8.0)) == 0.0
