"""What pages asked for and has not been done yet: bounded, and a new click is never the one that is left out."""

import threading
from collections import deque
from typing import Generic, TypeVar

from matchset.live.targets.messages import Begin

T = TypeVar("T")


class WaitingWishes(Generic[T]):
    """Keeps wishes in their order until they can be done. Any thread may ask.

    Parameters
    ----------
    most : int
        Wishes that wait. With one more the oldest click is given up: who clicks again means the newer one.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._lock = threading.Lock()
        self._waiting: deque[T] = deque()

    def __len__(self) -> int:
        return len(self._waiting)

    @property
    def has_click(self) -> bool:
        """Whether a click waits."""
        with self._lock:
            return any(isinstance(each, Begin) for each in self._waiting)

    def put(self, wish: T) -> T | None:
        """Keep a wish.

        Returns
        -------
        T or None
            What is given up for it: the oldest click; the wish itself where no click waits.
        """
        with self._lock:
            if len(self._waiting) < self._most:
                self._waiting.append(wish)
                return None
            oldest = next((each for each in self._waiting if isinstance(each, Begin)), None)
            if oldest is None:
                return wish
            self._waiting.remove(oldest)
            self._waiting.append(wish)
            return oldest

    def take(self) -> T | None:
        """Return the oldest, which waits no more; None: none waits."""
        with self._lock:
            return self._waiting.popleft() if self._waiting else None
