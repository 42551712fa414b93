"""The one Numba policy: every kernel of the library is compiled with `kernel`, nothing else imports Numba.

`cache=True` keeps the machine code on disk, so only the first run on a machine compiles. Numba does not notice an edit
in a kernel that lives in another file: kernels that call each other share a file. `nogil=True` lets trackers run in
threads. `error_model="numpy"` drops the zero-division checks, so kernels guard their divisions themselves. There is no
`fastmath`: results are the same, bit for bit, from run to run.
"""

from collections.abc import Callable
from typing import Any, TypeVar

import numba

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile `function` with the options that all kernels share.

    Parameters
    ----------
    function : callable
        A function of arrays and scalars that neither raises nor prints.

    Returns
    -------
    callable
        The compiled function; it has the same signature.
    """
    compiled: F = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return compiled
