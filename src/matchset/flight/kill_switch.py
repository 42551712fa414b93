"""The kill switch of a command that flies: the space key and SIGUSR1 stop all motors at once: `KillSwitch`."""

import contextlib
import os
import select
import signal
import sys
import threading
from collections.abc import Callable
from typing import Any

from matchset.media.closing import Closing

KEY = b" "
READ_BYTES = 64  # format: most keys, or signals, that are read at once
END = b"\0"  # format: written to wake and end the thread; no signal has this number
BACKGROUND_PERIOD = 0.1  # format: s between two looks whether the program is in the foreground again


class KillSwitch(Closing):
    """In its `with` block the space key and SIGUSR1 call a function at once, whatever the main thread does.

    Keys are read where stdin is a terminal and the program is in its foreground. The terminal then neither shows what
    is typed nor waits for the end of a line; leaving the block restores it. Handlers of signals can be set in the main
    thread only; in a block of another one the key alone works.

    Parameters
    ----------
    cut : callable
        Gets the reason in words. It is called in a thread of its own, so it must not wait for the caller's.
    terminal : int, optional
        File descriptor; stdin by default.

    Attributes
    ----------
    reason : str
        What was pressed, or came, first; empty until then.
    reads_keys : bool
        Whether the space key works.
    """

    def __init__(self, cut: Callable[[str], None], terminal: int | None = None) -> None:
        self.reason = ""
        self._cut, self._closed = cut, False
        self._wake_read, self._wake_write = os.pipe()
        os.set_blocking(self._wake_write, False)
        self._handler: Any = None
        self._wakeup = -1
        with contextlib.suppress(ValueError, AttributeError):  # another thread; Windows has no SIGUSR1
            self._handler = signal.signal(signal.SIGUSR1, lambda *_: None)
            # So the thread is woken by the signal itself, even while the main thread is in a long call of C.
            self._wakeup = signal.set_wakeup_fd(self._wake_write, warn_on_full_buffer=False)
        self._terminal = _open_terminal(_stdin() if terminal is None else terminal)
        self.reads_keys = self._terminal is not None
        self._thread = threading.Thread(target=self._run, name="matchset kill switch", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Restore the terminal and the handler."""
        if self._closed:
            return
        self._closed = True
        if self._handler is not None:
            signal.set_wakeup_fd(self._wakeup)
            signal.signal(signal.SIGUSR1, self._handler)
        os.write(self._wake_write, END)
        self._thread.join()
        for descriptor in (self._wake_read, self._wake_write):
            os.close(descriptor)
        if self._terminal is not None:
            self._terminal.restore()

    def _run(self) -> None:
        terminal = self._terminal
        while True:
            watched = [self._wake_read] if terminal is None else [self._wake_read, terminal.descriptor]
            ready = select.select(watched, [], [])[0]
            if self._wake_read in ready:
                came = os.read(self._wake_read, READ_BYTES)
                if signal.SIGUSR1 in came:
                    self._stop("SIGUSR1 came")
                if END in came:
                    return
            elif terminal is not None:
                keys = terminal.read()
                if keys is None:
                    terminal = None  # it has gone
                elif KEY in keys:
                    self._stop("the space key was pressed")
                elif not keys:
                    select.select([self._wake_read], [], [], BACKGROUND_PERIOD)

    def _stop(self, reason: str) -> None:
        self.reason = self.reason or reason
        self._cut(reason)


class _Terminal:
    """A terminal that gives every key at once."""

    def __init__(self, descriptor: int) -> None:
        import termios
        import tty

        self.descriptor, self._before = descriptor, termios.tcgetattr(descriptor)
        tty.setcbreak(descriptor, termios.TCSANOW)

    def read(self) -> bytes | None:
        """Read what was typed; empty in the background, None when the terminal has gone."""
        try:
            if not _in_foreground(self.descriptor):  # to read would stop the program
                return b""
            return os.read(self.descriptor, READ_BYTES) or None
        except OSError:
            return None

    def restore(self) -> None:
        """Make it as it was, also from the background."""
        import termios

        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTTOU})  # which would stop the program
        try:
            with contextlib.suppress(termios.error):  # it has gone
                termios.tcsetattr(self.descriptor, termios.TCSADRAIN, self._before)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _open_terminal(descriptor: int) -> _Terminal | None:
    """Open a terminal; None where there is none, or the program is not in its foreground."""
    try:
        import termios
    except ImportError:  # Windows
        return None
    try:
        return _Terminal(descriptor) if os.isatty(descriptor) and _in_foreground(descriptor) else None
    except (OSError, termios.error):
        return None


def _stdin() -> int:
    """Descriptor of stdin; -1 where it has none, as in a notebook."""
    try:
        return sys.stdin.fileno()
    except (AttributeError, OSError, ValueError):
        return -1


def _in_foreground(descriptor: int) -> bool:
    return os.tcgetpgrp(descriptor) == os.getpgrp()
