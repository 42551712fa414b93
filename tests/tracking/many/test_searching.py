"""What nobody follows yet is found in the whole picture, and what is left out is said by number."""

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import matchset as ms
from matchset.tracking.many.searching.unexplained import unexplained

Image = npt.NDArray[np.uint8]
BLUE, GREEN, PLAIN = (210, 90, 30), (60, 190, 40), (90, 110, 120)
RADIUS = 18


def picture(*balls: tuple[int, int], color: tuple[int, int, int] = BLUE, seed: int = 0) -> Image:
    image = np.random.default_rng(seed).normal(0.0, 3.0, (240, 320, 3)) + PLAIN
    for x, y in balls:
        cv2.circle(image, (x, y), RADIUS, color, cv2.FILLED, cv2.LINE_AA)
    return np.asarray(cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.8), np.uint8)


def color_of(image: Image, x: int, y: int) -> ms.ColorModel:
    return ms.ColorModel.pick(image, x, y)


def seen_at(targets: list[ms.Target[ms.Circle]]) -> list[tuple[int, int]]:
    shapes = [each.track.shape for each in targets if isinstance(each.track, ms.Track)]
    return sorted((round(shape.x), round(shape.y)) for shape in shapes)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 1000),
    step=st.integers(1, 9),
    channels=st.sampled_from((1, 3)),
    circles=st.lists(st.tuples(st.floats(-10, 50), st.floats(-10, 40), st.floats(0, 20)), max_size=4),
)
def test_unexplained_color_is_counted_as_in_plain_sight(
    seed: int, step: int, channels: int, circles: list[tuple[float, float, float]]
) -> None:
    random = np.random.default_rng(seed)
    image = random.integers(0, 256, (30, 40, channels), np.uint8)
    color = ms.ColorModel(random.normal(size=32768 if channels == 3 else 256).astype(np.float32))
    rows, columns = np.mgrid[step // 2 : 30 : step, step // 2 : 40 : step]
    colored = color.scores(image if channels == 3 else image[:, :, 0])[rows, columns] > 0
    for x, y, radius in circles:
        colored &= ~((columns - x) ** 2 + (rows - y) ** 2 < radius * radius)
    assert unexplained(image, color, np.array(circles, np.float64).reshape(-1, 3), step) == colored.sum()


def test_all_in_the_first_picture_are_answered_in_the_second() -> None:
    places = [(40, 60), (100, 60), (137, 60), (200, 180), (280, 40)]
    tracker = ms.MultiTracker(ms.Circle, color_of(picture(*places), 40, 60))
    tracker.update(picture(*places))
    assert seen_at(tracker.update(picture(*places, seed=1))) == sorted(places)


def test_one_that_appears_is_answered_within_two_pictures() -> None:
    tracker = ms.MultiTracker(ms.Circle, color_of(picture((40, 60)), 40, 60))
    for k in range(20):
        tracker.update(picture((40, 60), seed=k))
    tracker.update(picture((40, 60), (230, 150), seed=20))
    assert seen_at(tracker.update(picture((40, 60), (230, 150), seed=21))) == [(40, 60), (230, 150)]


def test_what_is_left_out_is_said_by_number() -> None:
    places = [(40 + 60 * k, 60 + 90 * row) for k in range(5) for row in range(2)]
    tracker = ms.MultiTracker(ms.Circle, color_of(picture(*places), 40, 60), most=4)
    targets = tracker.update(picture(*places))
    assert tracker.left_out == len(places) - 4
    assert len(targets) <= 4


@pytest.mark.parametrize("color", [BLUE, PLAIN])
def test_none_and_a_picture_full_of_the_color_are_no_balls(color: tuple[int, int, int]) -> None:
    tracker = ms.MultiTracker(ms.Circle, color_of(picture((160, 120)), 160, 120))
    for k in range(8):
        assert not tracker.update(np.full((240, 320, 3), color, np.uint8) + np.uint8(k % 2))
    assert tracker.left_out == 0


def test_doubtful_ones_of_every_color_are_told() -> None:
    both = picture((80, 120))
    both[:, 160:] = picture((240, 120), color=GREEN)[:, 160:]
    colors = {"blue": color_of(both, 80, 120), "green": color_of(both, 240, 120)}
    tracker = ms.MultiTracker(ms.Circle, colors)
    tracker.update(both)
    (blue, green) = tracker._observer.searches._discs.values()
    blue.doubtful, green.doubtful = [tracker_track(80)], [tracker_track(240)]
    assert [each.shape.x for each in tracker.doubtful] == [80.0, 240.0]


def tracker_track(x: float) -> ms.Track[ms.Circle]:
    return ms.Track(ms.Circle(x, 120.0, 18.0), np.eye(3), 0.5, np.zeros((0, 2)), 0.0)
