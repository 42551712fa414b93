"""Order statistics of kernels beside NumPy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.numeric.jit import interpreted
from matchset.numeric.selection import median, quantile, select

VALUES = st.lists(st.integers(-9, 9), min_size=1, max_size=40)  # so that many are equal


@settings(deadline=None)
@given(values=VALUES, share=st.floats(0.0, 1.0), precision=st.sampled_from((np.float32, np.float64)))
def test_quantiles_are_those_of_numpy(values: list[int], share: float, precision: type[np.floating]) -> None:
    array = np.array(values, precision)
    rank = int(share * (len(values) - 1))
    ordered = array.copy()
    assert interpreted(select)(ordered, rank) == np.sort(array)[rank]
    assert sorted(ordered.tolist()) == sorted(array.tolist())
    assert (ordered[:rank] <= ordered[rank]).all()
    assert (ordered[rank:] >= ordered[rank]).all()
    assert interpreted(quantile)(array.copy(), share) == pytest.approx(np.quantile(array, share), abs=1e-4)
    assert interpreted(median)(array.copy()) == pytest.approx(np.median(array))
