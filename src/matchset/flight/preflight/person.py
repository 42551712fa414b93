"""Who is asked what no program can see, and told what to do: `Person`; at a terminal, or nobody."""

import sys
from typing import Protocol

from matchset.app.exit_codes import print_error


class Person(Protocol):
    """Somebody who looks at the vehicle.

    Attributes
    ----------
    attends : bool
        Whether anybody is there.
    """

    attends: bool

    def say(self, words: str) -> None:
        """Tell what happens now."""

    def confirm(self, question: str) -> bool | None:
        """Ask; None if nobody is there."""


class AtTerminal:
    """Somebody at the keyboard; implements `Person`.

    Attributes
    ----------
    attends : bool
    """

    attends = True

    def say(self, words: str) -> None:
        """Write a line to stderr."""
        print(words, file=sys.stderr, flush=True)

    def confirm(self, question: str) -> bool | None:
        """Ask until yes or no is typed; None at the end of the input."""
        while True:
            print(f"{question} [y/n] ", end="", file=sys.stderr, flush=True)
            line = sys.stdin.readline()
            if not line:
                return None
            answer = line.strip().lower()
            if answer in ("y", "yes", "n", "no"):
                return answer.startswith("y")
            print_error(f"y or n, got {answer!r}")


class Nobody:
    """Nobody is there; implements `Person`.

    Attributes
    ----------
    attends : bool
    """

    attends = False

    def say(self, words: str) -> None:
        """Write a line to stderr all the same: it may be kept in a log."""
        print(words, file=sys.stderr, flush=True)

    def confirm(self, question: str) -> bool | None:  # noqa: ARG002 - nobody hears it
        """Return None."""
        return None


def somebody(unattended: bool) -> Person:
    """Return who can be asked: nobody without a terminal.

    Parameters
    ----------
    unattended : bool
        Whether nobody shall be asked.
    """
    return Nobody() if unattended or sys.stdin is None or not sys.stdin.isatty() else AtTerminal()
