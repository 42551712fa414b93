"""What kernels are made of: `cut` against NumPy's own views."""

import numpy as np
import numpy.typing as npt
import pytest
from numba import TypingError

from matchset.numeric.jit import cut, kernel

Floats = npt.NDArray[np.float64]


@kernel(refcount=False)
def scale(block: Floats, start: int, rows: int, columns: int) -> float:
    """Number every place of a cut; returns its last row's sum."""
    table = cut(block, start, (rows, columns))
    total = 0.0
    for i in range(table.shape[0]):
        for j in range(table.shape[1]):
            table[i, j] += 10.0 * i + j
    for j in range(columns):
        total += table[rows - 1, j]
    return total


@pytest.mark.parametrize("shape", [(1, 1), (3, 4), (7, 2)])
def test_a_cut_is_a_view_of_its_part(shape: tuple[int, int]) -> None:
    block, expected = np.arange(40.0), np.arange(40.0)
    part = cut(expected, 5, shape)
    part += 10.0 * np.arange(shape[0])[:, np.newaxis] + np.arange(shape[1])
    assert scale(block, 5, *shape) == part[-1].sum()
    np.testing.assert_array_equal(block, expected)
    assert part.base is not None
    assert expected[5 + np.prod(shape) :].tolist() == np.arange(40.0)[5 + np.prod(shape) :].tolist()


def test_what_is_not_in_one_piece_cannot_be_cut() -> None:
    with pytest.raises(TypingError):
        scale(np.arange(40.0)[::2], 0, 2, 2)
