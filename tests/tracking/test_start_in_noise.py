"""A tracker that is started at a shape, in pictures of noise: nothing is found by chance."""

import numpy as np
import pytest

import matchset as ms
from matchset.tracking.initialization import InitializationParameters, noise_in

LIMITS = InitializationParameters()


def blue_on_gray() -> ms.ColorModel:
    rows, columns = np.indices((120, 160))
    image = np.full((120, 160, 3), 120, np.uint8)
    image[np.hypot(columns - 80, rows - 60) < 25] = (190, 70, 30)
    return ms.ColorModel.pick(image, 80, 60)


@pytest.mark.parametrize("radius", [4.5, 6.0, 12.0])
def test_chance_is_no_ball(radius: float) -> None:
    rng = np.random.default_rng(11)
    tracker = ms.Tracker(ms.Circle, blue_on_gray())
    for _ in range(60):
        x, y = rng.uniform(10.0, 150.0), rng.uniform(10.0, 110.0)
        tracker.restart(ms.Circle(x, y, radius))
        for index in range(3):
            noise = rng.integers(0, 256, (120, 160, 3), dtype=np.uint8)
            assert isinstance(tracker.update(ms.Frame(noise, index / 30.0, index)), ms.Lost)


def test_noise_is_measured_around_a_box() -> None:
    rng = np.random.default_rng(12)
    image = np.clip(120.0 + 9.0 * rng.standard_normal((80, 90, 3)), 0, 255).astype(np.uint8)
    assert noise_in(image, (20.0, 20.0, 60.0, 60.0), LIMITS) == pytest.approx(9.0, rel=0.1)
    assert noise_in(image[:, :, :1], (20.0, 20.0, 60.0, 60.0), LIMITS) == pytest.approx(9.0, rel=0.1)


@pytest.mark.parametrize("box", [(-50.0, -50.0, -20.0, -20.0), (200.0, 10.0, 220.0, 30.0), (0.0, 300.0, 9.0, 310.0)])
def test_outside_of_the_picture_there_is_none(box: tuple[float, float, float, float]) -> None:
    assert noise_in(np.zeros((80, 90, 3), np.uint8), box, LIMITS) == 0.0
