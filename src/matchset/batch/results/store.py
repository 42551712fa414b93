"""Where results are kept: a folder, or what a URL of fsspec names, S3 and others (`store_at`)."""

import contextlib
import os
import shutil
import tempfile
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol

from matchset.image.files.whole_file import write_whole

RUN = "run.json"
UNFINISHED = ".unfinished"


class Store(Protocol):
    """A place for results. Names have slashes and begin at it."""

    def clear(self) -> None:
        """Remove what a batch that was killed was writing."""
        ...

    def unfinished(self) -> contextlib.AbstractContextManager[Path]:
        """Make an empty folder of this computer for what is being written; it is gone afterwards."""
        ...

    def keep(self, folder: Path, name: str) -> None:
        """Keep all files of a folder under a name, in place of what was there; `run.json` comes last."""
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

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def clear(self) -> None:
        """See `Store`."""
        shutil.rmtree(self.path / UNFINISHED, ignore_errors=True)

    @contextlib.contextmanager
    def unfinished(self) -> Iterator[Path]:
        """See `Store`; on the same disk, so that it can be given its name at once."""
        folder = self.path / UNFINISHED / uuid.uuid4().hex
        folder.mkdir(parents=True)
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def keep(self, folder: Path, name: str) -> None:
        """See `Store`."""
        place = self.path / name
        place.parent.mkdir(parents=True, exist_ok=True)
        if place.exists():
            if not (place / RUN).is_file():  # whatever that is, it is not ours to replace
                raise ValueError(f"{place} is not of a batch: choose another --out")
            place.replace(folder.with_name(folder.name + "-old"))
        folder.replace(place)
        shutil.rmtree(folder.with_name(folder.name + "-old"), ignore_errors=True)

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
        """See `Store`."""
        shutil.rmtree(self.path / folder, ignore_errors=True)

    def names(self, folder: str) -> list[str]:
        """See `Store`."""
        try:
            return sorted(each.name for each in (self.path / folder).iterdir() if each.is_file())
        except (FileNotFoundError, NotADirectoryError):
            return []


class RemoteStore:
    """Results at a URL that fsspec knows, such as s3://bucket/results.

    Parameters
    ----------
    url : str

    Raises
    ------
    ValueError
        If fsspec, or what it needs for this kind of URL, is not installed.
    """

    def __init__(self, url: str) -> None:
        try:
            import fsspec
        except ImportError:
            raise ValueError(f"{url} needs fsspec: pip install fsspec") from None
        try:
            self._files: Any
            self._files, self._root = fsspec.core.url_to_fs(url)
        except (ImportError, ValueError) as error:
            raise ValueError(f"{url}: {error}") from None

    def clear(self) -> None:
        """See `Store`; it lies in a folder of that computer, which is gone with its time."""

    @contextlib.contextmanager
    def unfinished(self) -> Iterator[Path]:
        """See `Store`."""
        with tempfile.TemporaryDirectory(prefix="matchset-") as name:
            folder = Path(name) / "results"
            folder.mkdir()
            yield folder

    def keep(self, folder: Path, name: str) -> None:
        """See `Store`."""
        paths = sorted(folder.iterdir(), key=lambda path: (path.name == RUN, path.name))
        old = set(self.names(name)) - {path.name for path in paths}
        if RUN in self.names(name):  # what is being replaced is not finished any more
            self._files.rm_file(self._at(f"{name}/{RUN}"))
        for each in old - {RUN}:
            self._files.rm_file(self._at(f"{name}/{each}"))
        for path in paths:
            self.write(f"{name}/{path.name}", path.read_bytes())

    def read(self, name: str) -> bytes | None:
        """See `Store`."""
        try:
            data: bytes = self._files.cat_file(self._at(name))
        except FileNotFoundError:
            return None
        return data

    def write(self, name: str, data: bytes) -> None:
        """See `Store`."""
        path = self._at(name)
        self._files.makedirs(path.rsplit("/", 1)[0], exist_ok=True)
        self._files.pipe_file(path, data)

    def put(self, path: Path, name: str) -> None:
        """See `Store`."""
        self._files.put_file(str(path), self._at(name))

    def remove(self, folder: str) -> None:
        """See `Store`."""
        with contextlib.suppress(FileNotFoundError):
            self._files.rm(self._at(folder), recursive=True)

    def names(self, folder: str) -> list[str]:
        """See `Store`."""
        try:
            found = self._files.ls(self._at(folder), detail=False)
        except FileNotFoundError:
            return []
        return sorted(str(each).rstrip("/").rsplit("/", 1)[-1] for each in found)

    def _at(self, name: str) -> str:
        return f"{self._root}/{name}"


def store_at(out: str) -> Store:
    """Return the store that `--out` names."""
    return RemoteStore(out) if "://" in out else FolderStore(Path(os.path.normpath(Path(out).absolute())))
