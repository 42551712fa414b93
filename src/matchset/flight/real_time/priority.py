"""The loop runs before the machine's other programs, where the system allows it: `raised_priority`."""

import contextlib
import os
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from matchset.numeric.arguments import require_within


class PriorityParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How far a loop stands before other programs.

    Parameters
    ----------
    level : int
        Real-time priority of Linux, 1 ... 99: above all ordinary programs. More also stands before other real-time
        programs, up to the kernel's own threads at 50 and more. Chosen by hand: below those.
    behind : int
        That of the program's other threads: the loop waits for the one that holds the interpreter's lock, so none of
        them may wait for other programs. More than `level` makes the loop wait for them. Chosen by hand: the least.
    """

    level: int = 5
    behind: int = 1

    def __post_init__(self) -> None:
        require_within(self, {"level": (1, 99), "behind": (1, 99)}, "must be")


class _Scheduling(NamedTuple):
    """How a thread was scheduled before."""

    thread: int
    policy: int
    parameters: Any


@contextlib.contextmanager
def raised_priority(parameters: PriorityParameters | None = None) -> Iterator[bool]:
    """Let the calling thread run as soon as it can, before all ordinary programs; yields whether it does.

    Linux's round-robin scheduling. The threads that the program has when the block begins come right behind this one;
    where there is one core only they stay ordinary. Threads that any of them begins in the block are ordinary, too, as
    those that compress a recording: all that has real-time priority must need much less than the cores have, since
    Linux takes 5 % of each second from it, in one piece, and the kernel's own threads, which carry the bytes of a
    serial port, are ordinary ones. A thread with the same or a higher priority already is left as it is. The system
    allows it to root, to a program with CAP_SYS_NICE, and to a user with a limit of `rtprio`; elsewhere nothing
    changes. For a loop that waits most of the time only: one that never waits would leave nothing to others.

    Parameters
    ----------
    parameters : PriorityParameters, optional
    """
    levels = parameters or PriorityParameters()
    before: list[_Scheduling] = []
    try:
        _raise(before, 0, levels.level)
    except (AttributeError, OSError):  # not Linux; not allowed
        yield False
        return
    for thread in _others() if len(os.sched_getaffinity(0)) > 1 else ():
        with contextlib.suppress(OSError):  # it has ended
            _raise(before, thread, levels.behind)
    try:
        yield True
    finally:
        for each in before:
            _restore(each)


def _raise(before: list[_Scheduling], thread: int, level: int) -> None:
    """Raise a thread, 0 for the calling one, and note how it was."""
    was = _Scheduling(thread, os.sched_getscheduler(thread), os.sched_getparam(thread))
    if was.parameters.sched_priority >= level:  # 0 for ordinary ones
        return
    os.sched_setscheduler(thread, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(level))
    before.append(was)


def _restore(was: _Scheduling) -> None:
    for flag in (0, os.SCHED_RESET_ON_FORK):  # which a user without CAP_SYS_NICE may not take away again
        with contextlib.suppress(OSError):
            os.sched_setscheduler(was.thread, was.policy | flag, was.parameters)
            return


def _others() -> list[int]:
    """List the process's other threads."""
    own = threading.get_native_id()
    return [int(path.name) for path in Path("/proc/self/task").iterdir() if int(path.name) != own]
