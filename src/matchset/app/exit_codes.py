"""How a command ends: exit codes, errors of the user in one line, and a stop by Ctrl-C that leaves complete files."""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from types import FrameType, TracebackType
from typing import Self

from matchset.image.errors import LinkError

FOUND = 0  # format: the command did its work
NOT_FOUND = 1  # format: it ran to the end, but the ball was never found
BAD_INPUT = 2  # format: a wrong option, or a file that cannot be read or written
DEVICE = 3  # format: a camera or stream cannot be opened, or was disconnected
INTERRUPTED = 130  # format: stopped by Ctrl-C (128 + SIGINT); the files are complete
STOPPING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Signals that stop a command; its exit code is then 128 + the number, and the files are complete."""

EXIT_CODES = (
    "Exit codes: 0 done, 1 the ball was never found, 2 bad input or options, 3 camera or stream broke, "
    "130 stopped by Ctrl-C (files are whole)."
)


def print_error(problem: object) -> None:
    """Write ``error: ...`` in one line to stderr."""
    print("error: " + " ".join(str(problem).split()), file=sys.stderr)


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
        raise SystemExit(DEVICE) from None
    except ValueError as error:
        print_error(error)
        raise SystemExit(BAD_INPUT) from None
    except OSError as error:
        print_error(f"{error.filename}: {error.strerror}" if error.filename else error)
        raise SystemExit(BAD_INPUT) from None
    except KeyboardInterrupt:
        print_error("stopped")
        raise SystemExit(INTERRUPTED) from None


class StopRequest:
    """Within its `with` block Ctrl-C, SIGTERM and SIGHUP only set a flag, so that a loop finishes its frame first.

    It is true once a signal has come. A second Ctrl-C interrupts at once. A SIGHUP that is ignored, as `nohup` lets it,
    stays so.

    Attributes
    ----------
    code : int
        The exit code of the signal; 0 before one has come.
    """

    def __init__(self) -> None:
        self.code = 0
        self._previous_handlers: dict[signal.Signals, object] = {}

    def _set_code(self, number: int, _frame: FrameType | None) -> None:
        self.code = 128 + number
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def __bool__(self) -> bool:
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
