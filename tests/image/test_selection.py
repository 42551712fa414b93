"""Order statistics of kernels beside NumPy's."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.image.disc_network.selection import median, quantile, select
from matchset.numeric.jit import kernel

VALUES = st.lists(st.integers(-9, 9), min_size=1, max_size=40)  # so that many are equal


@kernel()
def all_of_them(values: npt.NDArray[np.float64], rank: int, share: float, out: npt.NDArray[np.float64]) -> None:
    """Write a value by rank, a quantile and the median; pieces are called by kernels only."""
    out[1], out[2] = quantile(values.copy(), share), median(values.copy())
    out[0] = select(values, rank)


@given(values=VALUES, share=st.floats(0.0, 1.0))
def test_quantiles_are_those_of_numpy(values: list[int], share: float) -> None:
    array, out = np.array(values, np.float64), np.empty(3)
    rank, ordered = int(share * (len(values) - 1)), array.copy()
    all_of_them(ordered, rank, share, out)
    assert out[0] == np.sort(array)[rank]
    assert sorted(ordered.tolist()) == sorted(array.tolist())
    assert (ordered[:rank] <= ordered[rank]).all()
    assert (ordered[rank:] >= ordered[rank]).all()
    assert out[1] == pytest.approx(np.quantile(array, share), abs=1e-9)
    assert out[2] == pytest.approx(np.median(array))
