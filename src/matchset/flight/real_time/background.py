"""What must not make a loop wait, in a thread of its own behind a bounded queue: `Background`."""

import contextlib
import queue
import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

import msgspec

from matchset.media.closing import Closing
from matchset.numeric.arguments import require_at_least

T = TypeVar("T")
LOOK = 0.05  # format: s between two looks whether the thread has ended


class BackgroundParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much may wait.

    Parameters
    ----------
    waiting : int
        Items that wait at most. More outlast a longer pause of the disk, and take the memory of as many pictures.
    drops : bool
        Whether an item is dropped, and counted, when as many wait; otherwise `Background.add` waits, as is right where
        no clock runs meanwhile.
    patience : float
        How long `Background.close` waits for the next item to be done before it gives up, s. Chosen by hand: a disk
        that answers so late has gone.
    """

    waiting: int = 64
    drops: bool = True
    patience: float = 20.0

    def __post_init__(self) -> None:
        require_at_least(self, 1, "waiting")


class Background(Closing, Generic[T]):
    """Hands items to a function in a thread, in their order. No error of the function reaches the caller of `add`.

    Parameters
    ----------
    name : str
        What it does, for messages: "recording".
    work : callable
        Gets each item. After an error it is not called any more.
    parameters : BackgroundParameters, optional
    stopped : callable, optional
        Called once, in the thread, with a line of text when the work has ended by an error.

    Attributes
    ----------
    name : str
    added : int
        Number of items so far.
    error : Exception or None
        Of the function.
    """

    def __init__(
        self,
        name: str,
        work: Callable[[T], None],
        parameters: BackgroundParameters | None = None,
        stopped: Callable[[str], None] | None = None,
    ) -> None:
        self.name, self.added = name, 0
        self._refused = self._skipped = 0  # by the caller's thread, and by the worker's
        self.error: Exception | None = None
        self._done = 0
        self._work, self._stopped = work, stopped
        self._parameters = parameters or BackgroundParameters()
        self._items: queue.Queue[tuple[T] | None] = queue.Queue(self._parameters.waiting)
        self._closed = False
        self._thread = threading.Thread(target=self._run, name=f"matchset {name}", daemon=True)
        self._thread.start()

    @property
    def dropped(self) -> int:
        """Number of items that were not worked on: no room in the queue, or after an error."""
        return self._refused + self._skipped

    @property
    def note(self) -> str:
        """How many items are missing, in words; empty if none are."""
        return f"{self.name} lacks {self.dropped} of {self.added} steps" if self.dropped else ""

    def add(self, item: T) -> None:
        """Append an item; never waits if items may be dropped."""
        self.added += 1
        if self.error is not None:
            self._refused += 1
        elif not self._parameters.drops:
            self._items.put((item,))
        else:
            try:
                self._items.put_nowait((item,))
            except queue.Full:
                self._refused += 1

    def close(self) -> None:
        """Wait for what is in the queue.

        Raises
        ------
        Exception
            That of the function.
        OSError
            If nothing was done for `BackgroundParameters.patience`.
        """
        if self._closed:
            return
        self._closed = True
        if not self._ends():
            raise OSError(f"{self.name} hangs: {self._items.qsize()} of {self.added} steps are not written")
        if self.error is not None:
            raise self.error

    def _ends(self) -> bool:
        """Tell the thread to end, and wait for it; False if it makes no progress."""
        done, since, told = -1, time.monotonic(), False
        while self._thread.is_alive():
            if not told:
                with contextlib.suppress(queue.Full):
                    self._items.put(None, timeout=LOOK)
                    told = True
            self._thread.join(LOOK if told else 0.0)
            if self._done != done:
                done, since = self._done, time.monotonic()
            elif time.monotonic() - since > self._parameters.patience:
                return False
        return True

    def _run(self) -> None:
        while (item := self._items.get()) is not None:
            self._done += 1
            if self.error is not None:
                self._skipped += 1
                continue
            try:
                self._work(item[0])
            except Exception as error:  # any: the thread must go on to empty the queue
                self.error = error
                self._skipped += 1
                if self._stopped is not None:
                    self._stopped(f"{self.name} stopped: {error}")
