"""The panel with the button Record: `RecordPanel`."""

from pathlib import Path

from matchset.live.feed import Panel
from matchset.live.record.messages import MESSAGES, Record
from matchset.live.record.recorder import PageRecorder
from matchset.live.record.state import RecordState


class RecordPanel(Panel):
    """Begins and ends recordings, and offers their files.

    Parameters
    ----------
    recorder : PageRecorder
    """

    name = "record"
    messages = MESSAGES

    def __init__(self, recorder: PageRecorder) -> None:
        self._recorder = recorder

    def take(self, message: Record, page: str) -> None:  # noqa: ARG002
        """Begin or end a recording."""
        if message.on:
            self._recorder.begin()
        else:
            self._recorder.end()

    def state(self) -> RecordState:
        """Return how it goes, and what is finished."""
        return self._recorder.state()

    def downloads(self) -> dict[str, Path]:
        """Return the files of what is finished: ``0003-live/tracks.csv``."""
        return self._recorder.downloads()
