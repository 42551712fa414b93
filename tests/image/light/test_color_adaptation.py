"""Adaptation: it follows the light, and learns neither from what is in front nor without end."""

import numpy as np
import numpy.typing as npt
import pytest

from kernels import adapt, look_inside
from matchset.image.color import ColorModel
from matchset.image.light.color_adaptation import AdaptationParameters
from matchset.shapes.circle import Circle

Picture = npt.NDArray[np.uint8]
CIRCLE = Circle(80.0, 60.0, 30.0)
WALL, BALL, FINGER = (140, 140, 140), (190, 80, 40), (110, 140, 200)
ROWS, COLUMNS = np.indices((120, 160))
MUCH = AdaptationParameters(foreign_below=-5.0, max_drift=8.0)
INSIDE = np.hypot(COLUMNS - CIRCLE.x, ROWS - CIRCLE.y) <= CIRCLE.radius


def picture(ball: tuple[float, ...] = BALL, finger: bool = False, seed: int = 0) -> Picture:
    image = np.tile(np.array(WALL, float), (120, 160, 1))
    image[INSIDE] = ball
    if finger:
        image[INSIDE & (CIRCLE.x + 5 < COLUMNS)] = FINGER
    image += np.random.default_rng(seed).normal(0.0, 5.0, image.shape)
    rounded: npt.NDArray[np.uint8] = np.rint(image).clip(0, 255).astype(np.uint8)
    return rounded


def learned() -> ColorModel:
    return ColorModel.pick(picture(), CIRCLE.x, CIRCLE.y)


def whiteness(color: ColorModel, pixel: tuple[float, ...]) -> float:
    """Share of pixels of this color, with noise, that look like the target."""
    noise = np.random.default_rng(9).normal(0.0, 5.0, (40, 40, 3))
    patch = np.rint(np.array(pixel) + noise).clip(0, 255).astype(np.uint8)
    return float((color.mask(patch) == 255).mean())


def drift(share: float) -> tuple[float, ...]:
    """From the ball's blue to a gray-blue that the first model does not know."""
    return tuple(np.array(BALL) + share * np.array([-45.0, 15.0, 30.0]))


def test_it_follows_a_drift_that_the_first_model_loses() -> None:
    color, first = learned(), learned()
    for k in range(120):
        adapt(picture(drift(k / 119), seed=k), color, first.log_odds, CIRCLE, 0.15)
    assert whiteness(first, drift(1.0)) < 0.5
    assert whiteness(color, drift(1.0)) > 0.9
    assert whiteness(color, WALL) < 0.02


@pytest.mark.parametrize("gain", [0.5, 1.3])
def test_it_keeps_through_a_swing_of_the_light(gain: float) -> None:
    color, first = learned(), learned()
    for k in range(120):
        light = 1.0 + (gain - 1.0) * 0.5 * (1.0 - np.cos(2.0 * np.pi * k / 60))
        image = np.rint(light * picture(seed=k)).clip(0, 255).astype(np.uint8)
        adapt(image, color, first.log_odds, CIRCLE, 0.15)
        if k % 30 == 0:
            inside, core, _ = look_inside(image, color, CIRCLE)
            assert inside > 0.9
            assert core > 0.9
    assert whiteness(color, BALL) > 0.95
    assert whiteness(color, WALL) < 0.02


def test_what_is_known_as_background_is_not_learned_in_front_of_the_target() -> None:
    whole = picture()
    whole[:30] = picture(FINGER)[60, 80]  # the finger's color is in the first picture
    color, first = (ColorModel.pick(whole, CIRCLE.x, CIRCLE.y) for _ in range(2))
    assert whiteness(color, FINGER) < 0.02
    for k in range(300):
        adapt(picture(finger=True, seed=k), color, first.log_odds, CIRCLE, 0.15)
    assert whiteness(color, FINGER) < 0.02
    assert whiteness(color, BALL) > 0.95
    for k in range(300):
        adapt(picture(finger=True, seed=k), color, first.log_odds, CIRCLE, 0.15, MUCH)
    assert whiteness(color, FINGER) > 0.5


def test_a_cell_is_moved_until_it_is_sure() -> None:
    image = np.where(INSIDE, 60, 180).astype(np.uint8)
    for sure in (0.5, 2.5):
        color = ColorModel(np.zeros(256, np.float32))
        for _ in range(100):
            adapt(image, color, np.zeros(256, np.float32), CIRCLE, 0.05, AdaptationParameters(sure_beyond=sure))
        assert sure < color.log_odds[60] < sure + 0.06


def test_the_background_is_read_so_far_outside() -> None:
    rings = np.rint(np.hypot(COLUMNS - CIRCLE.x, ROWS - CIRCLE.y)).astype(np.uint8)
    for outside in (6.0, 15.0):
        color = ColorModel(np.zeros(256, np.float32))
        adapt(rings, color, np.zeros(256, np.float32), CIRCLE, 0.15, AdaptationParameters(outside_px=outside))
        assert abs(int(np.argmin(color.log_odds)) - (CIRCLE.radius + outside)) <= 1.0


@pytest.mark.parametrize("limits", [AdaptationParameters(), AdaptationParameters(max_drift=0.75)])
def test_no_cell_leaves_its_leash(limits: AdaptationParameters) -> None:
    rng = np.random.default_rng(1)
    first = rng.uniform(-1.5, 1.5, 32768).astype(np.float32)
    color = ColorModel(first)
    for seed in range(60):
        image = np.random.default_rng(seed % 3).integers(0, 256, (120, 160, 3), np.uint8)
        adapt(image, color, first, CIRCLE, 5.0, limits)
    change = color.log_odds - first
    assert np.abs(change).max() == pytest.approx(limits.max_drift)
    assert np.isfinite(color.log_odds).all()
    np.testing.assert_array_equal(color.table, ColorModel(color.log_odds).table)


@pytest.mark.parametrize("size", [256, 32768])
def test_a_wrong_outline_far_outside_changes_nothing(size: int) -> None:
    color = ColorModel(np.zeros(size, np.float32))
    image = picture() if size == 32768 else picture()[:, :, 0]
    adapt(image, color, color.log_odds.copy(), Circle(-400.0, -400.0, 30.0), 0.15)
    assert not color.log_odds.any()
    assert look_inside(image, color, Circle(-400.0, -400.0, 30.0))[:2] == (-1.0, -1.0)


def taught(first: npt.NDArray[np.float32], seed: int) -> ColorModel:
    """A color that has seen other things."""
    color = ColorModel(first)
    pixels = np.random.default_rng(seed).integers(0, 256, (120, 160, 3), np.uint8)
    adapt(pixels, color, first, CIRCLE, 2.0, AdaptationParameters(forget=0.0), range(12))
    assert not np.array_equal(color.log_odds, first)
    return color


NOWHERE = Circle(-400.0, -400.0, 30.0)


def test_what_is_not_seen_again_is_forgotten() -> None:
    first = np.random.default_rng(1).uniform(-1.5, 1.5, 32768).astype(np.float32)
    color, limits = taught(first, 2), AdaptationParameters(forget=0.4, sweep=7)
    apart = np.abs(color.log_odds - first)
    for sweep in range(1, 9):
        looks = range((sweep - 1) * limits.sweep, sweep * limits.sweep)
        adapt(picture(), color, first, NOWHERE, 0.0, limits, looks)
        expected = np.maximum(apart - sweep * limits.forget, 0.0)
        np.testing.assert_allclose(np.abs(color.log_odds - first), expected, atol=1e-5)
        np.testing.assert_array_equal(color.table, ColorModel(color.log_odds).table)
    np.testing.assert_array_equal(color.log_odds, first)


def test_colors_that_have_seen_other_things_become_the_same() -> None:
    first = learned().log_odds
    one, other = taught(first, 2), taught(first, 3)
    assert np.count_nonzero(one.table != other.table) > 100
    limits = AdaptationParameters()
    for look in range(10 * limits.sweep):
        for color in (one, other):
            adapt(picture(seed=look), color, first, CIRCLE, 0.8, limits, range(look, look + 1))
    np.testing.assert_array_equal(one.table, other.table)


def test_gray_learns_too() -> None:
    color = ColorModel(np.zeros(256, np.float32))
    image = np.where(INSIDE, 60, 180).astype(np.uint8)
    for _ in range(40):
        adapt(image, color, np.zeros(256, np.float32), CIRCLE, 0.15)
    assert color.log_odds[60] > 1.0
    assert color.log_odds[180] < -1.0
    assert 0.0 < color.log_odds[61] < color.log_odds[60]


def test_the_inside_is_counted() -> None:
    blue = learned()
    assert look_inside(picture(), blue, CIRCLE)[:2] == (1.0, 1.0)
    inside, core, hollow = look_inside(picture(finger=True), blue, CIRCLE)
    assert 0.45 < inside < 0.75
    assert 0.4 < core < 0.9
    assert hollow < 0.28  # a finger is no ring
    ring = picture()
    ring[np.hypot(COLUMNS - CIRCLE.x, ROWS - CIRCLE.y) < 0.7 * CIRCLE.radius] = WALL
    inside, core, hollow = look_inside(ring, blue, CIRCLE)
    assert core == 0.0
    assert hollow > 0.28
    assert look_inside(picture(WALL), blue, CIRCLE)[0] < 0.05
