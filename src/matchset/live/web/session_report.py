"""What all pages are told of the session, made once for all of them: `SessionReport`."""

import time
from collections.abc import Callable

from matchset.live.session import Session
from matchset.live.wire.state import SessionState, written

SESSION_PERIOD = 0.1  # format: s between two looks whether the state of the session has changed


class SessionReport:
    """Looks at the session once in each period, however many pages ask. For one thread, that of the pages.

    Parameters
    ----------
    session : Session
    clock : callable, optional
        Returns the time, s.

    Attributes
    ----------
    version : int
        Another one whenever the state is another one.
    """

    def __init__(self, session: Session, clock: Callable[[], float] = time.monotonic) -> None:
        self._session, self._clock = session, clock
        self._turn: int | None = None
        self._state, self._written = SessionState(), b""
        self.version = 0

    def state(self) -> SessionState:
        """Return the state of the session in this period."""
        turn = int(self._clock() / SESSION_PERIOD)
        if turn != self._turn:
            self._state, self._turn = self._session.state(), turn
            data = written(self._state)
            if data != self._written:
                self._written = data
                self.version += 1
        return self._state

    def wait(self) -> float:
        """Return the time until the next period, s."""
        return SESSION_PERIOD - self._clock() % SESSION_PERIOD
