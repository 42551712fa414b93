"""Two batches into one folder are refused: `FolderLock`, and `RemoteLock` where there are no locks of files."""

import contextlib
import os
import sys
import threading
import time
from contextlib import AbstractContextManager
from types import TracebackType
from typing import Self

import msgspec

from matchset.batch.jobs.identity import worker_name
from matchset.batch.results.store import FolderStore, Store

LOCK = ".lock"


class LockParameters(msgspec.Struct, frozen=True):
    """When a batch whose results are at a URL counts as dead.

    Parameters
    ----------
    beat : float
        It says so often that it runs, s. Less: more requests.
    dead : float
        After so long without a word another one may go on, s. Less: a slow network is taken for a dead batch.
    """

    beat: float = 15.0
    dead: float = 90.0


PARAMETERS = LockParameters()


class Owner(msgspec.Struct, frozen=True):
    """Who runs a batch: computer and process, and when it said so last, s since 1970."""

    name: str
    time: float = 0.0


class FolderLock:
    """A lock of the operating system, which a killed batch loses.

    Parameters
    ----------
    store : FolderStore

    Raises
    ------
    ValueError
        On `__enter__`, if another batch has it.
    """

    def __init__(self, store: FolderStore) -> None:
        self._path, self._file = store.path / LOCK, -1

    def __enter__(self) -> Self:
        self._file = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _lock(self._file)
        except OSError:
            owner = os.read(self._file, 200).decode(errors="replace").strip()  # format: longer than any name
            os.close(self._file)
            raise ValueError(f"another batch writes into {self._path.parent}: {owner or 'not named'}") from None
        os.ftruncate(self._file, 0)
        os.write(self._file, worker_name().encode())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._file)


def _lock(file: int) -> None:
    """Lock a file, or raise OSError."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


class RemoteLock:
    """A file that says who runs, and when it said so last; a thread says it again and again.

    Parameters
    ----------
    store : Store
    where : str
        For words.
    """

    def __init__(self, store: Store, where: str) -> None:
        self._store, self._where, self._ends = store, where, threading.Event()
        self._thread = threading.Thread(target=self._beat, name="matchset batch lock", daemon=True)

    def _beat(self) -> None:
        while not self._ends.wait(PARAMETERS.beat):
            with contextlib.suppress(OSError):  # the network is away: the next beat says it
                self.beat()

    def beat(self) -> None:
        """Say that it runs, unless another one has taken the place since, as after a long sleep of this computer."""
        if self._owner().name in ("", worker_name()):
            self._say(time.time())

    def _say(self, now: float) -> None:
        self._store.write(LOCK, msgspec.json.encode(Owner(worker_name() if now else "", now)))

    def _owner(self) -> Owner:
        text = self._store.read(LOCK)
        try:
            return Owner("") if text is None else msgspec.json.decode(text, type=Owner)
        except msgspec.MsgspecError:
            return Owner("")

    def __enter__(self) -> Self:
        owner, now = self._owner(), time.time()
        if abs(now - owner.time) < PARAMETERS.dead:
            left = f"if it was killed, this is known in {owner.time + PARAMETERS.dead - now:.0f} s"
            raise ValueError(f"another batch writes into {self._where}: {owner.name}; {left}")
        self._say(now)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ends.set()
        self._thread.join()
        if self._owner().name == worker_name():
            self._say(0.0)


def lock_of(store: Store, where: str) -> AbstractContextManager[object]:
    """Return the lock of a place for results."""
    return FolderLock(store) if isinstance(store, FolderStore) else RemoteLock(store, where)
