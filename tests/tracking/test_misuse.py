"""Misuse is a ValueError with the value in its text, and the tracker goes on after it as if nothing had been."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scenes import HEIGHT, WIDTH, at, blue, off, run, scene, wall

import matchset as ms

BALL = (150.0, 110.0, 30.0)
GRAY = ms.ColorModel(np.linspace(-4.0, 4.0, 256, dtype=np.float32))


@pytest.fixture
def tracker() -> ms.Tracker[ms.Circle]:
    tracker = ms.Tracker(ms.Circle, blue())
    run(tracker, [scene(BALL)] * 3)
    return tracker


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        (lambda: ms.Frame(scene(BALL), 0.05, 7), r"frame 7 is at 0.05 s, the one before at 0.06"),
        (lambda: ms.Frame(scene(BALL), 2 / 30.0, 7), r"frame 7 is at 0.066"),
        (lambda: ms.Frame(scene(BALL)[1:], 1.0, 8), rf"frame 8 has shape \({HEIGHT - 1}, {WIDTH}, 3\)"),
        (lambda: ms.Frame(scene(BALL)[:, :, 0], 1.0, 9), rf"frame 9 has shape \({HEIGHT}, {WIDTH}\)"),
    ],
    ids=["backward time", "the same time", "another size", "other channels"],
)
def test_a_frame_that_does_not_fit_those_before(
    tracker: ms.Tracker[ms.Circle], frame: Callable[[], ms.Frame], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        tracker.update(frame())
    assert off(tracker.update(at(scene(BALL), 3)), BALL) < 0.5


@pytest.mark.parametrize("time", [math.nan, math.inf, -math.inf])
def test_a_frame_needs_a_time(time: float) -> None:
    with pytest.raises(ValueError, match=rf"frame 4 must be finite, got {time}"):
        ms.Frame(wall(), time, 4)


@pytest.mark.parametrize(
    ("image", "words"),
    [
        (np.zeros((4, 5, 3)), "float64"),
        (np.zeros((4, 5, 3), np.int8), "int8"),
        (np.zeros((4, 5, 4), np.uint8), r"\(4, 5, 4\)"),
        (np.zeros((4, 5, 1), np.uint8), r"\(4, 5, 1\)"),
        (np.zeros(20, np.uint8), r"\(20,\)"),
        (np.zeros((0, 5, 3), np.uint8), r"\(0, 5, 3\)"),
        ([[1, 2], [3, 4]], "list"),
        (None, "NoneType"),
    ],
)
def test_a_picture_is_bytes_of_bgr_or_gray(image: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        ms.Frame(image)  # type: ignore[arg-type]


def test_a_model_of_another_kind_of_picture() -> None:
    for color, image, words in (
        (GRAY, wall(), "learned on gray pictures, this one is color"),
        (blue(), wall()[:, :, 0], "learned on color pictures, this one is gray"),
    ):
        with pytest.raises(ValueError, match=words):
            ms.Tracker(ms.Circle, color).update(at(image, 0))
        with pytest.raises(ValueError, match=words):
            ms.detect(at(image, 0), ms.Circle, color)
        with pytest.raises(ValueError, match=words):
            color.mask(image)


def test_a_refused_first_frame_does_not_decide_the_kind() -> None:
    tracker = ms.Tracker(ms.Circle, blue())
    with pytest.raises(ValueError, match="gray"):
        tracker.update(at(wall()[:, :, 0], 0))
    assert tracker.update(at(scene(BALL), 0))


@pytest.mark.parametrize("points", [0, 15, 4097, -1])
def test_points_out_of_range(points: int) -> None:
    with pytest.raises(ValueError, match=f"got {points}"):
        ms.Tracker(ms.Circle, blue(), points=points)


@pytest.mark.parametrize("points", [16, 4096])
def test_points_at_the_ends_of_the_range(points: int) -> None:
    (answer,) = run(ms.Tracker(ms.Circle, blue(), points=points), [scene(BALL)])
    assert off(answer, BALL) < 1.0


@pytest.mark.parametrize("start", [(math.nan, 3.0), (3.0, math.inf)])
def test_a_start_point_must_be_finite(start: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"nan|inf"):
        ms.Tracker(ms.Circle, blue(), start=start)


def test_a_start_of_another_family(tracker: ms.Tracker[ms.Circle]) -> None:
    with pytest.raises(ValueError, match=r"follows Circle, got \(1, 2, 3\)"):
        tracker.start((1, 2, 3))  # type: ignore[arg-type]


def test_a_limit_of_nothing() -> None:
    with pytest.raises(ValueError, match="got 0"):
        ms.detect(at(wall(), 0), ms.Circle, blue(), limit=0)


@pytest.mark.parametrize(
    "numbers", [(math.nan, 0.0, 1.0), (0.0, math.inf, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, -2.0), (0.0, 0.0, math.inf)]
)
def test_a_circle_needs_finite_numbers_and_a_radius(numbers: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match=r"Circle\(x="):
        ms.Circle(*numbers)
