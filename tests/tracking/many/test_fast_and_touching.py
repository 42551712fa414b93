"""Balls that are fast from the first, or before equal ones, keep their names and their sizes."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.tracking.many.searching.disc_search import DiscSearch, Sought

Image = npt.NDArray[np.uint8]
BLUE, PLAIN = (210, 90, 30), (90, 110, 120)
RADIUS = 18
SHIFT = 4  # OpenCV draws in sixteenths of a pixel


def picture(*balls: tuple[float, float], seed: int = 0) -> Image:
    """Draw balls, those named first behind the others, each with a darker rim."""
    image = (np.random.default_rng(seed).normal(0.0, 3.0, (240, 480, 3)) + PLAIN).clip(0, 255).astype(np.uint8)
    for x, y in balls:
        center = round(x * 2**SHIFT), round(y * 2**SHIFT)
        for radius, light in ((RADIUS, 0.7), (RADIUS - 4, 1.0)):
            color = tuple(light * each for each in BLUE)
            cv2.circle(image, center, radius * 2**SHIFT, color, cv2.FILLED, cv2.LINE_AA, SHIFT)
    return np.asarray(cv2.GaussianBlur(image, (0, 0), 0.8), np.uint8)


def seen(targets: list[ms.Target[ms.Circle]]) -> dict[int, ms.Circle]:
    return {each.identity: each.track.shape for each in targets if isinstance(each.track, ms.Track)}


def test_balls_that_fly_two_radii_a_picture_from_the_first_have_one_name_each() -> None:
    rows = 40.0, 120.0, 200.0
    pictures = [
        picture(*((40.0 + 36.0 * k, rows[0]), (440.0 - 36.0 * k, rows[1]), (40.0 + 36.0 * k, rows[2])), seed=k)
        for k in range(11)
    ]
    tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(pictures[0], 40.0, rows[0]))
    names = dict[float, set[int]]()
    for image in pictures:
        for identity, ball in seen(tracker.update(image)).items():
            names.setdefault(min(rows, key=lambda row: abs(row - ball.y)), set()).add(identity)
    assert [len(names[row]) for row in rows] == [1, 1, 1]


def test_a_ball_that_passes_before_an_equal_one_is_as_large_as_it_is_but_for_a_few_pictures() -> None:
    tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(picture((100.0, 120.0), (380.0, 124.0)), 100.0, 120.0))
    radii = list[float]()
    for k in range(70):
        back, front = (240.0, 124.0), (100.0 + 4.0 * k, 120.0)
        targets = seen(tracker.update(picture(back, front, seed=k)))
        radii += [ball.radius for ball in targets.values() if abs(ball.x - front[0]) < 0.5 * RADIUS]
    assert len(radii) > 60
    assert sum(abs(radius / RADIUS - 1.0) > 0.1 for radius in radii) <= 5
    assert max(radii) < 1.25 * RADIUS


def test_a_ball_that_has_left_the_picture_is_not_searched_for_in_every_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    searches = list[int]()
    search = DiscSearch.update

    def counted(self: DiscSearch, frame: ms.Frame, sought: Sought) -> list[ms.Track[Any]]:
        searches.append(1)
        return search(self, frame, sought)

    monkeypatch.setattr(DiscSearch, "update", counted)
    tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(picture((100.0, 120.0)), 100.0, 120.0))
    for k in range(20):
        tracker.update(picture((100.0, 60.0), (400.0 + 8.0 * k, 120.0), seed=k))
    searches.clear()
    for k in range(20):
        tracker.update(picture((100.0, 60.0), seed=k))
    assert len(searches) < 10


def test_a_ball_that_comes_in_after_long_quiet_is_followed_before_it_has_crossed_the_picture() -> None:
    tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(picture((100.0, 120.0)), 100.0, 120.0))
    for k in range(100):
        tracker.update(picture((100.0, 60.0), seed=k))
    for k in range(12):
        targets = seen(tracker.update(picture((100.0, 60.0), (470.0 - 8.0 * k, 160.0), seed=k)))
    assert len(targets) == 2
