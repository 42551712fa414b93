"""Where results are kept: a folder, or what a URL of fsspec names, S3 and others (`store_at`)."""

import contextlib
import errno
import os
import shutil
import tempfile
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol

from matchset.image.files.whole_file import write_whole

RUN, LOG = "run.json", "log.txt"
UNFINISHED = ".unfinished"
MARK = "batch-mark"  # format: file at a URL, which says whose workers may write
TAKEN = errno.ENOTEMPTY, errno.EEXIST  # format: a folder has that name


class SupersededError(ValueError):
    """Another batch has begun to write to the same place, or this one has ended.

    Parameters
    ----------
    out : str
        The place.
    """

    def __init__(self, out: str) -> None:
        super().__init__(f"another batch writes into {out} now")
        self.out = out

    def __reduce__(self) -> tuple[type["SupersededError"], tuple[str]]:
        return SupersededError, (self.out,)


class Store(Protocol):
    """A place for results. Names have slashes and begin at it.

    What workers write for a batch they write under its mark. Once the next batch has begun, nothing is kept any more
    for the one before, whichever of its workers are still at it.

    Attributes
    ----------
    ignores_case : bool
        Whether a name in upper case is the same there as in lower case, while a batch writes.
    """

    @property
    def ignores_case(self) -> bool:
        """See above."""
        ...

    def begun(self, mark: str) -> contextlib.AbstractContextManager[None]:
        """Let workers write for the batch of this mark from now on, until the block ends, and for no other."""
        ...

    def is_current(self) -> bool:
        """Whether the batch of this store's mark is the one that may write."""
        ...

    def unfinished(self) -> contextlib.AbstractContextManager[Path]:
        """Make an empty folder of this computer for what is being written, for it alone; it is gone afterwards."""
        ...

    def keep(self, folder: Path, name: str) -> None:
        """Keep all files of a folder under a name, in place of what was there; `run.json` comes last.

        Raises
        ------
        SupersededError, OSError
            If the batch is not the current one any more; nothing is changed then.
        """
        ...

    def read(self, name: str) -> bytes | None:
        """Return what a file holds; None if there is none."""
        ...

    def write(self, name: str, data: bytes) -> None:
        """Write a file whole."""
        ...

    def put(self, path: Path, name: str) -> None:
        """Keep a file of an unfinished folder under a name."""
        ...

    def remove(self, folder: str) -> None:
        """Remove a folder, if it is there."""
        ...

    def names(self, folder: str) -> list[str]:
        """Return the files of a folder, by their own names, in order; none if there is none."""
        ...


class FolderStore:
    """Results in a folder of this computer, or of a disk that it shares.

    Whatever a worker writes lies in a folder of its batch, and gets its name from there, at once. The next batch takes
    that folder away before it does anything else: nothing can get a name from there any more. A client of NFS that
    answers from memory changes nothing about that: its server knows no folder that was removed.

    Parameters
    ----------
    path : Path
    mark : str
        Of the batch; empty for one that only reads, or has not begun.
    """

    def __init__(self, path: Path, mark: str = "") -> None:
        self.path, self._mark = path, mark

    @contextlib.contextmanager
    def begun(self, mark: str) -> Iterator[None]:
        """See `Store`."""
        self._end_others()
        self._mark = mark
        self._own.mkdir(parents=True)
        try:
            yield
        finally:
            self._end(self._own)

    def _end_others(self) -> None:
        try:
            for each in list((self.path / UNFINISHED).iterdir()):
                self._end(each)
        except FileNotFoundError:  # it is the first batch, or the one before has ended meanwhile
            pass
        except OSError as error:
            raise ValueError(f"cannot end the batch before in {self.path}: {error.strerror}") from None

    def _end(self, own: Path) -> None:
        gone = own.with_name(f"gone-{uuid.uuid4().hex}")
        with contextlib.suppress(FileNotFoundError):
            own.rename(gone)  # from here on whoever writes there finds nothing
        shutil.rmtree(gone, ignore_errors=True)

    def is_current(self) -> bool:
        """See `Store`."""
        return self._own.is_dir()

    @property
    def ignores_case(self) -> bool:
        """See `Store`."""
        return (self.path / UNFINISHED.upper()).is_dir()

    @property
    def _own(self) -> Path:
        return self.path / UNFINISHED / (self._mark or "none")

    @contextlib.contextmanager
    def unfinished(self) -> Iterator[Path]:
        """See `Store`; on the same disk, so that it can be given its name at once."""
        folder = self._own / uuid.uuid4().hex
        folder.mkdir()
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def keep(self, folder: Path, name: str) -> None:
        """See `Store`."""
        place = self.path / name
        place.parent.mkdir(parents=True, exist_ok=True)
        while True:
            if os.path.lexists(place):
                if _is_foreign(place):
                    raise ValueError(f"{place} is not of a batch: choose another --out")
                self.remove(name)
            try:
                folder.rename(place)
            except OSError as error:  # another worker that was given the same video has kept its results just now
                if error.errno not in TAKEN or not folder.is_dir():
                    raise
            else:
                return

    def read(self, name: str) -> bytes | None:
        """See `Store`."""
        try:
            return (self.path / name).read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            return None

    def write(self, name: str, data: bytes) -> None:
        """See `Store`."""
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, data)

    def put(self, path: Path, name: str) -> None:
        """See `Store`."""
        path.replace(self.path / name)

    def remove(self, folder: str) -> None:
        """See `Store`; from its place at once, and never for a batch that has ended."""
        aside = self._own / f"{uuid.uuid4().hex}-old"
        with contextlib.suppress(FileNotFoundError):
            (self.path / folder).rename(aside)
        shutil.rmtree(aside, ignore_errors=True)

    def names(self, folder: str) -> list[str]:
        """See `Store`."""
        try:
            return sorted(each.name for each in (self.path / folder).iterdir() if each.is_file())
        except (FileNotFoundError, NotADirectoryError):
            return []


def _is_foreign(place: Path) -> bool:
    """Whether something is not of a batch, so not ours to replace; looked at twice: a worker may just replace it."""
    return all(os.path.lexists(place) and not (place / RUN).is_file() for _ in range(2))


class RemoteStore:
    """Results at a URL that fsspec knows, such as s3://bucket/results.

    There nothing gets its name at once. So a worker looks before it writes whether its batch is the current one, and
    once more before `run.json`, which comes last and says that the others are whole, and what the table's check sum is.

    Parameters
    ----------
    url : str
    mark : str
        As of `FolderStore`.

    Raises
    ------
    ValueError
        If fsspec, or what it needs for this kind of URL, is not installed.
    """

    ignores_case = False

    def __init__(self, url: str, mark: str = "") -> None:
        self._url, self._mark = url, mark
        try:
            import fsspec
        except ImportError:
            raise ValueError(f"{url} needs fsspec: pip install fsspec") from None
        try:
            self._files: Any
            self._files, self._root = fsspec.core.url_to_fs(url)
        except (ImportError, ValueError) as error:
            raise ValueError(f"{url}: {error}") from None

    @contextlib.contextmanager
    def begun(self, mark: str) -> Iterator[None]:
        """See `Store`."""
        self._mark = mark
        self.write(MARK, mark.encode())
        try:
            yield
        finally:
            if self.is_current():
                self._do("rm_file", self._at(MARK))

    def is_current(self) -> bool:
        """See `Store`."""
        return self.read(MARK) == self._mark.encode()

    @contextlib.contextmanager
    def unfinished(self) -> Iterator[Path]:
        """See `Store`."""
        with tempfile.TemporaryDirectory(prefix="matchset-") as name:
            folder = Path(name) / "results"
            folder.mkdir()
            yield folder

    def keep(self, folder: Path, name: str) -> None:
        """See `Store`."""
        paths = [path for path in sorted(folder.iterdir()) if path.name != RUN]
        found = set(self.names(name))
        if found and not found & {RUN, LOG}:
            raise ValueError(f"{self._url}/{name} is not of a batch: choose another --out")
        old = found - {path.name for path in paths}
        self._check()
        for each in sorted(old, key=lambda each: each != RUN):  # what is being replaced is not finished any more
            with contextlib.suppress(FileNotFoundError):  # another worker that was given the same video
                self._do("rm_file", self._at(f"{name}/{each}"))
        logs = [path for path in paths if path.name == LOG]  # first: it says of what is half written whose it is
        if logs:
            self._put(logs, name)
        self._put([path for path in paths if path not in logs], name)
        self._check()
        self._put([folder / RUN], name)

    def _check(self) -> None:
        if not self.is_current():
            raise SupersededError(self._url)

    def read(self, name: str) -> bytes | None:
        """See `Store`."""
        try:
            data: bytes = self._do("cat_file", self._at(name))
        except FileNotFoundError:
            return None
        return data

    def write(self, name: str, data: bytes) -> None:
        """See `Store`."""
        self._make(name.rpartition("/")[0])
        with self._bucket():
            self._do("pipe_file", self._at(name), data)

    def put(self, path: Path, name: str) -> None:
        """See `Store`."""
        self._do("put_file", str(path), self._at(name))

    def _put(self, paths: list[Path], name: str) -> None:
        """Write files, several at once where that is possible."""
        self._make(name)
        with self._bucket():
            self._do("put", list(map(str, paths)), [self._at(f"{name}/{path.name}") for path in paths])

    def _make(self, folder: str) -> None:
        if self._files.root_marker:  # else there are no folders
            self._do("makedirs", self._at(folder), exist_ok=True)

    @contextlib.contextmanager
    def _bucket(self) -> Iterator[None]:
        try:
            yield
        except FileNotFoundError:  # it is not made here: its name may be misspelled
            raise ValueError(f"there is no {self._root.partition('/')[0]!r} for {self._url}: make it first") from None

    def remove(self, folder: str) -> None:
        """See `Store`."""
        self._check()
        with contextlib.suppress(FileNotFoundError):
            self._do("rm", self._at(folder), recursive=True)

    def names(self, folder: str) -> list[str]:
        """See `Store`."""
        self._files.invalidate_cache()  # what other processes have written
        try:
            found = self._do("ls", self._at(folder), detail=False)
        except FileNotFoundError:
            return []
        return sorted(str(each).rstrip("/").rsplit("/", 1)[-1] for each in found)

    def _do(self, name: str, *words: Any, **named: Any) -> Any:
        """Call a method of the file system; each has errors of its own."""
        try:
            return getattr(self._files, name)(*words, **named)
        except FileNotFoundError:
            raise
        except Exception as error:  # no credentials, no connection, ...
            words_of = " ".join(str(error).split()) or type(error).__name__
            raise OSError(getattr(error, "errno", None) or errno.EIO, words_of, self._url) from None

    def _at(self, name: str) -> str:
        return f"{self._root}/{name}".rstrip("/")


def store_at(out: str, mark: str = "") -> Store:
    """Return the store that `--out` names, for the batch of a mark."""
    return RemoteStore(out, mark) if "://" in out else FolderStore(Path(os.path.normpath(Path(out).absolute())), mark)
