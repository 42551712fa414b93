"""Work that is not timed, spread over processes: `spread`."""

import multiprocessing
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

import cv2
import numba

Item = TypeVar("Item")
Result = TypeVar("Result")


def one_thread() -> None:
    """Keep OpenCV and Numba on one thread."""
    cv2.setNumThreads(1)
    numba.set_num_threads(1)


def spread(function: Callable[[Item], Result], items: Iterable[Item], jobs: int) -> list[Result]:
    """Apply a function to every item, in several processes.

    Parameters
    ----------
    function : callable
        Defined at the top of a file, so that another process finds it.
    items : iterable
        Its arguments.
    jobs : int
        How many processes; 1: here.

    Returns
    -------
    list
        The results, in the order of the items.
    """
    if jobs <= 1:
        return [function(item) for item in items]
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=one_thread) as pool:
        return list(pool.map(function, items))
