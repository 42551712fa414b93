from collections.abc import Callable

import numpy as np
import pytest

from matchset.sim.digital_camera.digital_camera import CameraPipeline, DigitalCamera
from matchset.sim.digital_camera.processing import (
    add_sensor_noise,
    defocus,
    denoise,
    mix_with_last,
    saturate,
    sharpen,
)
from matchset.sim.rendering.renderer import Picture

UNIT = (1.0, 1.0, 1.0)


def flat(value: float) -> Picture:
    return np.full((60, 80, 3), value, np.float32)


def edge(low: float = 60.0, high: float = 160.0) -> Picture:
    """Dark on the left, bright from column 40 on."""
    picture = flat(low)
    picture[:, 40:] = high
    return picture


def noisy(picture: Picture, sigma: float) -> Picture:
    return picture + sigma * np.random.default_rng(0).standard_normal(picture.shape, np.float32)


@pytest.mark.parametrize(
    "step",
    [
        lambda picture: defocus(picture, 0.0),
        lambda picture: add_sensor_noise(picture, 0.0, np.random.default_rng(0)),
        lambda picture: denoise(picture, 0.0, 10.0),
        lambda picture: mix_with_last(picture, flat(3.0), 0.0, 10.0),
        lambda picture: mix_with_last(picture, None, 0.9, 10.0),
        lambda picture: sharpen(picture, 0.0, 1.5),
    ],
)
def test_a_knob_at_zero_changes_nothing(step: Callable[[Picture], Picture]) -> None:
    picture = noisy(edge(), 10.0)
    np.testing.assert_array_equal(step(picture), picture)


def test_a_camera_is_ideal_by_default() -> None:
    assert not DigitalCamera().changes_pictures
    assert not DigitalCamera(readout=0.7, halo=3.0).changes_pictures
    assert DigitalCamera(noise=1.0).changes_pictures
    picture = edge()
    np.testing.assert_array_equal(CameraPipeline(DigitalCamera())(picture, 0.0, UNIT, 0), picture)


@pytest.mark.parametrize("radius", [1.0, 2.5, 5.0])
def test_defocus_widens_an_edge_to_the_disc_and_leaves_it_in_place(radius: float) -> None:
    row = defocus(edge(0.0, 100.0), radius)[30, :, 0].astype(float)
    assert row[39] + row[40] == pytest.approx(100.0, abs=0.3)
    assert row.sum() == pytest.approx(4000.0, abs=3.0)
    partly = np.count_nonzero((row > 0.3) & (row < 99.7))
    assert partly == pytest.approx(2.0 * radius, abs=1.01)


def test_noise_has_the_stated_deviation_and_grows_with_light() -> None:
    rng = np.random.default_rng(3)
    deviations = [float(add_sensor_noise(flat(v), 8.0, rng).std()) for v in (0.0, 128.0, 255.0)]
    assert deviations[1] == pytest.approx(8.0, rel=0.03)
    assert deviations[0] < 0.5 * deviations[1] < deviations[1] < deviations[2]


def test_denoising_takes_noise_and_leaves_the_edge() -> None:
    picture = noisy(edge(), 8.0)
    smooth = denoise(picture, 1.0, 24.0)
    assert smooth[:, :36].std() < 0.45 * picture[:, :36].std()
    step = smooth[:, 42:46].mean() - smooth[:, 34:38].mean()
    assert step == pytest.approx(100.0, abs=4.0)
    assert abs(smooth[:, 40].mean() - smooth[:, 39].mean()) > 60.0


def test_a_trail_keeps_weak_contrast_that_moved_and_no_strong_one() -> None:
    weak = mix_with_last(flat(100.0), flat(104.0), 0.8, 12.0)
    strong = mix_with_last(flat(100.0), flat(220.0), 0.8, 12.0)
    assert 102.0 < weak.mean() < 104.0
    assert strong.mean() < 101.0
    pipeline = CameraPipeline(DigitalCamera(noise=10.0, trail=0.8))
    taken = [pipeline(flat(120.0), k / 30.0, UNIT, k) for k in range(12)]
    assert taken[-1].std() < 0.6 * taken[0].std()


def test_a_halo_is_brighter_than_the_bright_side_and_darker_than_the_dark_one() -> None:
    overshoots = []
    for amount in (0.5, 1.0, 2.0):
        row = sharpen(edge(), amount, 1.5)[30, :, 0]
        assert row[39] == row.min()
        assert row[40] == row.max()
        assert row[40] - 160.0 == pytest.approx(60.0 - row[39], abs=0.1)
        overshoots.append(float(row[40]) - 160.0)
    assert overshoots == pytest.approx([overshoots[0], 2.0 * overshoots[0], 4.0 * overshoots[0]], rel=0.01)
    assert overshoots[1] == pytest.approx(40.0, abs=8.0)


def test_saturation_scales_color_and_keeps_luma() -> None:
    picture = flat(0.0) + np.array([200.0, 70.0, 20.0], np.float32)
    weights = np.array([0.114, 0.587, 0.299])
    for factor in (0.0, 0.3, 1.0):
        color = saturate(picture, factor)[0, 0]
        assert color @ weights == pytest.approx(picture[0, 0] @ weights, abs=0.01)
        assert np.ptp(color) == pytest.approx(factor * 180.0, abs=0.01)


def test_light_saturates_before_the_noise() -> None:
    camera = DigitalCamera(noise=5.0)
    taken = CameraPipeline(camera)(flat(200.0), 0.0, (4.0, 4.0, 4.0), 1)
    assert taken.max() <= 255.0
    assert 250.0 < taken.mean() < 255.0


@pytest.mark.parametrize(
    "changes", [{"readout": 1.5}, {"defocus": -1.0}, {"trail": 1.0}, {"sharpening": 9.0}, {"halo": 0.0}]
)
def test_misuse_of_a_digital_camera(changes: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(changes))):
        DigitalCamera(**changes)  # type: ignore[arg-type]
