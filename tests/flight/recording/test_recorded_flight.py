"""A file that is no recording of a flight, or that cannot be read here, is refused in words."""

import sys
from pathlib import Path

import msgspec
import pytest

from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.recording.mcap_file import McapWriter, RecordedMessage, Topic
from matchset.flight.recording.messages import CONFIGURATION
from matchset.flight.recording.reader import RecordingReader


@pytest.mark.parametrize(
    ("content", "words"), [(b"", "is empty"), (b"hello, this is no recording at all", "is no MCAP file")]
)
def test_other_files_are_refused(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "other.mcap"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=words):
        RecordingReader(path)


def test_mcap_files_of_others_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.mcap"
    with McapWriter(path, [Topic("/chatter", "std_msgs/String", b"{}")]) as out:
        out.write(RecordedMessage("/chatter", b"\xa2hi"), 0.0, 0)
    with pytest.raises(ValueError, match="no recording of a flight"):
        RecordingReader(path)


@pytest.mark.parametrize(("form", "words"), [(1, "its format is 1, this matchset reads 2 to 4"), ("x", "no _?[A-Z]")])
def test_other_formats_are_refused(tmp_path: Path, form: object, words: str) -> None:
    path = tmp_path / "newer.mcap"
    with McapWriter(path, [Topic(CONFIGURATION, "c", b"{}")]) as out:
        out.write(RecordedMessage(CONFIGURATION, msgspec.msgpack.encode({"format": form})), 0.0, 0)
    with pytest.raises(ValueError, match=words):
        RecordingReader(path)


def test_without_mcap_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "mcap", None)
    with pytest.raises(ValueError, match=r"pip install 'mcap"):
        FlightFiles(record=tmp_path / "a.mcap").check()
    with pytest.raises(ValueError, match=r"pip install 'mcap"):
        RecordingReader(tmp_path / "a.mcap")
