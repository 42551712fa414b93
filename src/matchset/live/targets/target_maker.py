"""Makes targets beside the loop, one after the other, since that takes longer than a picture: `TargetMaker`."""

import atexit
import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

import msgspec

T = TypeVar("T")


class TargetMakerParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a `TargetMaker` ends.

    Parameters
    ----------
    patience : float
        How long the end of the program waits for what is being made, s. Compiled code that is loaded while the
        interpreter is taken down ends the program with SIGABRT; more waits longer for a compiler. Chosen by hand:
        loading takes 1 to 2 s, compiling up to a minute.
    """

    patience: float = 10.0


class TargetMaker(Generic[T]):
    """A thread that ends with the process.

    Parameters
    ----------
    parameters : TargetMakerParameters, optional
    """

    def __init__(self, parameters: TargetMakerParameters | None = None) -> None:
        self._patience = (parameters or TargetMakerParameters()).patience
        self._orders: queue.SimpleQueue[tuple[Callable[[], T], Future[T]] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="matchset maker", daemon=True)
        self._thread.start()
        atexit.register(self._wait)

    def order(self, make: Callable[[], T]) -> "Future[T]":
        """Call a function in the thread; its result, or its exception, is that of the future."""
        future: Future[T] = Future()
        self._orders.put((make, future))
        return future

    def close(self) -> None:
        """End the thread after what it is doing."""
        self._orders.put(None)

    def _wait(self) -> None:
        self.close()
        self._thread.join(self._patience)

    def _run(self) -> None:
        while (order := self._orders.get()) is not None:
            make, future = order
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(make())
            except Exception as error:
                future.set_exception(error)
        atexit.unregister(self._wait)
