"""`recording.json`: when a recording began, what each table is of, and how it ended (`RecordingFacts`)."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from matchset.image.files.whole_file import write_whole
from matchset.live.record.stream_files import StreamFiles

FACTS = "recording.json"


class RecordingFacts:
    """Keeps `recording.json` true while a recording runs: it is written whenever there is another file.

    Parameters
    ----------
    path : Path
    source : str
        What is recorded.
    began : str
        When, UTC, as ISO 8601.
    """

    def __init__(self, path: Path, source: str, began: str) -> None:
        self._path, self._fixed = path, {"source": source, "began": began}
        self._written: list[Any] = []

    def note(self, streams: Sequence[StreamFiles]) -> None:
        """Write the file if something is new.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        facts = [stream.facts for stream in streams]
        if facts != self._written:
            self._written = facts
            self._write({})

    def end(self, streams: Sequence[StreamFiles], dropped: int, problem: str) -> None:
        """Write how it ended.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        self._written = [stream.facts for stream in streams]
        computing = [stream.computing for stream in streams]
        frames = [stream.count for stream in streams]
        self._write({"frames": frames, "dropped": dropped, "problem": problem, "computing_ms": computing})

    def _write(self, more: dict[str, Any]) -> None:
        facts = self._fixed | {"streams": self._written} | more
        write_whole(self._path, msgspec.json.format(msgspec.json.encode(facts)) + b"\n")
