"""The fast lens warp against the slow way to do the same: a pixel at a time, all of a picture in whole arrays."""

import numpy as np
import numpy.typing as npt
import pytest

from balls import BARREL
from matchset.sim.rendering.background import packed
from matchset.sim.rendering.lens_warp import FastLensWarp

Ints = npt.NDArray[np.int64]
Words = npt.NDArray[np.uint32]


def noise(height: int, width: int) -> Words:
    words: Words = np.random.default_rng(3).integers(0, 2**32, (height, width), dtype=np.uint32)
    return words


def colors(words: Words) -> Ints:
    """B, G and R, (h, w, 3)."""
    return np.stack([words >> np.uint32(8 * k) & np.uint32(255) for k in range(3)], axis=2).astype(np.int64)


@pytest.mark.parametrize("field", [0, 1])
def test_warp(field: int) -> None:
    """Bilinear with weights in 1/32, rounded, as OpenCV's ``remap`` does it."""
    lens = FastLensWarp(BARREL, 2, field)
    room = noise(lens.height, lens.width // 2)
    frame = np.zeros((BARREL.height, BARREL.width, 4), np.uint8)
    lens.warp(room, packed(frame))
    places = lens._places.astype(np.int64)
    row, column = np.divmod(places >> 10, room.shape[1])
    q, p, levels = (places >> 5 & 31)[..., None], (places & 31)[..., None], colors(room)
    above = (32 - p) * levels[row, column] + p * levels[row, column + 1]
    below = (32 - p) * levels[row + 1, column] + p * levels[row + 1, column + 1]
    np.testing.assert_array_equal(frame[field::2, :, :3], ((32 - q) * above + q * below + 512) >> 10)
    assert not frame[1 - field :: 2].any()


@pytest.mark.parametrize("corner", [(0, 0), (120, 40), (400, 100)])
def test_warp_window(corner: tuple[int, int]) -> None:
    lens, (left, top) = FastLensWarp(BARREL, 2, 1), corner
    window = noise(min(90, lens.height - top), min(140, lens.width - left))
    frame = np.full((BARREL.height, BARREL.width, 4), 7, np.uint8)
    lens.warp_window(window, left, top, packed(frame))
    expected = np.full((BARREL.height, BARREL.width, 3), 7, np.uint8)
    levels, half = colors(window).astype(np.float32), np.float32(0.5)
    for r, x in np.ndindex(lens._maps.across.shape):
        across, down = lens._maps.across[r, x], lens._maps.down[r, x]
        i, j = int(down) - top, int(across) - left
        if across < left or down < top or i >= window.shape[0] - 1 or j >= window.shape[1] - 1:
            continue
        p, q = across - np.float32(int(across)), down - np.float32(int(down))
        one = levels[i, j] + p * (levels[i, j + 1] - levels[i, j])
        two = levels[i + 1, j] + p * (levels[i + 1, j + 1] - levels[i + 1, j])
        expected[2 * r + 1, x] = (one + q * (two - one) + half).astype(np.uint8)
    assert (expected != 7).any()
    np.testing.assert_array_equal(frame[..., :3], expected)
