"""A ball of which a part is hidden all the time: the outline is that of the ball, not of what is seen of it."""

import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms

Picture = npt.NDArray[np.uint8]
RADIUS = 40.0


def frame(index: int, cut: float, seed: int) -> tuple[Picture, float, float]:
    """A shaded yellow ball on a tube before leaves, its lower part behind the tube; noisy and blurred a little."""
    rng = np.random.default_rng((seed, index))
    rows, columns = np.indices((220, 320)).astype(np.float64)
    x, y = 90.0 + 3.0 * index, 100.0
    leaves = np.random.default_rng(seed).integers(0, 70, (28, 40, 3)).repeat(8, 0).repeat(8, 1)[:220, :320]
    image = leaves + np.array((5.0, 30.0, 20.0))
    u, v = (columns - x) / RADIUS, (rows - y) / RADIUS
    light = np.clip(0.75 - 0.35 * v - 0.2 * u, 0.3, 1.0)[..., np.newaxis]
    image = np.where((u * u + v * v <= 1.0)[..., np.newaxis], light * np.array((40.0, 210.0, 235.0)), image)
    image = np.where((v > cut)[..., np.newaxis], np.array((60.0, 40.0, 150.0)), image)
    soft = 0.25 * (image + np.roll(image, 1, 0) + np.roll(image, 1, 1) + np.roll(np.roll(image, 1, 0), 1, 1))
    return np.clip(soft + rng.normal(0.0, 3.0, image.shape), 0, 255).astype(np.uint8), x + 0.5, y + 0.5


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("cut", [0.3, 0.4, 0.55])
def test_a_ball_that_is_cut_below_keeps_its_size(cut: float, seed: int) -> None:
    image, x, y = frame(0, cut, seed)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, x, y - 10.0), start=(x, y - 10.0))
    errors = []
    for index in range(30):
        image, x, y = frame(index, cut, seed)
        track = tracker.update(ms.Frame(image, index / 30.0, index))
        assert isinstance(track, ms.Track)
        errors.append(abs(track.shape.x - x) + abs(track.shape.y - y) + abs(track.shape.radius - RADIUS))
    assert np.mean(errors) < 2.0
    assert np.mean(np.array(errors) < 5.0) > 0.9
