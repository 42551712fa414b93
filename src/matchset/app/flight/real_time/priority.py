"""The loop runs before the machine's other programs, where the system allows it: `raised_priority`."""

import contextlib
import os
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec


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
        for name, value in (("level", self.level), ("behind", self.behind)):
            if not 1 <= value <= 99:
                raise ValueError(f"{name} must be 1 ... 99, got {value}")


class _Scheduling(NamedTuple):
    """How a thread was scheduled before."""

    thread: int
    policy: int
    parameters: Any
    cores: set[int]


@contextlib.contextmanager
def raised_priority(parameters: PriorityParameters | None = None) -> Iterator[bool]:
    """Let the calling thread run as soon as it can, before all ordinary programs; yields whether it does.

    Linux's round-robin scheduling. The threads that the program has when the block begins come right behind this one,
    all on one core, since they may have much to do, and the kernel's own threads, which carry the bytes of a serial
    port, are ordinary ones: those keep the other cores. Where there is one core only, the program's other threads stay
    ordinary. Those that the calling thread begins in the block are ordinary, too. The system allows it to root, to a
    program with CAP_SYS_NICE, and to a user with a limit of `rtprio`; elsewhere nothing changes. For a loop that waits
    most of the time only: one that never waits would leave nothing to others.

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
    cores = os.sched_getaffinity(0)
    for thread in _others() if len(cores) > 1 else ():
        with contextlib.suppress(OSError):  # it has ended
            _raise(before, thread, levels.behind)
            os.sched_setaffinity(thread, {max(cores)})
    try:
        yield True
    finally:
        for each in before:
            with contextlib.suppress(OSError):
                os.sched_setscheduler(each.thread, each.policy, each.parameters)
                os.sched_setaffinity(each.thread, each.cores)


def _raise(before: list[_Scheduling], thread: int, level: int) -> None:
    """Raise a thread, 0 for the calling one, and note how it was."""
    was = _Scheduling(thread, os.sched_getscheduler(thread), os.sched_getparam(thread), os.sched_getaffinity(thread))
    policy = os.SCHED_RR if thread else os.SCHED_RR | os.SCHED_RESET_ON_FORK
    os.sched_setscheduler(thread, policy, os.sched_param(level))
    before.append(was)


def _others() -> list[int]:
    """List the process's other threads."""
    own = threading.get_native_id()
    return [int(path.name) for path in Path("/proc/self/task").iterdir() if int(path.name) != own]
