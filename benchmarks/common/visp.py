"""ViSP (GPL) driven in a process of its own: pictures through shared memory, answers through a pipe."""

import math
import mmap
import subprocess
import tempfile
import time
import weakref
from pathlib import Path
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from benchmarks.common.start import Circle3

Gray = npt.NDArray[np.uint8]
DRIVER = Path(__file__).resolve().parents[2] / ".bench" / "visp_driver"


class Visp:
    """A running driver; `picture` is the memory it looks at.

    Parameters
    ----------
    height, width : int
        Size of the picture.

    Raises
    ------
    FileNotFoundError
        If the driver was not built: `.ci/setup-visp` says why.

    Attributes
    ----------
    idle_ns : int
        Time that all of them have spent in the pipe, ns: the round trips less what the driver itself took.
    """

    idle_ns: ClassVar[int] = 0

    def __init__(self, height: int, width: int) -> None:
        if not DRIVER.exists():
            raise FileNotFoundError(f"{DRIVER} was not built")
        folder = "/dev/shm" if Path("/dev/shm").is_dir() else None
        with tempfile.NamedTemporaryFile(dir=folder, prefix="matchset_bench_") as file:
            file.truncate(height * width)
            self.picture: Gray = np.frombuffer(mmap.mmap(file.fileno(), height * width), np.uint8).reshape(
                height, width
            )
            self._process = subprocess.Popen(
                [str(DRIVER), file.name, str(width), str(height)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                bufsize=0,
            )
            self._read()  # "ready": it has opened the file, which may go now
        weakref.finalize(self, self._process.kill)

    def ask(self, words: str) -> Circle3 | None:
        """Send a line and return the circle that comes back, px; None: lost."""
        assert self._process.stdin is not None
        begin = time.perf_counter_ns()
        self._process.stdin.write(words.encode() + b"\n")
        took, *answer = self._read().split()
        Visp.idle_ns += time.perf_counter_ns() - begin - int(took)
        if len(answer) != 3:
            return None
        x, y, radius = (float(number) for number in answer)
        return (x, y, radius) if math.isfinite(x + y + radius) and radius > 0.0 else None

    def _read(self) -> str:
        assert self._process.stdout is not None
        line = bytearray()
        while not line.endswith(b"\n"):
            piece = self._process.stdout.read(256)
            if not piece:
                raise RuntimeError("the ViSP driver has ended")
            line += piece
        return line.decode()
