"""The cheapest assignment of rows to columns: `assigned`."""

from typing import Any

import numpy as np
import numpy.typing as npt


def assigned(costs: npt.NDArray[np.float64]) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Assign rows to columns, each to one, so that all together cost least.

    SciPy is loaded at the first call, in half a second: who follows one target does not wait for it.

    Parameters
    ----------
    costs : ndarray of shape (n, m), float64

    Returns
    -------
    rows, columns : ndarray of shape (min(n, m),), int
    """
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(costs)
    return rows, columns
