"""SIGTERM and SIGHUP end the `with` block of a link by an exception, so that it lands: `enter`, `leave`, `LANDING`.

By their default action they would end the program at once, and the vehicle would fall when the failsafe acts.
Python runs handlers in the main thread only: a block that another thread has entered is not protected.
"""

import signal
import threading
from types import CodeType, FrameType
from typing import Any

LANDING: set[CodeType] = set()
"""Functions that land. A signal that comes while one runs has to wait until its end, a second one does not."""


class _Blocks:
    """What is the same for all links of the process: how many blocks are open, and the handlers before the first."""

    def __init__(self) -> None:
        self.open = 0
        self.came = 0  # the signal that waits for the end of a landing
        self.before: dict[int, Any] = {}

    def handle(self, number: int, frame: FrameType | None) -> None:
        # A flag would come too late: Python looks for signals before the first line of a function that would set it.
        while not self.came and frame is not None:
            if frame.f_code in LANDING:
                self.came = number
                return
            frame = frame.f_back
        _raise(number)


_blocks = _Blocks()


def enter() -> None:
    """Begin a block: from now on SIGTERM and SIGHUP raise `SystemExit`, 128 + the signal's number.

    A signal that the program handles itself, or ignores, as `nohup` lets it, is left alone. Ctrl-C goes on to raise
    `KeyboardInterrupt`, but while the vehicle lands only the second time.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    _blocks.open += 1
    if _blocks.open > 1:
        return
    defaults = {"SIGTERM": signal.SIG_DFL, "SIGHUP": signal.SIG_DFL, "SIGINT": signal.default_int_handler}
    for name, default in defaults.items():
        number = getattr(signal, name, None)  # Windows has no SIGHUP
        if number is not None and signal.getsignal(number) is default:
            _blocks.before[number] = signal.signal(number, _blocks.handle)


def leave() -> None:
    """End a block, after the landing; the last one restores what was before.

    Raises
    ------
    SystemExit, KeyboardInterrupt
        If a signal came meanwhile.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    _blocks.open -= 1
    if not _blocks.open:
        for number, handler in _blocks.before.items():
            signal.signal(number, handler)
        _blocks.before.clear()
    if _blocks.came:
        number, _blocks.came = _blocks.came, 0
        _raise(number)


def _raise(number: int) -> None:
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    raise SystemExit(128 + number)
