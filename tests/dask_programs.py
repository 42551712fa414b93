"""Programs of Dask for the tests of batches: a scheduler, workers."""

import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Iterator

from matchset.batch.workers.worker import THREADS


@contextlib.contextmanager
def started(*words: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Run a program of Dask until the end of the block."""
    one_thread = dict.fromkeys(THREADS, "1")
    process = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli." + words[0], *words[1:]],
        env={**os.environ, **one_thread},
        stderr=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def free_port() -> int:
    """A port that is free now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
