"""The loop runs before the machine's other programs, where the system allows it: `raised_priority`."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import msgspec


class PriorityParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How far a loop stands before other programs.

    Parameters
    ----------
    level : int
        Real-time priority of Linux, 1 ... 99: above all ordinary programs. More also stands before other real-time
        programs, up to the kernel's own threads at 50 and more. Chosen by hand: below those.
    """

    level: int = 5

    def __post_init__(self) -> None:
        if not 1 <= self.level <= 99:
            raise ValueError(f"level must be 1 ... 99, got {self.level}")


@contextmanager
def raised_priority(parameters: PriorityParameters | None = None) -> Iterator[bool]:
    """Let the calling thread run as soon as it can, before all ordinary programs; yields whether it does.

    Linux's round-robin scheduling. Threads and processes that are begun in the block are ordinary ones. The system
    allows it to root, to a program with CAP_SYS_NICE, and to a user with a limit of `rtprio`; elsewhere nothing
    changes. For a loop that waits most of the time only: one that never waits would leave nothing to others.

    Parameters
    ----------
    parameters : PriorityParameters, optional
    """
    level = (parameters or PriorityParameters()).level
    try:
        before = os.sched_getscheduler(0), os.sched_getparam(0)
        os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(level))
    except (AttributeError, OSError):  # not Linux; not allowed
        yield False
        return
    try:
        yield True
    finally:
        os.sched_setscheduler(0, *before)
