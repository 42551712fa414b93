"""The streak of a fast ball at a click: what it is, and what is none."""

import math
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import matchset as ms
from matchset.tracking.ball.streak import StreakParameters, streak_at

Image = npt.NDArray[np.uint8]
RED, GRAY = (40, 40, 210), (90, 100, 95)
LIMITS = StreakParameters()


def color() -> ms.ColorModel:
    image = np.full((80, 80, 3), GRAY, np.uint8)
    cv2.circle(image, (40, 40), 15, RED, -1)
    return ms.ColorModel.pick(image, 40, 40)


COLOR = color()


def streak(x: float, y: float, radius: float, length: float, angle: float = 0.0, seed: int = 0) -> Image:
    """Picture of a bar with round ends."""
    rows, columns = np.indices((240, 320), np.float32)
    along = (columns - x) * math.cos(angle) + (rows - y) * math.sin(angle)
    across = -(columns - x) * math.sin(angle) + (rows - y) * math.cos(angle)
    beyond = np.maximum(np.abs(along) - 0.5 * length, 0.0)
    return noisy(np.clip(radius + 0.5 - np.hypot(beyond, across), 0.0, 1.0), seed)


def exposed(x: float, y: float, radius: float, way: tuple[float, float], seed: int = 0) -> Image:
    """Picture of a ball that flies some way while the shutter is open."""
    rows, columns = np.indices((240, 320), np.float32)
    places = [(x + share * way[0], y + share * way[1]) for share in np.linspace(-0.5, 0.5, 21)]
    discs = [np.clip(radius + 0.5 - np.hypot(columns - u, rows - v), 0.0, 1.0) for u, v in places]
    return noisy(np.mean(discs, axis=0), seed)


def noisy(share: npt.NDArray[np.floating[Any]], seed: int) -> Image:
    """Red by a share of each pixel, and noise."""
    clean = (1.0 - share[..., np.newaxis]) * GRAY + share[..., np.newaxis] * RED
    noise = np.random.default_rng(seed).normal(0.0, 3.0, clean.shape)
    return np.clip(clean + noise, 0.0, 255.0).astype(np.uint8)


@settings(max_examples=40, deadline=None)
@given(st.floats(4.0, 12.0), st.floats(3.0, 6.0), st.floats(0.0, math.pi), st.floats(-2.0, 2.0), st.integers(0, 1000))
def test_a_streak_is_its_ball_in_the_middle(radius: float, long: float, angle: float, off: float, seed: int) -> None:
    x, y, length = 160.0 + off, 120.0 - off, long * radius
    image = streak(x, y, radius, length, angle, seed)
    found = streak_at(image, COLOR, (160.0, 120.0, 2.0 * radius), LIMITS)
    assert found is not None
    assert math.dist(found.circle[:2], (x, y)) < 1.0
    assert abs(found.circle[2] - radius) < 0.15 * radius + 1.0
    assert abs(found.way - length - 1.6 * radius) < 0.3 * radius + 2.0  # it has round ends


def ragged() -> Image:
    image = np.full((240, 320, 3), GRAY, np.uint8)
    image[115:125, 130:190] = RED
    image[90:120, 130:136] = RED
    return image


@pytest.mark.parametrize(
    "image",
    [
        streak(160.0, 120.0, 10.0, 0.0),  # a disc
        streak(160.0, 120.0, 10.0, 8.0),  # moved by less than its radius
        streak(160.0, 120.0, 6.0, 200.0),  # ends farther away than a ball's streak
        streak(160.0, 60.0, 6.0, 30.0),  # is not where the click was
        ragged(),
        np.full((240, 320, 3), GRAY, np.uint8),
        np.full((240, 320, 3), RED, np.uint8),
    ],
    ids=["disc", "short", "long", "elsewhere", "angle iron", "nothing", "everything"],
)
def test_what_is_no_streak(image: Image) -> None:
    assert streak_at(image, COLOR, (160.0, 120.0, 12.0), LIMITS) is None


def test_a_speck_of_the_color_in_a_large_ball_is_none() -> None:
    assert streak_at(streak(160.0, 120.0, 2.0, 8.0), COLOR, (160.0, 120.0, 60.0), LIMITS) is None


@pytest.mark.parametrize("circle", [(-40.0, -40.0, 3.0), (400.0, 120.0, 9.0), (319.0, 239.0, 1.0), (0.0, 0.0, 0.0)])
def test_a_click_at_or_beyond_the_border_finds_none(circle: tuple[float, float, float]) -> None:
    assert streak_at(streak(160.0, 120.0, 6.0, 30.0), COLOR, circle, LIMITS) is None


def test_a_ball_that_was_clicked_in_flight_is_followed() -> None:
    places = [(60.0 + 30.0 * k, 120.0 + 6.0 * k) for k in range(8)]
    pictures = [exposed(x, y, 5.0, (20.0, 4.0), seed=k) for k, (x, y) in enumerate(places)]
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(pictures[0], *places[0]), start=places[0])
    answers = [tracker.update(picture) for picture in pictures]
    near = [
        isinstance(answer, ms.Track) and math.dist((answer.shape.x, answer.shape.y), place) < 6.0
        for answer, place in zip(answers, places, strict=True)
    ]
    assert near[0]
    assert sum(near) >= 6
    assert near[-1]


def test_a_bar_that_stands_still_is_not_followed() -> None:
    pictures = [streak(160.0, 120.0, 6.0, 30.0, seed=k) for k in range(12)]
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(pictures[0], 160, 120), start=(160, 120))
    answers = [tracker.update(picture) for picture in pictures]
    assert not any(answers[1:])
