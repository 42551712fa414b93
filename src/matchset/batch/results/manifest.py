"""What has ended so far, a line for each video, appended as it ends: `Manifest`, `manifest.jsonl`."""

import contextlib
import errno
import os
import re
import secrets
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import msgspec

from matchset.app.exit_codes import print_note
from matchset.batch.jobs.identity import done_key
from matchset.batch.jobs.job import DONE, VideoOutcome
from matchset.batch.results.store import FolderStore, Store
from matchset.media.closing import Closing

FORMAT = 1  # format: of the manifest
FILE, PARTS = "manifest.jsonl", "manifest"
PART = re.compile(r"\d{8}(-[0-9a-f]{8})?\.jsonl")


class ManifestParameters(msgspec.Struct, frozen=True):
    """How a manifest is kept where nothing can be appended to a file.

    Parameters
    ----------
    lines : int
        Lines in a part. Fewer: less is asked of the workers again after a power loss; more: fewer files. What is in no
        part is known by the results themselves.
    """

    lines: int = 50


PARAMETERS = ManifestParameters()


class Heading(msgspec.Struct, frozen=True, kw_only=True):
    """The first line of a manifest.

    Parameters
    ----------
    matchset_batch : int
        Its format.
    root : str
        Folder that the videos have in common: their names in the results begin there.
    """

    matchset_batch: int
    root: str


class Manifest(Closing):
    """Knows which videos are finished; a line cut in half, as by a power loss, is dropped, and its video done again.

    Parameters
    ----------
    store : Store
    root : Path
        What the videos have in common, for a new manifest; an old one has its own.

    Attributes
    ----------
    root : Path

    Raises
    ------
    ValueError
        If there is a manifest of another format.
    """

    def __init__(self, store: Store, root: Path) -> None:
        self._store, self._waiting, self._parts = store, list[bytes](), 0
        self._own = secrets.token_hex(4)  # of the names of parts: a batch that slept takes none of the next one's
        self._ended: dict[int, tuple[bytes, bool]] = {}  # of each folder the last: what it was, and whether it is done
        self._dropped = 0
        heading: Heading | None = None
        for line in self._lines():
            if heading is None:
                heading = _heading(line)
                continue
            outcome = _outcome(line)
            if outcome is None:
                self._dropped += 1
            else:
                self._note(outcome)
        self.root = root if heading is None else Path(heading.root)
        if self._dropped:
            print_note(f"{self._dropped} lines of the manifest cannot be read: those videos are looked at again")
        self._file: int | None = None
        if isinstance(store, FolderStore):
            self._file = _opened(store.path / FILE)
        if heading is None:
            self._write(msgspec.json.encode(Heading(matchset_batch=FORMAT, root=str(root))))

    def is_done(self, outcome: VideoOutcome, failed_too: bool) -> bool:
        """Whether a video has ended, as it is now and with these settings.

        Parameters
        ----------
        outcome : VideoOutcome
            With its name, folder, size, time of change and settings as they are now.
        failed_too : bool
            Whether one that failed counts.
        """
        key, done = self._ended.get(hash(outcome.folder), (b"", False))
        return key == key_of(outcome) and (done or failed_too)

    def append(self, outcome: VideoOutcome) -> None:
        """Note what became of a video.

        Raises
        ------
        OSError
            If it does not fit on the disk.
        """
        self._note(outcome)
        self._write(msgspec.json.encode(outcome))

    @contextlib.contextmanager
    def by_folder(self) -> Iterator["KeptOutcomes"]:
        """Give access to the outcomes by the folders of the videos."""
        self._flush()
        with tempfile.TemporaryFile() as copy:
            for line in self._lines():
                copy.write(line.rstrip(b"\n") + b"\n")
            yield KeptOutcomes(copy)

    def close(self) -> None:
        """Write what waits, and close the file."""
        self._flush()
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def _note(self, outcome: VideoOutcome) -> None:
        if outcome.state == "stopped":  # what was noted of it does not hold any more
            self._ended.pop(hash(outcome.folder), None)
        else:
            self._ended[hash(outcome.folder)] = key_of(outcome), outcome.state in DONE

    def _write(self, line: bytes) -> None:
        if self._file is not None:
            _append(self._file, line + b"\n")
            return
        self._waiting.append(line + b"\n")
        if len(self._waiting) >= PARAMETERS.lines:
            self._flush()

    def _flush(self) -> None:
        if self._waiting and self._file is None:
            self._store.write(f"{PARTS}/{self._parts:08d}-{self._own}.jsonl", b"".join(self._waiting))
            self._parts, self._waiting = self._parts + 1, []

    def _lines(self) -> Iterator[bytes]:
        """Yield the lines that are whole."""
        if isinstance(self._store, FolderStore):
            path = self._store.path / FILE
            if path.is_file():
                with path.open("rb") as file:
                    yield from (line for line in file if line.endswith(b"\n"))
            return
        for name in filter(PART.fullmatch, self._store.names(PARTS)):
            self._parts = max(self._parts, int(name[:8]) + 1)
            yield from (self._store.read(f"{PARTS}/{name}") or b"").splitlines()


class KeptOutcomes:
    """The outcomes in a manifest by their folders; only places in the file are kept in memory.

    Parameters
    ----------
    file : file
        Of its lines.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._file, self._places = file, dict[int, int]()
        file.seek(0)
        place = 0
        for line in file:
            outcome = _outcome(line)
            if outcome is not None:
                self._places[hash(outcome.folder)] = place
            place += len(line)

    def last(self, folder: str) -> VideoOutcome | None:
        """Return what became of a video last; None if it has not ended."""
        place = self._places.get(hash(folder))
        if place is None:
            return None
        self._file.seek(place)
        return _outcome(self._file.readline())


def key_of(outcome: VideoOutcome) -> bytes:
    """Return what a video that has ended is known by."""
    return done_key(outcome.video, outcome.size, outcome.modified, outcome.settings)


def _opened(path: Path) -> int:
    """Open a manifest to append to it; half a line at its end is cut off."""
    file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
    size = os.fstat(file).st_size
    place = size
    while place:
        begin = max(place - 65536, 0)  # format: bytes that are looked at at once
        os.lseek(file, begin, os.SEEK_SET)
        found = os.read(file, place - begin).rfind(b"\n")
        if found >= 0:
            place = begin + found + 1
            break
        place = begin
    if place != size:
        os.ftruncate(file, place)
    return file


def _append(file: int, line: bytes) -> None:
    """Append a line whole, or not at all."""
    size = os.fstat(file).st_size
    try:
        if os.write(file, line) < len(line):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    except OSError as error:
        os.ftruncate(file, size)
        raise OSError(error.errno, error.strerror, FILE) from None


def _heading(line: bytes) -> Heading:
    try:
        heading = msgspec.json.decode(line, type=Heading)
    except msgspec.MsgspecError:
        raise ValueError(f"{FILE} is not a manifest of a batch: {line[:60]!r}") from None
    if heading.matchset_batch != FORMAT:
        raise ValueError(f"{FILE} is of format {heading.matchset_batch}, this program knows {FORMAT}")
    return heading


def _outcome(line: bytes) -> VideoOutcome | None:
    try:
        return msgspec.json.decode(line, type=VideoOutcome)
    except msgspec.MsgspecError:
        return None
