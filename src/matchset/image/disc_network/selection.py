"""Order statistics inside kernels: `select`, `median`, `quantile`."""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Numbers = npt.NDArray[np.floating[Any]]


@kernel(refcount=False, entry=False)
def select(values: Numbers, rank: int) -> float:
    """Order values so that the one of a rank is where it belongs; that value (Hoare's selection).

    Parameters
    ----------
    values : (n,), written
        At least one.
    rank : int
        0 ... n - 1.
    """
    low, high = 0, values.shape[0] - 1
    while low < high:
        pivot, i, j = values[(low + high) // 2], low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if rank <= j:
            high = j
        elif rank >= i:
            low = i
        else:
            break
    return float(values[rank])


@kernel(refcount=False, entry=False)
def quantile(values: Numbers, share: float) -> float:
    """Quantile of values, between two of them by their distance, as NumPy has it.

    Parameters
    ----------
    values : (n,), written
        At least one.
    share : float
        0 ... 1.
    """
    at = share * (values.shape[0] - 1)
    below = int(at)
    lower = select(values, below)
    if below + 1 >= values.shape[0] or at == below:
        return lower
    upper = values[below + 1]
    for k in range(below + 2, values.shape[0]):
        upper = min(upper, values[k])
    return float(lower + (at - below) * (upper - lower))


@kernel(refcount=False, entry=False)
def median(values: Numbers) -> float:
    """Median of values, which are ordered on the way."""
    return quantile(values, 0.5)
