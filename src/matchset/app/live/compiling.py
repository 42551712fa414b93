"""Compiles what the first click needs while the page is opened, and tells the page so: `CompilingPanel`.

The compiler holds the interpreter for most of a minute, in which no picture would reach a page. So another process
compiles, and leaves what it made on the disk; this one loads it.
"""

import subprocess
import sys
import threading
import time

import msgspec

from matchset.app.live.feed import Panel
from matchset.app.warm import groups

NEEDED = ("circle", "localizer")
"""Sets of kernels of the first click."""
PROGRAM = "from matchset.app.live.compiling import compile_aloud; compile_aloud()"
WAITS = "the first click waits for the compiler, only once on this machine: click again when it is done"


class CompilingState(msgspec.Struct, frozen=True):
    """What is being compiled.

    Parameters
    ----------
    kernels : int
        Compiled so far; 0: all was kept on the disk.
    seconds : int
        For how long.
    done : bool
        Whether a click is answered at once.
    """

    kernels: int
    seconds: int
    done: bool


class CompilingPanel(Panel):
    """Has what is needed compiled by another process; on a machine where all is kept on the disk, it only loads.

    Parameters
    ----------
    command : sequence of str
        The process that compiles; writes a line for each kernel.
    """

    name = "compiling"

    def __init__(self, command: tuple[str, ...] = (sys.executable, "-c", PROGRAM)) -> None:
        self._command, self._begin, self._kernels, self._spent = command, time.monotonic(), 0, 0.0
        self._thread = threading.Thread(target=self._run, name="matchset compiler", daemon=True)
        self._thread.start()

    def state(self) -> CompilingState:
        """Return how far it is."""
        done = not self._thread.is_alive()
        return CompilingState(self._kernels, int(self._spent if done else time.monotonic() - self._begin), done)

    def refusal(self) -> str:
        """Return why a click cannot be answered yet; empty if it can."""
        return WAITS if self._thread.is_alive() and self._kernels else ""

    def _run(self) -> None:
        try:
            with subprocess.Popen(self._command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
                for _ in process.stdout or ():
                    self._kernels += 1
        except OSError:  # no process can be started: the first click compiles
            return
        for name in NEEDED:
            groups()[name]()
        self._spent = time.monotonic() - self._begin


def compile_aloud() -> None:
    """Compile what is needed, and write a line to stdout for each kernel that was not kept on the disk."""
    from matchset.numeric.compiling import WATCHERS

    WATCHERS.append(lambda: print("kernel", flush=True))
    for name in NEEDED:
        groups()[name]()
