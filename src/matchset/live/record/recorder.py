"""Begins and ends recordings of what is shown: `PageRecorder`."""

import threading
from collections import deque
from pathlib import Path

import msgspec

from matchset.app.run_folder import output_folder
from matchset.live.feed import Feed, StreamPicture
from matchset.live.record.recording import PageRecording, RecordingParameters
from matchset.live.record.state import RecordState
from matchset.media.closing import Closing


class PageRecorderParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What is recorded, and offered.

    Parameters
    ----------
    kept : int
        Finished recordings whose files are offered. More: a longer list on the page. Chosen by hand: what a phone shows
        without much scrolling; all stay on the disk.
    recording : RecordingParameters
    """

    kept: int = 5
    recording: RecordingParameters = RecordingParameters()


class PageRecorder(Closing):
    """Listens to what is shown, and writes it while it is told to; implements `matchset.live.feed.Listener`.

    Parameters
    ----------
    parameters : PageRecorderParameters, optional
    """

    def __init__(self, parameters: PageRecorderParameters | None = None) -> None:
        self._parameters = parameters or PageRecorderParameters()
        self._lock = threading.Lock()
        self._feed: Feed | None = None
        self._running: PageRecording | None = None
        self._ended: deque[PageRecording] = deque(maxlen=self._parameters.kept)

    def hear(self, stream: int, seen: StreamPicture) -> None:
        """Write a picture, if a recording runs."""
        running = self._running
        if running is not None:
            running.add(stream, seen)

    def changed(self, feed: Feed | None) -> None:
        """End the recording: something else is shown."""
        if feed is not self._feed:
            self.end()
        self._feed = feed

    def begin(self) -> None:
        """Begin a recording in a new folder; if one runs, it goes on.

        Raises
        ------
        ValueError
            If nothing is shown, the disk is full, or the folder cannot be made.
        """
        with self._lock:
            if self._is_running() is not None:
                return
            if self._feed is None:
                raise ValueError("nothing is shown that could be recorded")
            folder = output_folder(None, "live")
            try:
                self._running = PageRecording(folder, self._feed.title, self._feed.streams, self._parameters.recording)
            except OSError as error:
                raise ValueError(f"cannot write to the folder {folder}: {error.strerror}") from error

    def end(self) -> None:
        """End the recording that runs; its files are finished in a thread."""
        with self._lock:
            running, self._running = self._running, None
            if running is not None:
                running.end()
                self._ended.appendleft(running)

    def state(self) -> RecordState:
        """Return what the page shows."""
        with self._lock:
            running = self._is_running()
            ended = list(self._ended)
        if running is not None:
            shown = running.state()
        else:
            finishing = next((each for each in ended if each.result is None), None)
            shown = RecordState() if finishing is None else finishing.state()
        finished = [each.result for each in ended if each.result is not None]
        return msgspec.structs.replace(shown, finished=finished)

    def downloads(self) -> dict[str, Path]:
        """Return the files of finished recordings, by folder and name."""
        with self._lock:
            ended = list(self._ended)
        return {
            f"{each.folder.name}/{file.name}": each.folder / file.name
            for each in ended
            if each.result is not None
            for file in each.result.files
        }

    def close(self) -> None:
        """End the recording that runs, and wait for its files."""
        self.end()
        for each in list(self._ended):
            each.close()

    def _is_running(self) -> PageRecording | None:
        """Return the recording that runs; one that has ended by itself is put to the others."""
        if self._running is not None and self._running.has_ended:
            self._ended.appendleft(self._running)
            self._running = None
        return self._running
