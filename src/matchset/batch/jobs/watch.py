"""Whether a worker still works for the batch that runs: `Watch`."""

import contextlib
import time

import msgspec

from matchset.batch.results.store import Store


class WatchParameters(msgspec.Struct, frozen=True):
    """How a worker looks.

    Parameters
    ----------
    look : float
        How often, s. Less: more requests to where results are; more: a worker is longer at what nobody wants any more.
    """

    look: float = 5.0


PARAMETERS = WatchParameters()


class Watch:
    """Is asked before each frame, and looks now and then.

    Parameters
    ----------
    store : Store
    """

    def __init__(self, store: Store, parameters: WatchParameters = PARAMETERS) -> None:
        self._store, self._look, self._over = store, parameters.look, False
        self._next = time.monotonic() + self._look

    def __call__(self) -> bool:
        """Return whether another batch has begun, or this one has ended."""
        if not self._over and time.monotonic() >= self._next:
            self._next = time.monotonic() + self._look
            with contextlib.suppress(OSError):  # the network is away: what is written says so
                self._over = not self._store.is_current()
        return self._over
