import math

import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.links.simulation_parameters import SimulationParameters
from matchset.sim.conditions.conditions import Conditions
from matchset.sim.conditions.exposures import Exposures, half_exposure
from matchset.sim.world import RATE

CAMERA = ms.CameraModel.from_fov(160, 120, math.radians(90.0))


def pictures(turning: float, preset: str = "clean", **named: float) -> npt.NDArray[np.float64]:
    """What the first camera sees in four pictures while its vehicle turns."""
    world = ms.sim.World(ms.sim.ChainParameters(vehicles=2, conditions=Conditions(**named)), seed=3)
    cameras = ms.sim.WorldCameras(world, CAMERA, preset=preset)
    seen = []
    for k in range(1, 25):
        world.send(0, ms.sim.Command(yaw=turning, throttle=0.595))
        world.advance(16 * k + 12)
        if k > 20:
            seen.append(cameras.image(0, 16 * k).astype(np.float64))
    return np.array(seen)


def sharpness(picture: npt.NDArray[np.float64]) -> float:
    """Mean square of the difference of neighbors along a row, without that of the sensor's noise of 2 gray levels."""
    return float((np.diff(picture, axis=-2) ** 2).mean()) - 2.0 * 2.0**2


def test_sub_exposures_lie_evenly_about_the_middle() -> None:
    for blur in (0.0, 2.0, 8.0, 16.7, 33.0):
        exposures = Exposures(Conditions(blur_ms=blur), RATE, 0)
        steps = np.array(exposures.steps(1000)) - 1000
        assert np.abs(steps).max() <= exposures.half == half_exposure(blur, RATE)
        np.testing.assert_array_equal(steps, -steps[::-1])
        assert np.diff(steps).max(initial=0) <= exposures.parameters.spacing + 1
    assert Exposures(Conditions(), RATE, 0).steps(77) == [77]


def test_what_turns_is_blurred_and_what_rests_is_not() -> None:
    sharp, blurred = pictures(1.0)[-1], pictures(1.0, blur_ms=16.0)[-1]
    assert sharpness(blurred) < 0.7 * sharpness(sharp)
    at_rest, exposed = pictures(0.0)[-1], pictures(0.0, blur_ms=16.0)[-1]
    assert sharpness(exposed) == pytest.approx(sharpness(at_rest), rel=0.1)
    assert blurred.mean() == pytest.approx(sharp.mean(), abs=2.0)


def test_lamps_flicker_between_fields_but_not_in_an_exposure_of_a_whole_period() -> None:
    still, flickering = pictures(0.0, "typical"), pictures(0.0, "typical", flicker=0.5)
    between = np.abs(still[:, ::2].mean(axis=(1, 2, 3)) - still[:, 1::2].mean(axis=(1, 2, 3))).max()
    combed = np.abs(flickering[:, ::2].mean(axis=(1, 2, 3)) - flickering[:, 1::2].mean(axis=(1, 2, 3))).max()
    assert combed > between + 15.0
    whole = Exposures(Conditions(flicker=0.5, blur_ms=10.0), RATE, 1)
    assert [whole.field_gain(step) for step in range(9)] == pytest.approx([1.0] * 9)
    gains = [Exposures(Conditions(flicker=0.5), RATE, 1).field_gain(step) for step in range(480)]
    assert (min(gains), max(gains)) == pytest.approx((0.5, 1.5), abs=0.05)
    assert np.mean(gains) == pytest.approx(1.0, abs=1e-9)


def test_exposure_swings_by_its_factor_and_no_more() -> None:
    exposures = Exposures(Conditions(exposure_swing=4.0), RATE, 0)
    gains = [exposures.gain(step)[1] for step in range(0, 4 * RATE, 8)]
    assert max(gains) / min(gains) == pytest.approx(4.0, rel=1e-3)
    assert exposures.gain(480)[0] == exposures.gain(480)[2]
    bright = pictures(0.0, exposure_swing=4.0)  # 0.7 s: brighter than usual
    assert bright.mean() > pictures(0.0).mean() + 20.0


def test_by_default_exposures_change_nothing() -> None:
    exposures = Exposures(Conditions(), RATE, 5)
    assert [exposures.field_gain(step) for step in range(50)] == [1.0] * 50
    assert [exposures.gain(step) for step in range(50)] == [(1.0, 1.0, 1.0)] * 50
    assert SimulationParameters().picture_times.exposed == 4


def test_no_picture_comes_before_its_exposure_is_over() -> None:
    parameters = SimulationParameters(latency_ms=0.0, conditions=Conditions(blur_ms=20.0))
    assert parameters.picture_times.delivered(2) == 32 + 4 + 5
    assert parameters.picture_times.stamp(2) == pytest.approx(32 / RATE)
