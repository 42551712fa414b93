"""What a page asks for before its compiled code is there: kept, and done as soon as it is (`LateWishes`)."""

import threading
from collections import deque
from collections.abc import Callable

from matchset.live.wire.messages import Kernels, PageMessage

Late = tuple[PageMessage, str]


class LateWishes:
    """Keeps messages of pages until the code that they need has been compiled. Any thread may ask.

    Parameters
    ----------
    refusal : callable
        Returns why what needs such code cannot be done yet; empty if it can.
    most : int
        Messages that are kept; with one more the oldest is given up.
    """

    def __init__(self, refusal: Callable[[Kernels], str], most: int) -> None:
        self._refusal, self._most = refusal, most
        self._lock = threading.Lock()
        self._kept: deque[Late] = deque()

    def keep(self, message: PageMessage, page: str) -> tuple[str, Late | None]:
        """Keep a message, if the code that it needs is not there yet.

        Returns
        -------
        str
            Why it waits; empty: it is not kept.
        tuple of Up and str, or None
            The message that is given up for it, and its page.
        """
        with self._lock:
            words = self._refusal(message.needs)
            if words:
                self._kept.append((message, page))
            return words, self._kept.popleft() if len(self._kept) > self._most else None

    def take(self) -> list[Late]:
        """Return those that can be done now, oldest first; they are kept no more."""
        with self._lock:
            ready = [late for late in self._kept if not self._refusal(late[0].needs)]
            self._kept = deque(late for late in self._kept if late not in ready)
            return ready

    def forget(self) -> None:
        """Keep none: other pictures are shown."""
        with self._lock:
            self._kept.clear()
