"""A file that is written whole or not at all: `write_whole`."""

import contextlib
import os
from pathlib import Path


def write_whole(path: Path, data: bytes) -> None:
    """Write a file under another name, wait until it is on the disk, and give it its name.

    A full disk, a killed program and a power loss leave the file that was there before, or none.

    Parameters
    ----------
    path : Path
        Overwritten.
    data : bytes

    Raises
    ------
    OSError
        If it cannot be written; with the file's name.
    """
    partial = path.with_name(path.name + ".part")
    try:
        with partial.open("wb", buffering=0) as file:
            rest = memoryview(data)
            while len(rest):
                rest = rest[file.write(rest) :]
            os.fsync(file.fileno())
        partial.replace(path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
