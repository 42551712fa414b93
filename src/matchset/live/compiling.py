"""Compiles what the first click needs while the page is opened, and tells the page so: `CompilingPanel`.

The compiler holds the interpreter for most of a minute, in which no picture would reach a page. So another process
compiles, and leaves what it made on the disk; this one loads it. What other shapes and markers need comes after that of
the first click.
"""

import subprocess
import sys
import threading
import time
from collections.abc import Callable

import msgspec

from matchset.app.warm import FAMILIES, groups
from matchset.live.feed import Panel
from matchset.live.wire.messages import Kernels
from matchset.media.closing import Closing

CIRCLES = ("circle", "click", "localizer")
"""Sets of kernels of the first click."""
OTHERS = (*(name for name in FAMILIES if name not in CIRCLES), "markers")
"""Sets of kernels of other shapes, and of markers."""
READY = b"the first click"  # format: what the process writes between the two
PROGRAM = "from matchset.live.compiling import compile_aloud; compile_aloud()"
WAITS = {
    Kernels.CIRCLE: "the first click waits for the compiler, only once on this machine: it is answered after that",
    Kernels.ALL: "other shapes and markers wait for the compiler, only once on this machine: answered after that",
}


class CompilingState(msgspec.Struct, frozen=True):
    """What is being compiled.

    Parameters
    ----------
    kernels : int
        Compiled so far of those of the first click; 0: all was kept on the disk.
    seconds : int
        For how long.
    done : bool
        Whether a click is answered at once.
    """

    kernels: int
    seconds: int
    done: bool


class CompilingPanel(Panel, Closing):
    """Has what is needed compiled by another process; on a machine where all is kept on the disk, it only loads.

    Closed before the program ends: a thread that still loads compiled code while the interpreter is taken down ends the
    program with SIGABRT.

    Parameters
    ----------
    command : sequence of str
        The process that compiles; writes a line for each kernel.

    Attributes
    ----------
    ready : callable
        Called in its thread when more can be done than before.
    """

    name = "compiling"

    def __init__(self, command: tuple[str, ...] = (sys.executable, "-c", PROGRAM)) -> None:
        self._command, self._begin, self._spent = command, time.monotonic(), 0.0
        self._counts, self._ready = {Kernels.CIRCLE: 0, Kernels.ALL: 0}, Kernels.NONE
        self._closed, self._starting = threading.Event(), threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self.ready: Callable[[], None] = lambda: None
        self._thread = threading.Thread(target=self._run, name="matchset compiler", daemon=True)
        self._thread.start()

    def state(self) -> CompilingState:
        """Return how far it is."""
        done = self._ready > Kernels.NONE
        seconds = int(self._spent if done else time.monotonic() - self._begin)
        return CompilingState(self._counts[Kernels.CIRCLE], seconds, done)

    def refusal(self, needs: Kernels = Kernels.CIRCLE) -> str:
        """Return why what needs such code cannot be done yet; empty if it can, or all was kept on the disk."""
        if needs <= self._ready or not any(self._counts.values()):
            return ""
        return WAITS[max(needs, Kernels.CIRCLE)] if self._ready else WAITS[Kernels.CIRCLE]

    def close(self) -> None:
        """Compile no more, and load no more than the set that is being loaded; returns when that is done."""
        self._closed.set()
        with self._starting:
            if self._process is not None:
                self._process.kill()
        self._thread.join()

    def _run(self) -> None:
        try:
            self._compile()
        except OSError:  # no process can be started: the first click compiles
            self._ready = Kernels.ALL
            self.ready()
            return
        if not self._ready:  # it broke off
            self._load(Kernels.CIRCLE, CIRCLES)
        self._load(Kernels.ALL, OTHERS)

    def _compile(self) -> None:
        with self._starting:
            if self._closed.is_set():
                return
            self._process = subprocess.Popen(self._command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        with self._process as process:
            for line in process.stdout or ():
                if line.strip() == READY:
                    self._load(Kernels.CIRCLE, CIRCLES)
                else:
                    self._counts[Kernels.ALL if self._ready else Kernels.CIRCLE] += 1

    def _load(self, kernels: Kernels, names: tuple[str, ...]) -> None:
        for name in names:
            if self._closed.is_set():
                return
            compile_needed((name,))
        self._ready = kernels
        if kernels is Kernels.CIRCLE:
            self._spent = time.monotonic() - self._begin
        self.ready()


def compile_needed(names: tuple[str, ...] = CIRCLES + OTHERS) -> None:
    """Compile what the page needs, or load it where it is kept on the disk."""
    for name in names:
        groups()[name]()


def compile_aloud() -> None:
    """Compile what is needed, and write a line to stdout for each kernel that was not kept on the disk.

    Between those of the first click and the others it writes `READY`.
    """
    from matchset.numeric.compiling import WATCHERS

    WATCHERS.append(lambda: print("kernel", flush=True))
    compile_needed(CIRCLES)
    print(READY.decode(), flush=True)
    compile_needed(OTHERS)
