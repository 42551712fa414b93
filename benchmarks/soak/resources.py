"""Memory, file handles and threads of this process at the end of a flight: `measure`, `growth`."""

import gc
import threading
from pathlib import Path
from typing import NamedTuple

import msgspec

from benchmarks.common.resident_memory import resident_mb


class ResourceParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much may be held at the end of a flight; chosen by hand.

    Parameters
    ----------
    warm_up : float
        Simulated time whose flights say what is normal, s: whatever is loaded and compiled late is there by then.
    memory : float
        Growth since then, MB: the allocator keeps some of the largest flight's; a leak of a picture a second is 1 GB
        in an hour.
    """

    warm_up: float = 300.0
    memory: float = 100.0


class Resources(NamedTuple):
    """What a process holds.

    Attributes
    ----------
    memory : float
        Resident size, MB.
    handles : int
        Open files; 0 where nobody tells.
    threads : int
        All threads of the process, those of libraries too, where the system tells; else those of Python.
    """

    memory: float
    handles: int
    threads: int


def measure() -> Resources:
    """Collect garbage and count what is left."""
    gc.collect()
    handles, tasks = Path("/proc/self/fd"), Path("/proc/self/task")
    return Resources(
        resident_mb(),
        len(list(handles.iterdir())) - 1 if handles.exists() else 0,  # without the one that lists them
        len(list(tasks.iterdir())) if tasks.exists() else threading.active_count(),
    )


def largest(first: Resources, second: Resources) -> Resources:
    """Return the larger of each."""
    return Resources(
        max(first.memory, second.memory), max(first.handles, second.handles), max(first.threads, second.threads)
    )


def growth(normal: Resources, now: Resources, limits: ResourceParameters) -> str:
    """Say what has grown beyond its limit; empty if nothing has.

    Parameters
    ----------
    normal : Resources
        The most of each at the end of the flights of the warm-up.
    now : Resources
        At the end of a later flight.
    limits : ResourceParameters
    """
    if now.memory > normal.memory + limits.memory:
        return f"memory grew from {normal.memory:.0f} to {now.memory:.0f} MB"
    if now.handles > normal.handles:
        return f"open files grew from {normal.handles} to {now.handles}"
    if now.threads > normal.threads:
        return f"threads grew from {normal.threads} to {now.threads}"
    return ""
