"""Votes for centers on the coarse grid."""

import numpy as np
import numpy.typing as npt
import pytest

from kernels import grid_edges, votes_for_centers


def grid_of_a_disc(x: float, y: float, radius: float) -> npt.NDArray[np.int32]:
    rows, columns = np.indices((60, 80))
    inside = radius - np.hypot(columns - x, rows - y)
    grid: npt.NDArray[np.int32] = np.rint(1000.0 * np.clip(inside, -1.0, 1.0)).astype(np.int32)
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
        assert len(grid_edges(np.full((9, 12), value, np.int32))) == 0
