"""The one commander of a flight, asked and changed by several threads: `SharedCommander`."""

import threading
import time
from collections.abc import Callable

from matchset.live.piloting.commander import Commander, SilenceParameters


class SharedCommander:
    """Holds the `Commander`; every look lets silence act.

    Parameters
    ----------
    silence : SilenceParameters, optional
    clock : callable
        s, never backward.
    """

    def __init__(self, silence: SilenceParameters | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self._commander = Commander(silence=silence or SilenceParameters())
        self._clock, self._lock = clock, threading.Lock()

    def look(self) -> Commander:
        """Return who commands, and what is to be done now."""
        return self.change(lambda commander, _: commander)

    def change(self, change: Callable[[Commander, float], Commander]) -> Commander:
        """Change the commander of now, and return it.

        Parameters
        ----------
        change : callable
            Gets the commander and the time, s; returns the new one.
        """
        with self._lock:
            now = self._clock()
            self._commander = change(self._commander.at(now), now)
            return self._commander
