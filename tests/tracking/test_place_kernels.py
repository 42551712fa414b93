"""Compiled code that says where a ball may be does what NumPy does in plain sight."""

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.image.color import ColorModel
from matchset.image.disc_network.lab import lab_of
from matchset.tracking.ball.discs import middle_color, middle_pixels
from matchset.tracking.ball.places.changes import (
    MOST_ALPHA,
    WEAK,
    ChangeParameters,
    PictureChanges,
    Reference,
    changes_since,
    share_before,
)
from matchset.tracking.ball.places.changes_kernel import MixtureLimits, differences, shares_of_ball
from matchset.tracking.ball.places.color_places_kernel import CellScales, weigh_cells

Image = npt.NDArray[np.uint8]
Singles = npt.NDArray[np.float32]
LIMITS = ChangeParameters()
SCALES = CellScales(
    middle=9.0, ring=24.0, lightness=15.0, chroma=10.0, contrast=10.0, table=0.7, full=100.0
)  # squares of 3, 5 and 7 cells


def noise(seed: int, *shape: int) -> Image:
    return np.random.default_rng(seed).integers(0, 256, shape, np.uint8)


def sums(cells: npt.NDArray[np.generic]) -> tuple[Singles, Singles, Singles]:
    values = np.asarray(cells, np.float32)
    middle, inner, outer = (
        np.asarray(cv2.boxFilter(values, cv2.CV_32F, (side, side), normalize=False), np.float32) for side in (3, 5, 7)
    )
    return middle, inner, outer


def weighed_plainly(
    colors: tuple[Singles, ...], scores: tuple[Singles, ...] | None, own: Singles
) -> tuple[Singles, Singles]:
    """Merit and likeness of each cell, by whole arrays."""
    lab_scale, zero = np.array((100.0 / 255.0, 1.0, 1.0)), np.array((0.0, 128.0, 128.0))
    middle, ring = colors[0] / 9.0, (colors[2] - colors[1]) / 24.0
    off = ((middle - zero) * lab_scale - own) / (15.0, 10.0, 10.0)
    contrast = np.linalg.norm((middle - ring) * lab_scale, axis=2)
    likeness = np.exp(-0.5 * (off**2).sum(axis=2))
    merits = likeness * contrast / (contrast + 10.0)
    if scores is not None:
        inside, outside = scores[0] / 9.0, (scores[2] - scores[1]) / 24.0
        merits = np.maximum(merits, (inside - outside) * 0.7 / 200.0)
        likeness = np.maximum(likeness, (inside - 128.0) / 100.0)
    return merits, likeness


@pytest.mark.parametrize("knows", [False, True])
def test_cells_are_weighed_as_whole_arrays_are(knows: bool) -> None:
    colors = sums(noise(1, 21, 34, 3))
    scores = sums(noise(2, 21, 34)) if knows else None
    own = np.array((60.0, 20.0, -30.0), np.float32)
    nothing = np.empty((0, 0), np.float32)
    merits, likeness = np.empty((2, 21, 34), np.float32)
    weigh_cells(colors, scores or (nothing, nothing, nothing), own, SCALES, merits, likeness)
    plain_merits, plain_likeness = weighed_plainly(colors, scores, own)
    np.testing.assert_allclose(merits, plain_merits, rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(likeness, plain_likeness, rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("channels", [1, 3])
def test_the_largest_difference_of_the_channels_counts(channels: int) -> None:
    now, before = noise(3, 17, 23, channels), noise(4, 17, 23, channels)
    away, counts = np.empty((17, 23), np.uint8), np.empty(256, np.int64)
    differences(now, before, away, counts)
    plain = np.abs(now.astype(int) - before).max(axis=2)
    np.testing.assert_array_equal(away, plain)
    np.testing.assert_array_equal(counts, np.bincount(plain.ravel(), minlength=256))


def mixed_plainly(now: Image, before: Image, changed: npt.NDArray[np.bool_], pixel: Singles) -> Singles:
    """Share of the ball in each pixel, by matting in whole arrays."""
    change, toward = now.astype(float) - before, pixel - before.astype(float)
    alpha = (change * toward).sum(axis=2) / ((toward**2).sum(axis=2) + WEAK)
    residual = np.linalg.norm(change - alpha[..., np.newaxis] * toward, axis=2)
    allowed = LIMITS.residual + LIMITS.residual_share * np.linalg.norm(change, axis=2)
    is_mixture = (LIMITS.least_alpha < alpha) & (alpha < MOST_ALPHA) & (residual < allowed)
    tells = np.abs(toward).max(axis=2) > LIMITS.contrast
    return np.where(changed & is_mixture & tells, np.minimum(alpha, 1.0), 0.0).astype(np.float32)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from((1, 3)))
def test_shares_of_the_ball_are_those_of_matting(seed: int, channels: int) -> None:
    random = np.random.default_rng(seed)
    before, pixel = noise(seed, 12, 15, channels), random.integers(0, 256, channels).astype(np.float32)
    share = random.random((12, 15, 1))
    now = np.clip(before + share * (pixel - before) + random.normal(0.0, 4.0, before.shape), 0, 255).astype(np.uint8)
    changed = random.random((12, 15)) < 0.7
    limits = MixtureLimits(
        LIMITS.contrast, LIMITS.least_alpha, LIMITS.residual, LIMITS.residual_share, MOST_ALPHA, WEAK
    )
    alphas = np.empty((12, 15), np.float32)
    count = shares_of_ball((now, before), changed, pixel, limits, alphas)
    plain = mixed_plainly(now, before, changed, pixel)
    assert count == np.count_nonzero(alphas)
    np.testing.assert_allclose(alphas, plain, atol=1e-5)


def share_plainly(
    changes: PictureChanges, color: ColorModel, pixel: Singles, circle: tuple[float, float, float], moved: bool
) -> float:
    """How much of a disc was there before, by masks of the whole coarse picture."""
    before, (across, down) = changes.reference.picture, changes.scale
    rows, columns = np.indices(before.shape[:2])
    px, py, (x, y, radius) = across * columns, down * rows, circle
    seen = (np.abs(px - x) <= LIMITS.near * radius) & (np.abs(py - y) <= LIMITS.near * radius)
    apart = np.abs(before - pixel).max(axis=2)
    tells = apart > changes.threshold + LIMITS.contrast
    alike = color.scores(before) > 0
    inside = np.hypot(px - x, py - y) < radius
    own_x, own_y, own_radius = changes.reference.circle
    free = np.hypot(px - own_x, py - own_y) > LIMITS.own * max(own_radius, radius)
    around = seen & ~inside & ~changes.changed & free
    if not around.any() or np.median(apart[around].astype(int)) < LIMITS.contrast:
        return 0.0
    there = alike | (~changes.changed & tells) if moved else ~changes.changed & (alike | tells)
    counted = np.where(inside, there, seen & alike & changes.changed & moved) & free
    return float(counted.sum()) / float(inside.sum())


@pytest.mark.parametrize("moved", [False, True])
@pytest.mark.parametrize("at", [(40.0, 40.0), (75.0, 45.0), (95.0, 70.0)])
def test_what_was_there_before_is_counted_as_masks_count_it(at: tuple[float, float], moved: bool) -> None:
    before = np.full((120, 160, 3), 60, np.uint8)
    cv2.circle(before, (40, 40), 10, (30, 120, 230), -1)  # rests
    cv2.circle(before, (75, 45), 10, (30, 120, 230), -1)  # goes away
    cv2.circle(before, (130, 90), 10, (30, 120, 230), -1)  # the ball
    now = before.copy()
    now[30:60, 60:90] = 60
    cv2.circle(now, (95, 70), 10, (30, 120, 230), -1)
    color = ColorModel.pick(before, 130, 90)
    pixel = np.array((30.0, 120.0, 230.0), np.float32)
    changes = changes_since(now, Reference(before, (130.0, 90.0, 10.0), 0.0), LIMITS)
    assert changes is not None
    circle = (*at, 10.0)
    found = share_before(changes, (color, pixel), circle, LIMITS, moved=moved)
    assert found == pytest.approx(share_plainly(changes, color, pixel, circle, moved), abs=0.02)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.floats(-8.0, 70.0), st.floats(-8.0, 60.0), st.floats(0.6, 40.0))
def test_the_middle_has_the_median_color_of_its_pixels(seed: int, x: float, y: float, radius: float) -> None:
    image = np.asarray(cv2.GaussianBlur(noise(seed, 50, 64, 3), (9, 9), 3.0), np.uint8)
    color = ColorModel(np.random.default_rng(seed).normal(size=1 << 15).astype(np.float32))
    pixels = middle_pixels(image, (x, y, radius), 0.7)
    found = middle_color(image, color, (x, y, radius), 0.7)
    if not len(pixels):
        assert found is None
        return
    assert found is not None
    plain = np.median(lab_of(pixels[:, np.newaxis]).reshape(-1, 3), axis=0)
    np.testing.assert_allclose(found[0], plain, atol=1.5)
    assert found[1] == pytest.approx(float((color.scores(pixels[:, np.newaxis]) > 0).mean()), abs=0.1)


def test_a_gray_picture_has_no_chroma_and_the_table_of_another_kind_says_nothing() -> None:
    image = np.full((40, 40, 1), 180, np.uint8)
    gray = ColorModel(np.ones(256, np.float32), "dark")
    of_gray, of_color = (
        middle_color(image, each, (20.0, 20.0, 8.0), 0.7) for each in (gray, ColorModel(np.ones(1 << 15, np.float32)))
    )
    assert of_gray is not None
    assert of_color is not None
    assert np.abs(of_gray[0][1:]).max() < 1.0
    assert (of_gray[1], of_color[1]) == (1.0, 0.0)
