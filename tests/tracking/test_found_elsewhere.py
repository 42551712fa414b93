"""A ball before boards and spots: it leaps and is found again, nothing else is; `detect` finds one of two colors."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.parameters import TrackerParameters

Picture = npt.NDArray[np.uint8]
SIZE = (240, 360)
GREEN = (70.0, 150.0, 60.0)
UNUSED = TrackerParameters(asks_network=False)


def picture(
    at: tuple[float, float] | None, radius: float = 9.0, color: tuple[float, ...] = GREEN, seed: int = 0
) -> Picture:
    """A ball before a wall with dark boards and pale spots, in any light."""
    rows, columns = np.indices(SIZE)
    image = np.full((*SIZE, 3), (150.0, 145.0, 140.0)) + columns[:, :, np.newaxis] * 0.1
    image[:, 40:70] = (60.0, 70.0, 80.0)
    image[np.hypot(columns - 300, rows - 40) < 8.0] = (210.0, 210.0, 215.0)
    if at is not None:
        away = np.hypot(columns - at[0], rows - at[1])
        share = np.clip(radius + 0.5 - away, 0.0, 1.0)[..., np.newaxis]
        shade = (1.0 - 0.4 * np.clip((rows - at[1]) / radius, -1.0, 1.0))[..., np.newaxis]
        image = image * (1.0 - share) + np.array(color) * shade * share
    soft = cv2.GaussianBlur(image, (0, 0), 0.8)
    return np.asarray(np.clip(soft + np.random.default_rng(seed).normal(0.0, 3.0, soft.shape), 0, 255), np.uint8)


def follow(shown: list[Picture], begin: tuple[float, float], limits: TrackerParameters | None) -> list[float | None]:
    """Where a ball is seen along x, picture by picture."""
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(shown[0], *begin), start=begin, parameters=limits)
    answers = [tracker.update(image) for image in shown]
    return [answer.shape.x if isinstance(answer, ms.Track) else None for answer in answers]


def test_a_ball_that_leaps_and_changes_its_light_is_found_again() -> None:
    shown = [picture((120.0, 120.0), seed=k) for k in range(6)]
    dark = (47.0, 92.0, 44.0)
    shown += [picture((160.0 + 30.0 * k, 120.0 - 12.0 * k), color=dark, seed=9 + k) for k in range(5)]
    found = follow(shown, (120.0, 120.0), None)
    assert [x for x in found[8:] if x is None] == []
    assert found[8:] == pytest.approx([160.0 + 30.0 * k for k in (2, 3, 4)], abs=3.0)


def test_nothing_is_found_where_no_ball_is() -> None:
    shown = [picture((120.0, 120.0) if k < 6 else None, seed=k) for k in range(30)]
    assert [x for x in follow(shown, (120.0, 120.0), None)[6:] if x is not None] == []


def test_a_network_that_is_not_used_finds_nothing() -> None:
    shown = [picture((120.0, 120.0), seed=k) for k in range(6)]
    shown.append(picture((290.0, 150.0), color=(200.0, 60.0, 60.0)))
    assert follow(shown, (120.0, 120.0), UNUSED)[6] is None


@pytest.mark.parametrize("at", [(90.0, 60.0), (250.0, 170.0)])
def test_a_ball_of_two_colors_is_detected_with_the_color_of_another_picture(at: tuple[float, float]) -> None:
    def half_white(place: tuple[float, float], seed: int) -> Picture:
        image = picture(place, 12.0, seed=seed).astype(np.float64)
        rows, columns = np.indices(SIZE)
        cap = (np.hypot(columns - place[0], rows - place[1]) < 11.0) & (rows < place[1] - 4.0)
        image[cap] = (200.0, 205.0, 200.0)
        return np.asarray(cv2.GaussianBlur(image, (0, 0), 0.8), np.uint8)

    color = ms.ColorModel.pick(half_white((180.0, 120.0), 1), 180.0, 124.0)
    found = ms.detect(half_white(at, 2), ms.Circle, color)
    assert math.dist((found[0].shape.x, found[0].shape.y), at) < 3.0
    assert found[0].shape.radius == pytest.approx(12.0, abs=3.0)
    assert np.linalg.eigvalsh(found[0].covariance).min() > 0.0
    assert ms.detect(picture(None, seed=3), ms.Circle, color) == []


def test_a_searched_place_without_a_ball_is_not_followed() -> None:
    limits = NetworkParameters()
    assert limits.search.hopeless < 0.0
    assert math.isinf(limits.follow.hopeless)
    assert msgspec.structs.replace(limits.search, hopeless=-math.inf) == limits.follow
