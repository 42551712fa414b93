"""A stretch of what is shown, in a folder of its own: `PageRecording` writes it in a thread, and no loop waits."""

import threading
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import msgspec

from matchset.app.disk import MB, SPACE, FreeSpace, SpaceParameters
from matchset.flight.real_time.background import Background, BackgroundParameters
from matchset.image.frame import Frame
from matchset.live.feed import Stream, StreamPicture
from matchset.live.record.facts import FACTS, RecordingFacts
from matchset.live.record.state import FinishedRecording, RecordedFile, RecordState
from matchset.live.record.stream_files import FileParameters, StreamFiles
from matchset.media.closing import Closing

SHOWN_SIZE = MB // 10  # format: sizes are told in steps of this, so that the page is not told more than it shows


class RecordingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How what is shown is recorded.

    Parameters
    ----------
    waiting : int
        Pictures that wait for the disk at most; more are dropped, and counted. More outlasts a longer pause of the
        disk, takes the memory of as many pictures, and is what `kill -9` loses if the disk is behind. Chosen by hand: a
        second of a camera of 30 frames/s, 28 MB at 640 x 480.
    memory : float
        MB that these may take at most; fewer wait if pictures are large. Chosen by hand: 8 pictures of 4K.
    look : float
        Time between two looks how large the files are, s. Chosen by hand: what a person reads.
    space : SpaceParameters
        How much of the disk is left free.
    files : FileParameters
    """

    waiting: int = 30
    memory: float = 200.0
    look: float = 0.5
    space: SpaceParameters = SPACE
    files: FileParameters = FileParameters()

    def most_waiting(self, size: int) -> int:
        """Return how many pictures of this size, bytes, may wait."""
        return max(min(self.waiting, int(self.memory * MB / max(size, 1))), 1)


class PageRecording(Closing):
    """Writes each picture with what was found in it.

    It ends by itself, with all files whole, if the disk is nearly full or a file cannot be written.

    Parameters
    ----------
    folder : Path
        Exists, and is empty.
    title : str
        Of what is shown.
    streams : sequence of Stream
        What is recorded; of several, each has a folder of its own.
    parameters : RecordingParameters, optional

    Attributes
    ----------
    folder : Path
    result : FinishedRecording or None
        None as long as files are written.

    Raises
    ------
    ValueError
        If there is no room on the disk.
    """

    def __init__(
        self, folder: Path, title: str, streams: Sequence[Stream], parameters: RecordingParameters | None = None
    ) -> None:
        self.folder, self._parameters = folder, parameters or RecordingParameters()
        self._space = FreeSpace(folder / FACTS, self._parameters.space)
        if self._space.left < 0:
            free = self._space.free
            folder.rmdir()
            raise ValueError(f"nothing can be recorded: only {free:.3g} MB are free on the disk")
        several = [folder / f"camera_{number + 1}" for number in range(len(streams))]
        places = [folder] if len(several) == 1 else several
        files, space = self._parameters.files, self._parameters.space
        self._streams = [StreamFiles(place, number, files, space) for number, place in enumerate(places)]
        self._facts = RecordingFacts(folder / FACTS, title, datetime.now(UTC).isoformat(timespec="milliseconds"))
        self._last: dict[int, Frame] = {}
        self.result: FinishedRecording | None = None
        self._begin, self._looked, self._size, self._problem = time.monotonic(), -1.0, 0, ""
        self._lock, self._finishing = threading.Lock(), threading.Thread(target=self._finish, name="matchset record")
        size = max((seen.frame.image.nbytes for each in streams if (seen := each.seen).frame is not None), default=0)
        waiting = BackgroundParameters(waiting=self._parameters.most_waiting(size))
        self._background: Background[tuple[int, StreamPicture]] = Background(
            "recording", self._write, waiting, self._fail
        )

    def add(self, stream: int, seen: StreamPicture) -> None:
        """Append a picture; never waits. One that was appended before is left out."""
        with self._lock:
            if self.has_ended or seen.frame is None or self._last.get(stream) is seen.frame:
                return
            self._last[stream] = seen.frame
            self._background.add((stream, seen))

    @property
    def has_ended(self) -> bool:
        """Whether nothing is appended any more."""
        return self._finishing.ident is not None

    def end(self) -> None:
        """Append nothing any more; a thread writes what is waiting and closes the files."""
        with self._lock:
            if not self.has_ended:
                self._finishing.start()

    def close(self) -> None:
        """End, and wait until all files are closed."""
        self.end()
        self._finishing.join()

    def state(self) -> RecordState:
        """Return how it goes."""
        seconds, on = time.monotonic() - self._begin, not self.has_ended
        rate = self._size / seconds if seconds > 0.0 else 0.0
        known = on and self._size > 0 and seconds > 2.0 * self._parameters.look
        return RecordState(
            on=on,
            finishing=not on,
            folder=str(self.folder),
            seconds=int(seconds) if on else 0,
            size=self._size // SHOWN_SIZE * SHOWN_SIZE,
            frames=self._frames,
            dropped=self._background.dropped,
            minutes=int(max(self._space.left, 0.0) / rate / 60.0) if known else None,
        )

    @property
    def _frames(self) -> int:
        return sum(files.count for files in self._streams)

    def _write(self, item: tuple[int, StreamPicture]) -> None:
        """Write a picture; in the thread."""
        stream, seen = item
        if stream >= len(self._streams):
            return
        if self._space.left < 0:
            raise self._space.error
        files = self._streams[stream]
        files.write(seen)
        self._facts.note(self._streams)
        now = time.monotonic()
        if now - self._looked > self._parameters.look:
            self._looked, self._size = now, sum(file.size for file in self._files())

    def _fail(self, _: str) -> None:
        """End, since the disk is full or a file cannot be written."""
        self.end()

    def _finish(self) -> None:
        problems = []
        for close in (self._background.close, *(files.close for files in self._streams)):
            try:
                close()
            except Exception as error:  # any: the other files must be closed, too
                problems.append(_words(error))
        if not problems and not self._frames:
            problems.append("no new picture came")
        self._problem = "; ".join(dict.fromkeys(problems))
        dropped = self._background.dropped
        try:
            self._facts.end(self._streams, dropped, self._problem)
        except OSError as error:
            self._problem = "; ".join(filter(None, [self._problem, _words(error)]))
        self.result = FinishedRecording(self.folder.name, self._files(), self._frames, dropped, self._problem)

    def _files(self) -> list[RecordedFile]:
        """All files, tables first."""
        found = (path for path in self.folder.rglob("*") if path.is_file())
        paths = sorted(found, key=lambda path: (path.suffix != ".csv", path))
        return [RecordedFile(path.relative_to(self.folder).as_posix(), path.stat().st_size) for path in paths]


def _words(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{Path(str(error.filename)).name}: {error.strerror}" if error.filename else error.strerror
    return str(error) or type(error).__name__
