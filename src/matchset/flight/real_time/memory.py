"""The garbage collector while somebody flies: `steady_memory`."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

_frozen = 0  # format: how many blocks are open


@contextmanager
def steady_memory() -> Iterator[None]:
    """Collect garbage now, and in the block look only at objects that are made in it.

    A full collection looks at every object of the program: 60 ms and more with what matchset imports, up to the
    transmitter's failsafe with a larger program. In the block it takes as long as the objects that the flight keeps are
    many, which are few. Enter it before `arm`; blocks may be nested.
    """
    global _frozen
    if not _frozen:
        gc.collect()
        gc.freeze()
    _frozen += 1
    try:
        yield
    finally:
        _frozen -= 1
        if not _frozen:
            gc.unfreeze()
