"""Machine code of kernels that is kept on disk: `KeptCode`, of which source it is, `source_stamp`, and where.

A loss of power leaves files cut short or filled with zeros, which nobody may run. So each file says how long it is and
what the checksum of its content is. What does not fit is removed, compiled anew and said once, in the log of the name
"matchset" (on stderr, where no other handler is set). Where nothing can be written kernels run all the same.
"""

import contextlib
import functools
import hashlib
import logging
import os
import pickle
import re
import shutil
import uuid
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import platformdirs

MAGIC = b"matchset kept code 1\n"  # format: how a file begins
CHECKSUM = 16  # format: bytes of it, behind the beginning
_SAID: set[str] = set()

PACKAGE = Path(__file__).parent.parent
_IMPORT = re.compile(r"^\s*from (matchset[\w.]*) import (\([^)]*\)|[^\n]*)|^\s*import (matchset[\w.]+)", re.MULTILINE)


@functools.cache
def source_stamp(file: Path) -> int:
    """Checksum of a source file and of all files of the package that it imports, directly or not.

    Parameters
    ----------
    file : Path
        The file that a kernel stands in; it need not be of the package.

    Returns
    -------
    int
        Changes with any source that can change the kernel's machine code.
    """
    seen: dict[Path, int] = {}
    waiting = [file.resolve()]
    while waiting:
        path = waiting.pop()
        if path not in seen:
            seen[path], imported = _read_source(path)
            waiting.extend(imported)
    return zlib.crc32(repr([(path.name, seen[path]) for path in sorted(seen)]).encode())


@functools.cache
def _read_source(path: Path) -> tuple[int, tuple[Path, ...]]:
    """Checksum of one file, and the files of the package that it imports."""
    text = path.read_bytes()
    imported = []
    for package, names, module in _IMPORT.findall(text.decode()):
        folder = PACKAGE.joinpath(*(package or module).split(".")[1:])
        candidates = [folder, *(folder / name for name in re.findall(r"\w+", names))]
        imported += [found for each in candidates if (found := each.with_suffix(".py")).is_file()]
    return zlib.crc32(text), tuple(imported)


def kept_root() -> Path:
    """Return the folder of all kept code, one for every copy of the package that this user runs.

    Returns
    -------
    Path
        What the environment variable NUMBA_CACHE_DIR names, or else the user's folder for caches: on Linux
        ``~/.cache/matchset/kernels``.
    """
    named = os.environ.get("NUMBA_CACHE_DIR")
    return Path(named) if named else platformdirs.user_cache_path("matchset", appauthor=False) / "kernels"


def kept_folder(file: Path, stamp: int) -> Path:
    """Return the folder of the code of one source file as it is now.

    Parameters
    ----------
    file : Path
        The source, of the package or a user's own.
    stamp : int
        Of its content and of what it imports. Copies of one source in different places share their folder, and a
        source that has changed has another one.
    """
    parts = file.relative_to(PACKAGE).with_suffix("").parts if PACKAGE in file.parents else (file.stem,)
    return kept_root() / f"{'.'.join(parts)}-{stamp:08x}"


def make_kept_folder(folder: Path, versions: int = 6) -> None:
    """Make the folder of a source file, and remove those of its older versions that nothing was added to for longest.

    Parameters
    ----------
    folder : Path
        As `kept_folder` returns it.
    versions : int, default 6
        How many of one source file are left: fewer take less disk, more let several copies of the package, of
        different versions, run by turns without compiling.

    Raises
    ------
    OSError
        If it cannot be made.
    """
    if folder.is_dir():
        return
    folder.mkdir(parents=True, exist_ok=True)
    name = folder.name.rpartition("-")[0]
    with contextlib.suppress(OSError):  # another process may remove them too
        others = [other for other in folder.parent.glob(f"{name}-????????") if other != folder]
        for other in sorted(others, key=_changed, reverse=True)[versions - 1 :]:
            shutil.rmtree(other, ignore_errors=True)


def _changed(folder: Path) -> float:
    return folder.stat().st_mtime


def say_once(kind: str, words: str) -> None:
    """Write a line to the log, the first time that something of this kind happens in the process."""
    if kind not in _SAID:
        _SAID.add(kind)
        logging.getLogger("matchset").warning(words)


def _checksum(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=CHECKSUM).digest()


class KeptCode:
    """Files of one function: an index, from the types of the arguments to the file with their code, and those files.

    It takes the place of Numba's own, which trusts what it reads.

    Parameters
    ----------
    folder : Path
        Where they are.
    name : str
        How their names begin.
    stamp : object
        Of source and compiler: what was kept under another one counts for nothing.
    dump : callable
        From what Numba keeps to bytes that `pickle` reads.
    """

    def __init__(self, folder: Path, name: str, stamp: object, dump: Callable[[Any], bytes]) -> None:
        self.folder, self.name, self.stamp, self._dump = folder, name, stamp, dump
        self.index = folder / f"{name}.nbi"

    def load(self, key: object) -> Any:
        """Code that was kept under a key, as it was handed to `save`; None if there is none."""
        name = self._read_index().get(key)
        found = None if name is None else self._read(self.folder / name)
        if found is None:
            return None
        stamp, own, code = found
        return code if stamp == self.stamp and own == key else None  # two processes may have written at once

    def save(self, key: object, code: object) -> None:
        """Keep code; what is left of an older source is removed first, so that nobody finds it under the new key.

        Raises
        ------
        OSError
            If it cannot be written; then nothing is kept under this key.
        """
        names = self._read_index()
        if not names:
            self.clear()
        if key not in names:
            taken = set(names.values())
            names[key] = next(name for k in range(1, len(taken) + 2) if (name := f"{self.name}.{k}.nbc") not in taken)
            self._write(self.index, (self.stamp, names))
        self._write(self.folder / names[key], (self.stamp, key, code))

    def discard(self, key: object, error: Exception) -> None:
        """Remove code that could be read and was of no use, and say so."""
        name = self._read_index().get(key)
        if name is not None:
            self._remove_damaged(self.folder / name, f"{type(error).__name__}: {error}")

    def flush(self) -> None:
        """Forget all that was kept."""
        self.clear()
        self.index.unlink(missing_ok=True)

    def clear(self) -> None:
        """Remove all code, but not the index."""
        for path in self.folder.glob(f"{self.name}.*.nbc"):
            path.unlink(missing_ok=True)

    def _read_index(self) -> dict[Any, str]:
        """Names of the files, empty if there is no index or it is of another source."""
        found = self._read(self.index)
        if found is None:
            return {}
        stamp, names = found
        return dict(names) if stamp == self.stamp else {}

    def _read(self, path: Path) -> Any:
        """Content of a file, None if it is not there; one that is damaged is removed."""
        try:
            whole = path.read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            say_once("read", f"kept machine code is not read: {error}; kernels are compiled anew")
            return None
        begin, content = whole[: len(MAGIC) + CHECKSUM], whole[len(MAGIC) + CHECKSUM :]
        if begin[:1] == pickle.PROTO:  # as Numba itself writes them: of a version before this one
            return None
        if begin != MAGIC + _checksum(content):
            self._remove_damaged(path, "cut short, or its checksum differs")
            return None
        try:
            return pickle.loads(content)
        except Exception as error:  # of a library that is not there anymore, for one
            self._remove_damaged(path, f"{type(error).__name__}: {error}")
            return None

    def _remove_damaged(self, path: Path, why: str) -> None:
        say_once("damaged", f"kept machine code is damaged and compiled anew: {path} ({why}); others are not listed")
        with contextlib.suppress(OSError):  # of a folder that nobody may write: compiled anew each time
            path.unlink()

    def _write(self, path: Path, content: object) -> None:
        data = self._dump(content)
        with _replacing(path) as file:
            file.write(MAGIC + _checksum(data) + data)


@contextlib.contextmanager
def _replacing(path: Path) -> Iterator[Any]:
    """Open a new file that takes the place of another at the end: nobody sees half of it."""
    new = path.with_name(f"{path.name}.tmp.{uuid.uuid4().hex[:16]}")
    try:
        with new.open("xb") as file:
            yield file
        new.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            new.unlink()
        raise
