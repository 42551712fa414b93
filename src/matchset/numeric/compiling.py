"""Who is told when a kernel is compiled, not loaded: `WATCHERS`. Imports nothing, so that it costs nothing to watch."""

from collections.abc import Callable

WATCHERS: list[Callable[[], None]] = []
"""Called without arguments before each kernel that Numba compiles, as there is no code kept of it."""


def compiling() -> None:
    """Tell all watchers that a kernel is about to be compiled."""
    for watcher in WATCHERS:
        watcher()
