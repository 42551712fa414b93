import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.mount.camera_mount import mounting
from matchset.control.mount.mount_fit import MountFitParameters, PlacedBall, fit_mount, marker_place

PLACES = np.array(((0.0, -0.19, 1.5), (0.6, 0.1, 1.2), (-0.5, -0.4, 1.4)))
ANGLES = st.floats(-0.3, 0.3)


def seen(mount: tuple[float, float, float], places: np.ndarray, noise: float = 0.0, seed: int = 0) -> list[PlacedBall]:
    """Balls at places, each a little beside where it was measured, seen by a camera that is turned."""
    rng = np.random.default_rng(seed)
    return [PlacedBall(mounting(*mount).T @ (place + noise * rng.standard_normal(3)), place) for place in places]


@given(ANGLES, ANGLES, ANGLES)
def test_exact_places_give_the_exact_mount(yaw: float, pitch: float, roll: float) -> None:
    fitted = fit_mount(seen((yaw, pitch, roll), PLACES), MountFitParameters(place_sigma=1e-4))
    assert (fitted.yaw, fitted.pitch, fitted.roll) == pytest.approx((yaw, pitch, roll), abs=1e-4)
    assert max(fitted.misfits) < 1e-4


def test_one_place_tells_yaw_and_pitch_and_says_that_it_does_not_know_the_roll() -> None:
    fitted = fit_mount(seen((0.05, -0.08, 0.0), PLACES[:1]))
    assert (fitted.yaw, fitted.pitch, fitted.roll) == pytest.approx((0.05, -0.08, 0.0), abs=1e-6)
    assert fitted.sigmas[0] < 0.025
    assert fitted.sigmas[2] > 0.08


def test_the_standard_deviations_are_those_of_the_errors() -> None:
    ratios = []
    for seed in range(200):
        fitted = fit_mount(seen((0.02, 0.06, -0.03), PLACES, 0.01, seed))
        level = MountFitParameters().level_sigma
        errors = np.array((fitted.yaw, fitted.pitch, fitted.roll)) - (0.02, 0.06, -0.03)
        ratios.append(errors**2 / (np.array(fitted.sigmas) ** 2 - level**2))
    assert np.sqrt(np.mean(ratios, axis=0)) == pytest.approx((1.0, 1.0, 1.0), abs=0.2)


def test_a_place_that_was_measured_wrong_is_named() -> None:
    balls = seen((0.0, 0.1, 0.0), PLACES)
    wrong = balls[2]._replace(told=np.array((0.5, -0.4, 1.4)))
    with pytest.raises(ValueError, match=r"the ball at place \d is seen \d+\.\d degrees beside it"):
        fit_mount([*balls[:2], wrong])
    with pytest.raises(ValueError, match="one measured place or more"):
        fit_mount([])


def test_a_marker_is_placed_to_the_right_of_the_back_and_above_the_equator() -> None:
    mount = fit_mount(seen((0.1, -0.05, 0.0), PLACES))
    right, up = math.radians(10.0), math.radians(4.0)
    direction = np.array((math.sin(right) * math.cos(up), -math.sin(up), -math.cos(right) * math.cos(up)))
    place = marker_place(mounting(mount.yaw, mount.pitch, mount.roll).T @ direction, mount)
    assert place == pytest.approx((right, up), abs=1e-9)
