"""The light of a whole picture that jumps: how much it did, and the color of a target in the new light."""

import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.image.color import ColorModel
from matchset.image.light.relighting import RelightingParameters, displacement, gains_between, relit, thinned

Picture = npt.NDArray[np.uint8]
LIMITS = RelightingParameters()
ROWS, COLUMNS = np.indices((240, 320))
BALL = (60.0, 130.0, 190.0)


def room(seed: int = 0) -> npt.NDArray[np.float64]:
    """Smooth colored patches, as a room has them."""
    coarse = np.random.default_rng(seed).uniform(50.0, 150.0, (6, 8, 3))
    return np.repeat(np.repeat(coarse, 40, axis=0), 40, axis=1)


def furniture(seed: int = 3) -> npt.NDArray[np.float64]:
    """Colored boxes of any size, in a larger room."""
    random, image = np.random.default_rng(seed), np.full((480, 640, 3), 90.0)
    for _ in range(150):
        row, column, height, width = random.integers((0, 0, 30, 30), (440, 600, 190, 190))
        image[row : row + height, column : column + width] = random.uniform(50.0, 150.0, 3)
    return image


def picture(x: float, y: float, gains: tuple[float, float, float] = (1.0, 1.0, 1.0), seed: int = 0) -> Picture:
    """A ball of radius 24 px in a room, taken with gains of the channels and some noise."""
    image = room()
    image[np.hypot(COLUMNS - x, ROWS - y) < 24.0] = BALL
    image = image * np.array(gains) + np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return np.asarray(np.rint(image).clip(0, 255), np.uint8)


WIDE = furniture()
gain = st.floats(0.65, 1.5)


@given(st.tuples(gain, gain, gain), st.floats(40.0, 280.0))
def test_gains_are_found_though_the_ball_has_moved(gains: tuple[float, float, float], x: float) -> None:
    before, now = thinned(picture(90.0, 120.0), LIMITS.side), thinned(picture(x, 150.0, gains, 1), LIMITS.side)
    found = gains_between(before, now, LIMITS)
    if np.abs(np.log(gains)).max() > LIMITS.least + 0.05:
        assert found is not None
        np.testing.assert_allclose(found, gains, rtol=0.03)
    elif np.abs(np.log(gains)).max() < LIMITS.least - 0.01:
        assert found is None


@given(st.tuples(gain, gain, gain), st.integers(-48, 48), st.integers(-36, 36))
def test_gains_are_found_though_the_camera_has_moved(gains: tuple[float, float, float], right: int, down: int) -> None:
    before, after = (
        thinned(np.asarray(np.rint(by * WIDE[y : y + 240, x : x + 320]), np.uint8), LIMITS.side)
        for x, y, by in ((160, 120, np.ones(3)), (160 - right, 120 - down, np.array(gains)))
    )
    step = 320 // LIMITS.side
    assert np.abs(np.subtract(displacement(before, after, LIMITS), (right / step, down / step))).max() < 1.0
    found = gains_between(before, after, LIMITS)
    if np.abs(np.log(gains)).max() > LIMITS.least + 0.05:
        assert found is not None
        np.testing.assert_allclose(found, gains, rtol=0.03)
    elif np.abs(np.log(gains)).max() < LIMITS.least - 0.01:
        assert found is None


def test_a_change_is_seen_though_stripes_have_moved_by_less_than_a_pixel() -> None:
    """Ratios at the edges of stripes deviate by more than the light has changed, and mean nothing."""
    gains = np.array((0.87, 0.95, 1.0))
    before, now = (
        thinned(
            np.asarray(np.rint(light * (120.0 + 90.0 * np.sin(waves / 8.0)[..., np.newaxis])), np.uint8), LIMITS.side
        )
        for waves, light in ((COLUMNS + 0.4 * ROWS, np.ones(3)), (COLUMNS + 2.5 + 0.4 * ROWS, gains))
    )
    found = gains_between(before, now, LIMITS)
    assert found is not None
    np.testing.assert_allclose(found, gains, rtol=0.03)


def test_a_channel_that_is_cut_off_changes_as_the_others_do() -> None:
    before = thinned(picture(90.0, 120.0), LIMITS.side)
    dark = before.copy()
    dark[..., 0] = 3
    now = np.asarray(np.rint(dark * 1.4), np.uint8)
    found = gains_between(dark, now, LIMITS)
    assert found is not None
    np.testing.assert_allclose(found, 1.4, rtol=0.03)
    assert gains_between(dark[:1, :1], now[:1, :1], LIMITS) is not None  # one pixel is enough to compare


def test_another_view_is_no_change_of_light() -> None:
    view = thinned(picture(90.0, 120.0), LIMITS.side)
    turned = np.roll(picture(90.0, 120.0), (37, 55), axis=(0, 1))
    assert gains_between(view, thinned(turned, LIMITS.side), LIMITS) is None
    other = np.asarray(room(7), np.uint8)
    assert gains_between(view, thinned(other, LIMITS.side), LIMITS) is None


@pytest.mark.parametrize("seed", range(4, 9))
def test_another_room_of_about_the_same_brightness_is_no_change_of_light(seed: int) -> None:
    """Its median is another one, and single pixels deviate no more than before a camera that moves."""
    first, second = (
        thinned(np.asarray(np.rint(100.0 + 0.4 * (furniture(each)[:240, :320] - 100.0)), np.uint8), LIMITS.side)
        for each in (3, seed)
    )
    other = np.asarray(np.rint(0.75 * second.astype(np.float64)), np.uint8)
    assert gains_between(first, other, LIMITS) is None
    loose = msgspec.structs.replace(LIMITS, alike=-1.0)
    assert gains_between(first, other, loose) is not None
    assert gains_between(second, other, LIMITS) == pytest.approx([0.75] * 3, rel=0.03)


def test_what_is_cut_off_says_nothing() -> None:
    white = np.full((48, 64, 3), 255, np.uint8)
    assert gains_between(white, white // 2, LIMITS) is None
    assert gains_between(white // 2, white[:20], LIMITS) is None  # another size


def test_a_picture_is_thinned_and_copied() -> None:
    image = picture(90.0, 120.0)
    small = thinned(image, 64)
    assert small.shape == (48, 64, 3)
    assert not np.shares_memory(small, image)
    np.testing.assert_array_equal(small, image[2::5, 2::5])
    np.testing.assert_array_equal(thinned(image[:20, :30], 64), image[:20, :30])


@pytest.mark.parametrize("gains", [(1.0, 1.0, 1.0), (0.7, 0.8, 1.2), (1.3, 1.2, 1.1)])
def test_a_color_in_another_light_takes_the_same_pixels_for_the_target(gains: tuple[float, float, float]) -> None:
    color = ColorModel.pick(picture(90.0, 120.0), 90, 120)
    now = picture(200.0, 100.0, gains, 3)
    inside = np.hypot(COLUMNS - 200.0, ROWS - 100.0) < 22.0
    outside = np.hypot(COLUMNS - 200.0, ROWS - 100.0) > 26.0
    changed = relit(color, color.log_odds, np.array(gains))
    mask = changed.mask(now) > 0
    assert mask[inside].mean() > 0.95
    assert mask[outside].mean() < 0.05
    assert changed.circle == color.circle
    assert changed.sample is color.sample
    assert np.abs(changed.log_odds).max() <= 4.0
    np.testing.assert_array_equal(changed.table, ColorModel(changed.log_odds).table)
    if gains == (1.0, 1.0, 1.0):
        np.testing.assert_array_equal(changed.table, color.table)


def test_a_gray_model_is_relit_too() -> None:
    image = np.full((120, 160), 60, np.uint8)
    image[np.hypot(*(np.indices(image.shape) - 60.0)) < 20.0] = 120
    color = ColorModel.pick(image, 60, 60)
    changed = relit(color, color.log_odds, np.array((1.5,)))
    np.testing.assert_array_equal(changed.mask(image + image // 2) > 0, image == 120)


@pytest.mark.parametrize("gains", [(0.62, 0.7, 0.66), (0.8, 1.0, 1.25)])
def test_a_ball_that_jumps_while_the_light_does_is_found_at_once(gains: tuple[float, float, float]) -> None:
    first = picture(90.0, 120.0)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(first, 90, 120), start=(90.0, 120.0), fps=10.0)
    for step in range(6):
        assert tracker.update(picture(90.0 + 2.0 * step, 120.0, seed=step))
    track = tracker.update(picture(190.0, 90.0, gains, 9))
    assert isinstance(track, ms.Track)
    assert abs(track.shape.x - 190.0) + abs(track.shape.y - 90.0) + abs(track.shape.radius - 24.0) < 1.5
    for step in range(4):
        assert tracker.update(picture(190.0 + 2.0 * step, 90.0, gains, step))


def test_a_copy_in_the_middle_of_a_change_gives_the_same_answers() -> None:
    import copy

    first = picture(90.0, 120.0)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(first, 90, 120), start=(90.0, 120.0), fps=10.0)
    tracker.update(first)
    other = copy.deepcopy(tracker)
    now = picture(190.0, 90.0, (0.7, 0.8, 0.9), 9)
    one, two = tracker.update(now), other.update(now)
    assert isinstance(one, ms.Track)
    assert isinstance(two, ms.Track)
    assert one.shape == two.shape
