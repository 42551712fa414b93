"""The size of a followed ball changes as a ball's can, whatever of its color comes near its rim."""

import numpy as np
import pytest
from scenes import BLUE, Answer, Picture, at, blue, off, wall, with_ball

import matchset as ms
from matchset.tracking.parameters import IN_FLIGHT

X, Y, RADIUS = 150.0, 120.0, 30.0
RING, WIDTH = 36.0, 2.0


def with_ring(image: Picture, x: float, y: float) -> Picture:
    """The picture with a thin ring of the ball's color, as a hoop on the wall behind it."""
    rows, columns = np.indices(image.shape[:2])
    cover = np.clip(WIDTH - np.abs(np.hypot(columns - x, rows - y) - RING) + 0.5, 0.0, 1.0)[:, :, np.newaxis]
    mixed: Picture = np.rint(image + cover * (np.array(BLUE) - image)).astype(np.uint8)
    return mixed


def test_in_flight_a_ball_comes_free_of_a_ring_of_its_color_around_it() -> None:
    tracker = ms.Tracker(ms.Circle, blue(), parameters=IN_FLIGHT)
    tracker.start(ms.Circle(X - 45.0, Y, RADIUS))
    for index in range(60):
        x = X + 1.5 * (index - 30)
        answer = tracker.update(at(with_ball(with_ring(wall(index), X, Y), x, Y, RADIUS), index))
        assert isinstance(answer, ms.Track)
        assert answer.shape.radius < 1.15 * RADIUS  # the ring's is 1.27 of it
        if not 24 < index < 37:
            assert off(answer, (x, Y, RADIUS)) < 1.0


@pytest.mark.parametrize("growth", [1.05, 1.1, 1.15])
def test_a_ball_thrown_at_the_camera_is_followed(growth: float) -> None:
    tracker = ms.Tracker(ms.Circle, blue())
    answers: list[Answer] = []
    for index in range(20):
        radius = 12.0 * growth ** max(index - 8, 0)
        answers.append(tracker.update(at(with_ball(wall(index), X, Y, radius), index)))
        assert off(answers[-1], (X, Y, radius)) < 0.03 * radius + 0.5
