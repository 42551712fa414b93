"""Which program this is, and which video that is: `code_digest`, `content_digest`, `stat_of`, `problem_of`."""

import functools
import hashlib
import os
import platform
import re
import socket
import stat
import zlib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

DECIDING = ".py", ".npz", ".toml"  # format: endings of files of the package that decide about answers
APART = re.compile(r"(live|flight|sharing)/|cli\.py|batch/(?!jobs/|split/)")  # format: on these no result depends
PIECE = 1 << 20  # format: bytes of a video that are read at once
PACKAGE = Path(__file__).parents[2]


@functools.cache
def code_digest(every: bool = True) -> str:
    """Return the version of this program, and a check sum of its sources, its data and the versions of libraries.

    Parameters
    ----------
    every : bool
        Whether of all sources, which must be the same in all workers; else of those on which results depend.
    """
    digest = hashlib.sha256()
    for path in sorted(path for path in PACKAGE.rglob("*") if path.suffix in DECIDING):
        name = path.relative_to(PACKAGE).as_posix()
        if every or not APART.match(name):
            digest.update(name.encode() + b"\0" + path.read_bytes())
    import cv2  # of whichever package it is

    libraries = [f"{name} {_version(name)}" for name in ("numpy", "scipy", "numba", "av")]
    libraries.append(f"cv2 {cv2.__version__}")
    digest.update(repr(libraries).encode())
    return f"{_version('matchset')} {digest.hexdigest()[:16]}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "none"


def content_digest(video: str) -> str:
    """Return the check sum of a video, CRC-32; of a folder of pictures that of their names, sizes and times.

    It only has to tell whether a file of the same name and size was changed: SHA-256 takes four times as long, 4 % of
    what a task takes.
    """
    path = Path(video)
    if path.is_dir():
        stats = [(each.name, *_size_and_time(each)) for each in sorted(path.iterdir())]
        return f"{zlib.crc32(repr(stats).encode()):08x}"
    value, piece = 0, memoryview(bytearray(PIECE))
    with path.open("rb", buffering=0) as file:
        while count := file.readinto(piece):
            value = zlib.crc32(piece[:count], value)
    return f"{value:08x}"


def stat_of(video: str) -> tuple[int, int]:
    """Return size, bytes, and time of the last change, ns, of a video; (0, 0) if it is not there."""
    try:
        return _size_and_time(Path(video))
    except OSError:
        return 0, 0


def problem_of(video: str) -> str:
    """Say why a file cannot be a video: it is not there, or does not end; empty if nothing is known against it."""
    try:
        mode = Path(video).stat().st_mode
    except FileNotFoundError:
        return "no such file"
    except OSError as error:  # such as a link to itself, or a folder that must not be searched
        return error.strerror or type(error).__name__
    return "" if stat.S_ISREG(mode) or stat.S_ISDIR(mode) else "it is a pipe or a device, which does not end"


def _size_and_time(path: Path) -> tuple[int, int]:
    found = path.stat()
    return found.st_size, found.st_mtime_ns


def worker_name() -> str:
    """Return the name of this process: computer and number."""
    return f"{socket.gethostname() or platform.node()}:{os.getpid()}"


def done_key(video: str, size: int, modified: int, settings: str) -> bytes:
    """Return what a finished video is known by."""
    text = "\0".join((video, str(size), str(modified), settings))
    return hashlib.blake2b(os.fsencode(text), digest_size=16).digest()
