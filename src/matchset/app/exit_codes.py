"""How a command ends: exit codes for scripts, errors in one line, Ctrl-C that loses nothing."""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from types import FrameType, TracebackType
from typing import Self

from matchset.image.errors import LinkError

FOUND = 0
"""The command did its work."""
NOT_FOUND = 1
"""It ran to the end, but the ball was never found."""
BAD_INPUT = 2
"""A wrong option, or a file that cannot be read or written."""
DEVICE = 3
"""A camera or stream cannot be opened, or went away."""
INTERRUPTED = 130
"""Stopped by Ctrl-C; what was done so far is complete on disk."""
TERMINATED = 143
"""The same, by SIGTERM."""

EXIT_CODES = (
    "Exit codes: 0 done, 1 the ball was never found, 2 bad input or options, 3 camera or stream broke, "
    "130 stopped by Ctrl-C (files are whole)."
)


def say_error(problem: object) -> None:
    """Write ``error: ...`` in one line to stderr."""
    print("error: " + " ".join(str(problem).split()), file=sys.stderr)


@contextlib.contextmanager
def errors_in_one_line() -> Iterator[None]:
    """Turn the errors that a user can cause into one line and an exit code.

    Raises
    ------
    SystemExit
        With the code, after the line is written.
    """
    try:
        yield
    except BrokenPipeError:  # whoever read stdout has seen enough
        forget_stdout()
        raise SystemExit(FOUND) from None
    except LinkError as error:
        say_error(error)
        raise SystemExit(DEVICE) from None
    except ValueError as error:
        say_error(error)
        raise SystemExit(BAD_INPUT) from None
    except OSError as error:
        say_error(f"{error.filename}: {error.strerror}" if error.filename else error)
        raise SystemExit(BAD_INPUT) from None
    except KeyboardInterrupt:
        say_error("stopped")
        raise SystemExit(INTERRUPTED) from None


class StopRequest:
    """Within its `with` block Ctrl-C and SIGTERM only ask for an end: a loop finishes its frame first.

    A second Ctrl-C interrupts at once.

    Attributes
    ----------
    code : int
        The exit code that the signal asks for; 0 while nobody asked.
    """

    def __init__(self) -> None:
        self.code = 0
        self._before: dict[signal.Signals, object] = {}

    def _note(self, number: int, _frame: FrameType | None) -> None:
        self.code = INTERRUPTED if number == signal.SIGINT else TERMINATED
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def __bool__(self) -> bool:
        return self.code != 0

    def __enter__(self) -> Self:
        for number in (signal.SIGINT, signal.SIGTERM):
            # Only the main thread may; elsewhere (a notebook's worker) signals stay as they are.
            with contextlib.suppress(ValueError):
                self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)  # type: ignore[arg-type]


def forget_stdout() -> None:
    """Send what is left for a closed pipe nowhere, so that Python does not complain when it ends."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, sys.stdout.fileno())
    os.close(nothing)
