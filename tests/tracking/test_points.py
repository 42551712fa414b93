"""Any number of lines works at any radius: many lines on a small outline read the same pixels, and count once."""

from functools import cache
from itertools import product

import numpy as np
import pytest
from scenes import FPS, with_ball

import matchset as ms
from matchset.sim.analog_link import PRESETS, degrade

FRAMES = 8
SEEDS = 11, 12


@cache
def clip(radius: float, seed: int) -> list[tuple[ms.Frame, tuple[float, float, float]]]:
    """A disc that moves a little, over a typical analog link."""
    rng, size = np.random.default_rng(seed), int(max(160, 3 * radius))
    background = (
        rng.integers(110, 170, (size // 8 + 1, size // 6 + 1, 3)).repeat(8, 0).repeat(8, 1)[:size, : size * 4 // 3]
    )
    frames = []
    for index in range(FRAMES):
        ball = size * 2 / 3 + 0.7 * index + rng.uniform(-0.2, 0.2), size / 2 - 0.4 * index, radius
        picture = degrade(with_ball(background.astype(np.uint8), *ball), PRESETS["typical"], 100 * seed + index)
        frames.append((ms.Frame(picture, index / FPS, index), ball))
    return frames


@cache
def follow(radius: float, points: int) -> tuple[float, float, float]:
    """Share of the frames in which it is found, root mean square error, px, and mean normalized error squared."""
    errors, squares, count = [], [], 0
    for seed in SEEDS:
        frames = clip(radius, seed)
        tracker = ms.Tracker(ms.Circle, ms.ColorModel.hsv((95, 60, 20), (125, 255, 255)), points=points)
        tracker.restart(frames[0][1][:2])
        for frame, ball in frames:
            track, count = tracker.update(frame), count + 1
            if isinstance(track, ms.Track):
                error = np.array((track.shape.x, track.shape.y, track.shape.radius)) - ball
                errors.append(error)
                squares.append(error @ np.linalg.solve(track.covariance, error) / 3.0)
    return len(errors) / count, float(np.sqrt(np.mean(np.square(errors)))), float(np.mean(squares))


@pytest.mark.parametrize(
    ("points", "radius"),
    [*product((16, 4096), (8.0, 15.0, 30.0, 100.0)), *product((128, 800, 1024), (15.0,))],
)
def test_any_number_of_lines_works(points: int, radius: float) -> None:
    found, error, square = follow(radius, points)
    usual = follow(radius, 64)
    assert found == usual[0] == 1.0
    assert error < 1.4 * usual[1] + (0.05 if points < 64 else 0.0)
    assert square < max(2.5, 1.5 * usual[2])
