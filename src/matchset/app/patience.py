"""A word on the screen when something takes long: `if_slow`."""

import contextlib
import sys
import threading
from collections.abc import Iterator

AFTER_S = 0.7


@contextlib.contextmanager
def if_slow(words: str, after: float = AFTER_S) -> Iterator[None]:
    """Say on stderr what is going on, but only if the block takes long.

    Parameters
    ----------
    words : str
        What the user waits for.
    after : float
        How long to keep quiet, s.
    """
    timer = threading.Timer(after, lambda: print(words, file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
