"""Makes targets beside the loop, one after the other: learning and compiling take longer than a picture (`Maker`)."""

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

T = TypeVar("T")


class Maker(Generic[T]):
    """A thread that ends with the process, whatever it is compiling then."""

    def __init__(self) -> None:
        self._orders: queue.SimpleQueue[tuple[Callable[[], T], Future[T]] | None] = queue.SimpleQueue()
        threading.Thread(target=self._run, name="matchset maker", daemon=True).start()

    def order(self, make: Callable[[], T]) -> "Future[T]":
        """Call a function in the thread; its result, or its exception, is that of the future."""
        future: Future[T] = Future()
        self._orders.put((make, future))
        return future

    def close(self) -> None:
        """End the thread after what it is doing."""
        self._orders.put(None)

    def _run(self) -> None:
        while (order := self._orders.get()) is not None:
            make, future = order
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(make())
            except Exception as error:
                future.set_exception(error)
