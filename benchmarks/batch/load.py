"""How busy other programs keep the machine meanwhile: `Others`."""

import os
import time
from pathlib import Path
from typing import Self

TICKS = os.sysconf("SC_CLK_TCK")  # format: of /proc, 1/s


class Others:
    """Measures, from `with` to its end, the share of all processors that programs not started from here use.

    Attributes
    ----------
    share : float or None
        0 ... 1; None where there is no /proc.
    seconds : float
        How long it was measured.
    """

    def __enter__(self) -> Self:
        self.share: float | None = None
        self._begun, self._busy, self._own = time.monotonic(), _busy(), _own()
        self.seconds = 0.0
        return self

    def __exit__(self, *_: object) -> None:
        self.seconds = time.monotonic() - self._begun
        busy, own = _busy(), _own()
        if busy is not None and self._busy is not None:
            foreign = busy - self._busy - (own - self._own)
            self.share = max(foreign, 0.0) / (self.seconds * (os.cpu_count() or 1))


def _busy() -> float | None:
    """Time that all processors have worked, s."""
    try:
        words = Path("/proc/stat").read_text(encoding="ascii").partition("\n")[0].split()
    except OSError:
        return None
    user, nice, system, _, _, interrupts, soft, stolen = (int(word) for word in words[1:9])
    return (user + nice + system + interrupts + soft + stolen) / TICKS


def _own() -> float:
    """Time that this process, those of its group, and their children that have ended, have worked, s."""
    ticks, group = 0, os.getpgrp()
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = path.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        except OSError:
            continue
        if int(words[2]) == group:
            ticks += sum(int(word) for word in words[11:15])
    return ticks / TICKS
