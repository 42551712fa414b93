"""A process that works for a batch: it ends with its parent, and does not listen to the keyboard (`begin_worker`)."""

import os
import signal
import threading
import time

import msgspec


class WorkerParameters(msgspec.Struct, frozen=True):
    """How a worker behaves.

    Parameters
    ----------
    look : float
        How often it looks whether its parent is still there, s. Less: more wake-ups; more: it goes on longer alone.
    """

    look: float = 0.5


PARAMETERS = WorkerParameters()
# format: a worker uses one processor
THREADS = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENCV_FOR_THREADS_NUM"


def begin_worker(parent: int) -> None:
    """Begin a worker process.

    Parameters
    ----------
    parent : int
        Its number: when that process is gone, however it ended, this one ends at once.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all; while a video is read it stops that: StopRequest
    threading.Thread(target=_end_with, args=(parent,), daemon=True).start()
    use_one_thread()


def use_one_thread() -> None:
    """Let OpenCV use one thread."""
    import cv2

    cv2.setNumThreads(1)


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(PARAMETERS.look)
    os._exit(1)


def warm_up(shape: str) -> None:
    """Load or compile the kernels for a shape, by following a disc; only the first worker of a computer compiles."""
    from matchset.app.warm import groups

    names = {"circle": ["circle", "click"]}.get(shape, ["circle", "click", *([shape] if shape in groups() else [])])
    for name in names:
        groups()[name]()
