"""How `track` and `locate` open a stretch of a video in place of all of it: `StretchOpening`."""

from pathlib import Path

import msgspec

from matchset.app.cli_options import AS_IT_IS, SilenceOptions, ViewOptions
from matchset.app.exit_codes import print_note
from matchset.batch.jobs.job import Stretch
from matchset.media.video import Video
from matchset.media.video_stretch import StretchMark, VideoStretch

MARKS = "marks.jsonl"  # format: beside the table of a stretch, a line for each of its frames


class StretchOpening(SilenceOptions, frozen=True, kw_only=True):
    """Opens a stretch of a video, and notes its frames.

    Parameters
    ----------
    stretch : Stretch
    marks : Path
        File for the marks of its frames.
    first : int
        The frame in which somebody clicked.
    """

    stretch: Stretch
    marks: Path
    first: int = 0

    def open(
        self, source: str, fps: float | None = None, topic: str | None = None, view: ViewOptions = AS_IT_IS
    ) -> Video:
        """Open the stretch."""
        encoder = msgspec.json.Encoder()
        marks = self.marks.open("wb")

        def note(mark: StretchMark) -> None:
            marks.write(encoder.encode(mark) + b"\n")

        begin, end = self.stretch.begin, self.stretch.end
        return VideoStretch(
            source, begin, end, note, marks.close, self.first, fps=fps, topic=topic, note=print_note, **view.arguments
        )


def read_marks(text: bytes) -> list[StretchMark]:
    """Read the marks of a stretch."""
    decoder = msgspec.json.Decoder(StretchMark)
    return [decoder.decode(line) for line in text.splitlines()]
