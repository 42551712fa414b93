"""The compiled reading of a patch beside a slow twin in NumPy and OpenCV, and colors of a circle."""

import math

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from ball_in_leaves import HEIGHT, WIDTH, Picture, scene
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.image.disc_network import patch_format as form
from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.polar_patch import colors_of, read_patch
from matchset.image.frame import channels_last

Floats = npt.NDArray[np.float64]
Colors = npt.NDArray[np.float32]
Circle3 = tuple[float, float, float]
SHAPE = form.BINS_L, form.BINS_AB, form.BINS_AB
WITHIN, WITHIN_ODDS = 0.02, 0.04  # mean absolute difference: of colors; of log-odds, which leap from bin to bin
SPARSE = 2.0  # px: of cells that are larger, two pixels along an axis are read, not all


def sparse(cut: Picture, columns: int, rows: int) -> Picture:
    """Mean of four pixels of each cell."""
    taps = [
        [np.floor((np.arange(count) + share) * length / count).astype(int) for share in (0.25, 0.75)]
        for count, length in ((rows, cut.shape[0]), (columns, cut.shape[1]))
    ]
    four = [cut[np.ix_(down, across)].astype(np.float64) for down in taps[0] for across in taps[1]]
    return np.asarray(np.floor(np.mean(four, axis=0) + 0.5), np.uint8)


def naive_places(image: Picture, circle: Circle3, *, area: bool = False) -> tuple[Floats, Floats] | None:
    """Color of each place, CIE Lab, and whether it is in the picture, by OpenCV; `area`: from all pixels of a cell."""
    (x, y, radius), (height, width) = circle, image.shape[:2]
    left, top = (max(math.floor(center - form.ROOM * radius) - 2, 0) for center in (x, y))
    right = min(math.ceil(x + form.ROOM * radius) + 3, width)
    bottom = min(math.ceil(y + form.ROOM * radius) + 3, height)
    if right - left < form.LEAST_SIDE or bottom - top < form.LEAST_SIDE:
        return None
    cut, scales = image[top:bottom, left:right], (1.0, 1.0)
    if radius > form.SIZE:
        across, down = (max(round(form.SIZE / radius * side), 2) for side in (right - left, bottom - top))
        if area or max((right - left) / across, (bottom - top) / down) <= SPARSE:
            cut = np.asarray(cv2.resize(cut, (across, down), interpolation=cv2.INTER_AREA), np.uint8)
        else:
            cut = sparse(cut, across, down)
        scales = across / (right - left), down / (bottom - top)
    columns, rows = (
        center + radius * form.RADII * form.DIRECTIONS[:, k, np.newaxis] for k, center in enumerate((x, y))
    )
    seen = (columns >= 0.0) & (columns <= width - 1.0) & (rows >= 0.0) & (rows <= height - 1.0)
    places = [
        ((at - start + 0.5) * scale - 0.5).astype(np.float32)
        for at, start, scale in ((columns, left, scales[0]), (rows, top, scales[1]))
    ]
    read = cv2.remap(lab_of(cut), places[0], places[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(read, np.float64), seen.astype(np.float64)


def naive_bins(colors: Floats) -> npt.NDArray[np.int64]:
    """Bin of each color."""
    low, per_unit = np.array((0.0, form.LOW_AB, form.LOW_AB)), np.array((form.PER_L, form.PER_AB, form.PER_AB))
    bins = np.clip((colors - low) * per_unit, 0, np.array(SHAPE) - 1).astype(np.int64)
    return np.asarray(np.ravel_multi_index(tuple(np.moveaxis(bins, -1, 0)), SHAPE))


def naive_shares(which: npt.NDArray[np.int64], weights: Floats, rounds: tuple[int, int, int]) -> Floats:
    """Shares of colors, blurred along each axis as if that were a ring."""
    counts = np.bincount(which.ravel(), weights.ravel(), minlength=form.COLORS).reshape(SHAPE)
    for axis, times in enumerate(rounds):
        for _ in range(times):
            counts = 0.5 * counts + 0.25 * np.roll(counts, 1, axis) + 0.25 * np.roll(counts, -1, axis)
    return np.asarray(counts.ravel() / max(float(counts.sum()), 1e-6))


def naive_patch(image: Picture, circle: Circle3, known: Colors | None = None, *, area: bool = False) -> Floats | None:
    """What `read_patch` writes, number by number."""
    read = naive_places(image, circle, area=area)
    if read is None:
        return None
    colors, seen = read
    patch = np.zeros((form.RAYS, form.PLACES, form.NUMBERS))
    scaled = form.LAB_UNIT * colors
    apart = scaled - np.median(scaled[:, form.RADII < form.MIDDLE].reshape(-1, 3), axis=0)
    patch[..., :3] = apart * form.SPREAD / max(math.sqrt(float(np.mean(apart**2))), form.LEAST_SPREAD)
    which, weights = naive_bins(colors), form.RADII * seen
    inside, around = (
        naive_shares(which[:, part], weights[:, part], (1, 1, 1))[which] + form.FLOOR
        for part in (form.RADII < form.INSIDE, form.RADII > form.AROUND)
    )
    patch[..., 3] = np.clip(np.log(inside / around) / form.MOST, -1.0, 1.0)
    patch[..., 4] = seen
    if known is not None:
        patch[..., 5] = np.clip(np.log((known[which] + form.FLOOR) / around) / form.MOST, -1.0, 1.0)
    return patch


def assert_alike(patch: Colors | None, twin: Floats | None, leeway: float = 1.0) -> None:
    """Demand that each number is about its twin's, in the mean over the places."""
    assert patch is not None
    assert twin is not None
    apart = np.abs(patch - twin).mean(axis=(0, 1))
    assert apart[:3].max() < leeway * WITHIN
    assert apart[[3, 5]].max() < leeway * WITHIN_ODDS
    assert apart[4] == 0.0


@pytest.mark.parametrize("gray", [False, True])
@pytest.mark.parametrize("place", [(160.0, 120.0), (157.3, 124.6), (4.2, 118.0), (300.5, 3.0), (-6.0, 236.0)])
@pytest.mark.parametrize("radius", [4.0, 7.5, 13.0, 20.0, 27.0, 39.0, 61.0, 110.0, 200.0])
def test_a_patch_is_that_of_its_slow_twin(radius: float, place: tuple[float, float], gray: bool) -> None:
    image = scene(radius)
    if gray:
        image = np.ascontiguousarray(image[..., 1])
    known = colors_of(image, (160.0, 120.0, radius))
    assert_alike(read_patch(image, (*place, radius), known), naive_patch(image, (*place, radius), known))


@settings(max_examples=40)
@given(
    x=st.floats(-30.0, 350.0), y=st.floats(-30.0, 270.0), size=st.floats(math.log(4.0), math.log(200.0)),
    seed=st.integers(0, 50), gray=st.booleans(),
)  # fmt: skip
def test_anywhere_it_is_that_of_its_slow_twin(x: float, y: float, size: float, seed: int, gray: bool) -> None:
    image, circle = scene(math.exp(size), seed), (x, y, math.exp(size))
    if gray:
        image = np.ascontiguousarray(image[..., :1])
    twin, patch = naive_patch(image, circle), read_patch(image, circle)
    assert (twin is None) is (patch is None)
    if twin is not None:
        assert_alike(patch, twin, 2.0)  # far outside a few places decide the histograms


@pytest.mark.parametrize("radius", [45.0, 61.0, 90.0])
def test_four_pixels_of_a_cell_are_about_all_of_it_where_little_is_finer(radius: float) -> None:
    image = np.asarray(cv2.GaussianBlur(scene(radius), (0, 0), 1.5), np.uint8)
    patch, twin = read_patch(image, (157.0, 124.0, radius)), naive_patch(image, (157.0, 124.0, radius), area=True)
    assert_alike(patch, twin)


@pytest.mark.parametrize("circle", [(160.0, 120.0, 12.0), (2.0, 236.0, 30.0), (160.0, 120.0, 90.0)])
def test_colors_are_those_of_their_slow_twin(circle: Circle3) -> None:
    image, part = scene(30.0), form.RADII < form.INSIDE
    read, colors = naive_places(image, circle), colors_of(image, circle)
    assert read is not None
    assert colors is not None
    expected = naive_shares(naive_bins(read[0])[:, part], (form.RADII * read[1])[:, part], form.KNOWN_ROUNDS)
    assert 0.5 * np.abs(colors - expected).sum() < WITHIN  # share of the places whose bin is another


def test_pictures_are_read_as_they_are_whole_and_writable() -> None:
    image = scene(20.0)
    assert channels_last(image) is image
    frozen, part = image.copy(), image[::2, ::2]
    frozen.flags.writeable = False
    for other in (frozen, part):
        read = channels_last(other)
        assert read.flags.carray
        assert np.array_equal(read, other)
    assert channels_last(image[..., 0]).shape == (HEIGHT, WIDTH, 1)
    patch, same = (read_patch(each, (160.0, 120.0, 20.0)) for each in (image, frozen))
    assert patch is not None
    assert same is not None
    assert np.array_equal(patch, same)


@pytest.mark.parametrize(
    "circle", [(math.nan, 5.0, 9.0), (5.0, math.inf, 9.0), (5.0, 5.0, math.inf), (1e300, 5.0, 9.0), (5.0, 5.0, 1e9)]
)
def test_a_circle_that_is_none_has_no_patch(circle: Circle3) -> None:
    assert read_patch(scene(20.0), circle) is None
    assert colors_of(scene(20.0), circle) is None
