"""Votes for centers on the coarse grid."""

import numpy as np
import numpy.typing as npt
import pytest

from kernels import grid_edges, votes_for_centers
from matchset.image.color import ColorModel
from matchset.tracking.search import blobs as places
from matchset.tracking.search import peak_circles, voting


def grid_of_a_disc(x: float, y: float, radius: float) -> npt.NDArray[np.int16]:
    rows, columns = np.indices((60, 80))
    inside = radius - np.hypot(columns - x, rows - y)
    grid: npt.NDArray[np.int16] = np.rint(1000.0 * np.clip(inside, -1.0, 1.0)).astype(np.int16)
    return grid


@pytest.mark.parametrize(("x", "y", "radius"), [(40.0, 30.0, 6.0), (33.3, 28.6, 12.0), (45.8, 31.1, 24.0)])
def test_the_boundary_of_a_disc_votes_for_its_center(x: float, y: float, radius: float) -> None:
    smooth = grid_of_a_disc(x, y, radius)
    edges = grid_edges(smooth)
    away = edges[:, :2] - (x, y)
    distance = np.hypot(*away.T)
    assert 0.8 * 2.0 * np.pi * radius <= len(edges) <= 1.5 * 2.0 * np.pi * radius
    np.testing.assert_allclose(distance, radius, atol=0.8)
    assert (np.sum(edges[:, 2:] * away, axis=1) > 0.9 * distance).all()  # normals point out
    votes, total = votes_for_centers(smooth, edges, 1, 40)
    row, column = np.unravel_index(np.argmax(total), total.shape)
    assert np.hypot(column - x, row - y) < 1.5
    assert total.max() == pytest.approx(5.0 * 2.0 * np.pi, rel=0.2)  # 5 cells of each line, whatever the size
    np.testing.assert_allclose(total.sum(), _spread_twin(votes).sum(), rtol=1e-4)
    np.testing.assert_allclose(total, _spread_twin(votes), atol=1e-4)


def _spread_twin(votes: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    padded = np.pad(votes.astype(float), 2)
    rows, columns = votes.shape
    windows = [padded[i : i + rows, j : j + columns] for i in range(5) for j in range(5)]
    total: npt.NDArray[np.float64] = np.stack(windows).sum(axis=0)
    return total


def test_only_wanted_distances_vote() -> None:
    smooth = grid_of_a_disc(40.0, 30.0, 20.0)
    edges = grid_edges(smooth)
    near, _ = votes_for_centers(smooth, edges, 1, 8)
    far, _ = votes_for_centers(smooth, edges, 15, 25)
    assert near[30, 40] == 0.0
    assert far[30, 40] > 0.0
    assert far[30, 58] == 0.0


def test_a_grid_of_one_kind_has_no_boundary() -> None:
    for value in (-5, 0, 5):
        assert len(grid_edges(np.full((9, 12), value, np.int16))) == 0


def test_circles_are_fitted_to_the_boundary() -> None:
    smooth = grid_of_a_disc(33.3, 28.6, 12.0)
    edges, limits = grid_edges(smooth), voting.SearchParameters()
    circles = voting.Accumulator(smooth.shape, (1, 20), 1, limits).find_circles(smooth, edges)
    assert np.abs(circles[0, :3] - (33.3, 28.6, 12.0)).max() < 2.0
    chosen = np.array((limits.aim_fine, limits.band, limits.band_growth, limits.damping))
    for _ in range(limits.rounds):
        peak_circles.fit_circles(edges, circles, chosen, np.zeros((3, 4)), np.zeros((3, 3)))
    np.testing.assert_allclose(circles[0, :3], (33.3, 28.6, 12.0), atol=0.3)
    assert circles[0, 3] == pytest.approx(1.0, abs=0.3)


def test_of_near_peaks_the_stronger_one_is_kept() -> None:
    total = np.zeros((20, 30), np.float32)
    total[5, 5], total[6, 7], total[15, 20], total[0, 0], total[10, 10] = 9.0, 10.0, 4.0, 99.0, 1.0
    np.testing.assert_array_equal(peak_circles.pick_peaks(total, 2.0, 3.0, 6), [(7.0, 6.0), (20.0, 15.0)])
    np.testing.assert_array_equal(peak_circles.pick_peaks(total, 2.0, 3.0, 1), [(7.0, 6.0)])
    assert peak_circles.pick_peaks(np.zeros((9, 9), np.float32), 2.0, 3.0, 6).shape == (0, 2)


@pytest.mark.parametrize("stride", [2, 3, 8])
@pytest.mark.parametrize("channels", [1, 3])
def test_a_cell_sums_the_scores_of_two_pixels(stride: int, channels: int) -> None:
    rng = np.random.default_rng(0)
    image = rng.integers(0, 256, (40, 56, channels), np.uint8)
    color = ColorModel(rng.normal(0.0, 2.0, 32768 if channels == 3 else 256).astype(np.float32))
    scores = color.scores(image if channels == 3 else image[:, :, 0]).astype(int)
    grid = np.zeros((40 // stride, 56 // stride), np.int16)
    voting.sample_grid(image, color.table, stride, grid)
    rows = scores[stride // 2 :: stride][: len(grid)]
    both = [rows[:, offset::stride][:, : grid.shape[1]] for offset in (0, stride // 2)]
    np.testing.assert_array_equal(grid, both[0] + both[1])


@pytest.mark.parametrize("radius", [6.0, 9.0, 12.0])
def test_blobs_find_a_disc_in_parts_on_speckled_ground(radius: float) -> None:
    rng = np.random.default_rng(3)
    rows, columns = np.indices((120, 160))
    white = rng.random(rows.shape) < 0.05
    inside = np.hypot(columns - 70.0, rows - 50.0) < radius
    white |= inside
    white &= ~(inside & (np.abs(rows - 50) < 2))  # a dark seam
    grid = np.where(white, 254, -254).astype(np.int16)
    blobs = places.blobs_of(grid, 5.0, 0.25, 5)
    assert len(blobs) <= 5
    assert [len(each) for each in blobs] == [3] * len(blobs)
    apart = np.hypot(blobs[0][:, 0] - 70.0, blobs[0][:, 1] - 50.0)
    assert (apart < 1.5 * blobs[0][:, 2]).all()
    assert apart.min() < 0.4 * radius
    np.testing.assert_allclose(blobs[0][:, 2], 5.0 * np.array(places.BLOB_SIZES))
    assert all(each[:, 3].max() > 0.25 for each in blobs)


def test_blobs_of_a_picture_without_the_color_or_too_small_for_them() -> None:
    assert places.blobs_of(np.full((60, 80), -254, np.int16), 4.0, 0.25, 5) == []
    assert places.blobs_of(np.full((6, 6), 254, np.int16), 4.0, 0.25, 5) == []


GRIDS = {
    "one color": np.full((40, 56), 254, np.int16),
    "none of the color": np.full((40, 56), -254, np.int16),
    "a middle one": np.full((40, 56), 71, np.int16),
    "noise": np.random.default_rng(4).integers(-254, 255, (40, 56)).astype(np.int16),
    "a cell": np.pad(np.full((1, 1), 254, np.int16), 20, constant_values=-254),
    "tiny": np.full((3, 3), 254, np.int16),
}


@pytest.mark.parametrize("radius", [0.01, 0.3, 0.6, 0.65, 0.9, 0.94, 1.0, 1.5, 4.0])
@pytest.mark.parametrize("name", GRIDS)
def test_a_disc_of_any_size_is_compared_with_cells_around_it(name: str, radius: float) -> None:
    """Of discs of 0.625 to 0.94 and of less than 0.31 cells inner and outer square were the same: 0 / 0."""
    grid = GRIDS[name]
    for _, step in places.color_steps(grid, [radius]):
        assert np.isfinite(step).all()
        assert np.abs(step).max() <= 2.0 + 1e-5
        if np.ptp(grid) == 0:
            np.testing.assert_allclose(step, 0.0, atol=1e-5)
    for blob in places.blobs_of(grid, radius, 0.4, 5):
        assert np.isfinite(blob).all()
    if name == "a cell":
        (first, *_) = places.blobs_of(grid, min(radius, 0.65), 0.1, 5)
        np.testing.assert_allclose(first[0, :2], 20.0, atol=1.0)


def test_blobs_are_places_in_the_picture_where_a_size_is_expected() -> None:
    searcher = voting.Searcher(160, 120, radius=5.0)
    rows, columns = np.indices((120, 160))
    image = np.full((120, 160, 3), 128, np.uint8)
    image[np.hypot(columns - 70.0, rows - 50.0) < 10.0] = (20, 200, 20)
    table = np.full((32, 32, 32), -4.0, np.float32)
    table[:8, 20:, :8] = 4.0
    color = ColorModel(table.ravel())
    (first,) = searcher.blobs(image, color)
    assert (np.hypot(first[:, 0] - 70.0, first[:, 1] - 50.0) < 5.0).all()
    assert first[:, 2].tolist() == pytest.approx([7.0, 10.0, 14.0])
    assert first[:, 3].max() > 0.8
    assert voting.Searcher(160, 120).blobs(image, color) == []  # no size is expected
