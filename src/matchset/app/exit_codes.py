"""How a command ends: exit codes, errors of the user in one line, and a stop by Ctrl-C that leaves complete files."""

import contextlib
import errno
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextvars import ContextVar
from types import FrameType, TracebackType
from typing import Self

from matchset.app.disk import UnfinishedFileError
from matchset.image.errors import LinkError, NoStreamError
from matchset.numeric.compiling import WATCHERS

FOUND = 0  # format: the command did its work
NOT_FOUND = 1  # format: it ran to the end, but the ball was never found
BAD_INPUT = 2  # format: a wrong option, a file that cannot be read or written, an address without a stream
DEVICE = 3  # format: a camera or stream cannot be opened, or was disconnected
INTERRUPTED = 130  # format: stopped by Ctrl-C (128 + SIGINT); the files are complete
COMPILING_PERIOD = 5.0  # format: s between two lines about the compiler
STOPPING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that stop a command; its exit code is then 128 + the number, and the files are complete."""

EXIT_CODES = (
    "Exit codes: 0 done, 1 the ball was never found, 2 bad input or options, 3 camera or stream broke, "
    "130 stopped by Ctrl-C (files are whole)."
)


def print_error(problem: object) -> None:
    """Write ``error: ...`` in one line to stderr."""
    print("error: " + " ".join(str(problem).split()), file=sys.stderr)


def print_note(words: str) -> None:
    """Write ``note: ...`` in one line to stderr, at once."""
    print("note: " + " ".join(words.split()), file=sys.stderr, flush=True)


def print_warnings(warnings: Iterable[str]) -> None:
    """Write what is not as it should be, such as `Video.warnings`, one line each, to stderr."""
    for words in warnings:
        print_note(words)


@contextlib.contextmanager
def errors_in_one_line() -> Iterator[None]:
    """Report an error that a user can cause in one line on stderr, and end with its exit code.

    Raises
    ------
    SystemExit
        With the exit code, after the line is written.
    """
    try:
        yield
    except BrokenPipeError:  # the reader of stdout has closed the pipe
        discard_stdout()
        raise SystemExit(FOUND) from None
    except LinkError as error:
        print_error(error)
        raise SystemExit(BAD_INPUT if isinstance(error, NoStreamError) else DEVICE) from None
    except (ValueError, OSError) as error:
        print_error("; ".join(map(_words, [*_unfinished_before(error), error])))
        raise SystemExit(BAD_INPUT) from None
    except MemoryError as error:
        print_error(f"not enough memory: {error}" if str(error) else "not enough memory")
        raise SystemExit(BAD_INPUT) from None
    except KeyboardInterrupt:
        print_error("stopped")
        raise SystemExit(INTERRUPTED) from None
    except Exception as error:
        if not _is_opencv(error):
            raise
        print_error(f"OpenCV: {error}")
        raise SystemExit(BAD_INPUT) from None


@contextlib.contextmanager
def compiling_announced() -> Iterator[None]:
    """Say on stderr that kernels are compiled, if they are, and every few seconds how many are done."""
    begin = last = 0.0
    count = 0

    def say() -> None:
        nonlocal begin, last, count
        now = time.monotonic()
        if not count:
            begin = last = now
            print("compiling kernels (only once on this machine) ...", file=sys.stderr, flush=True)
        elif now - last > COMPILING_PERIOD:
            last = now
            print(f"  {count} kernels compiled, {now - begin:.0f} s ...", file=sys.stderr, flush=True)
        count += 1

    WATCHERS.append(say)
    try:
        yield
    finally:
        WATCHERS.remove(say)


def _is_opencv(error: Exception) -> bool:
    """Whether an error is OpenCV's; it is not imported for that."""
    opencv = sys.modules.get("cv2")
    return opencv is not None and isinstance(error, opencv.error)


def _words(error: ValueError | OSError) -> str:
    if not isinstance(error, OSError):
        return str(error)
    words, name = error.strerror or str(error), error.filename
    if name is None and error.errno in (errno.ENOSPC, errno.EIO):  # every file of ours has its name
        discard_stdout()  # Python would write what waits for it once more at exit
        name = "stdout"
    return f"{name}: {words}" if name else words


def _unfinished_before(error: BaseException) -> list[OSError]:
    """Return the unfinished files before an error: on a full disk several files fail, one after the other."""
    found: dict[str, OSError] = {}
    before = error.__context__
    while before is not None:
        if isinstance(before, UnfinishedFileError) and before.filename != getattr(error, "filename", None):
            found.setdefault(before.filename, before)
        before = before.__context__
    return list(found.values())[::-1]


_ASKED: ContextVar[Callable[[], bool] | None] = ContextVar("asked", default=None)


@contextlib.contextmanager
def stopped_when(asked: Callable[[], bool]) -> Iterator[None]:
    """Let every `StopRequest` of this block be set as soon as a function returns True, as SIGTERM does it.

    Parameters
    ----------
    asked : callable
        Asked before each frame.
    """
    token = _ASKED.set(asked)
    try:
        yield
    finally:
        _ASKED.reset(token)


class StopRequest:
    """Within its `with` block Ctrl-C, SIGTERM and SIGHUP only set a flag, so that a loop finishes its frame first.

    It is true once a signal has come, or `stopped_when` says so. A second Ctrl-C interrupts at once. A SIGHUP that is
    ignored, as `nohup` lets it, stays so.

    Attributes
    ----------
    code : int
        The exit code of the signal; 0 before one has come.
    """

    def __init__(self) -> None:
        self.code, self._asked = 0, _ASKED.get()
        self._previous_handlers: dict[signal.Signals, object] = {}

    def _set_code(self, number: int, _frame: FrameType | None) -> None:
        self.code = 128 + number
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def __bool__(self) -> bool:
        if not self.code and self._asked is not None and self._asked():
            self.code = 128 + signal.SIGTERM
        return self.code != 0

    def __enter__(self) -> Self:
        for number in STOPPING:
            if number != signal.SIGINT and signal.getsignal(number) is signal.SIG_IGN:
                continue
            # Only the main thread may set handlers; in another one (a notebook) signals keep theirs.
            with contextlib.suppress(ValueError):
                self._previous_handlers[number] = signal.signal(number, self._set_code)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._previous_handlers.items():
            signal.signal(number, handler)  # type: ignore[arg-type]


def discard_stdout() -> None:
    """Redirect stdout to the null device, so that Python reports no closed pipe when it flushes stdout at exit."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)
