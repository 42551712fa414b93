"""Work that is not timed, spread over processes: `spread`, and `spread_until` where it may be stopped."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from multiprocessing.connection import wait as wait_for_end
from typing import TypeVar

import cv2
import numba

Item = TypeVar("Item")
Result = TypeVar("Result")
POLL_TIME = 0.3  # format: s, between two looks at whether to stop


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


def spread_until(
    function: Callable[[Item], Result], items: Iterable[Item], jobs: int, stop: Callable[[], bool]
) -> Iterator[tuple[int, Result]]:
    """Apply a function to every item, in several processes, which end when this one does, however it ends.

    Parameters
    ----------
    function : callable
        Defined at the top of a file, so that another process finds it.
    items : iterable
        Its arguments.
    jobs : int
        How many processes.
    stop : callable
        Asked now and then; after True nothing more begins, and what is unfinished is dropped.

    Yields
    ------
    (int, object)
        Index of the item and result, in the order in which they end.
    """
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=_begin) as pool:
        waiting = {pool.submit(function, item): number for number, item in enumerate(items)}
        try:
            while waiting and not stop():
                done, _ = wait(waiting, timeout=POLL_TIME, return_when=FIRST_COMPLETED)
                for future in done:
                    yield waiting.pop(future), future.result()
        finally:
            for future in waiting:
                future.cancel()
            if waiting:
                for process in list((pool._processes or {}).values()):
                    process.terminate()


def _begin() -> None:
    """Leave Ctrl-C to the process that started this one, and end when that one is killed."""
    one_thread()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        sentinel = parent.sentinel

        def end_with_parent() -> None:
            wait_for_end([sentinel])
            os._exit(1)

        threading.Thread(target=end_with_parent, daemon=True).start()
