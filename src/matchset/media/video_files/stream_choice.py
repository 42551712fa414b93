"""Which video stream of a file is read, if it has several: `choose_stream`."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import msgspec

from matchset.media.video_files.mp4_tracks import VideoTrack
from matchset.media.video_files.pyav_capture import StreamFacts, has_pyav, list_streams
from matchset.numeric.imports import advice

RIFF = b"RIFF"
SIGNATURES = (b"\x1aE\xdf\xa3", b"\x47", b"\x00\x00\x01\xba", RIFF)  # format: Matroska, MPEG-TS, MPEG-PS, AVI
AVI_STREAMS = 56  # format: where the number of streams stands in an AVI file, bytes
PYAV = advice("av")


class StreamChoiceParameters(msgspec.Struct, frozen=True):
    """When another stream than the first is read.

    Parameters
    ----------
    longer : float
        Ratio of durations from which a stream plays longer than the first one. Chosen by: two cameras that were
        switched off one after the other are to stay in their order, a thumbnail is not to come first.
    """

    longer: float = 1.1


DEFAULT = StreamChoiceParameters()


class StreamChoice(NamedTuple):
    """Which video stream is read.

    Attributes
    ----------
    number : int
        From 0, among the video streams.
    notes : tuple of str
        What is to be said of it.
    """

    number: int = 0
    notes: tuple[str, ...] = ()


def choose_stream(path: Path, tracks: Sequence[VideoTrack], asked: int | None) -> StreamChoice:
    """Choose the video stream of a file: the one that was asked for, otherwise the one that plays longest.

    Parameters
    ----------
    path : Path
        The file.
    tracks : sequence of VideoTrack
        Its video tracks, as far as they are known. Where they are not, or nothing says how long they play, PyAV lists
        the streams, if it is installed.
    asked : int or None
        From 0.

    Raises
    ------
    ValueError
        If there is no stream of this number.
    """
    streams = [StreamFacts(track.seconds, track.size) for track in tracks]
    if not any(stream.seconds for stream in streams) and len(streams) != 1:
        streams = _listed(path) or streams
    if asked is not None and streams and asked >= len(streams):
        have = "one video stream, 0" if len(streams) == 1 else f"the video streams {_words(streams)}"
        raise ValueError(f"{path} has {have}, there is no stream {asked}")
    if asked is not None or len(streams) < 2:
        return StreamChoice(asked or 0)
    longest = max(range(len(streams)), key=lambda number: streams[number].seconds)
    longer = streams[longest].seconds > DEFAULT.longer * streams[0].seconds
    number = longest if longer and has_pyav() else 0
    words = f"the file has several video streams, {_words(streams)}: {number} is read; --stream chooses"
    return StreamChoice(number, (words if number == longest or not longer else f"{words}; {PYAV} reads the longest",))


def _listed(path: Path) -> list[StreamFacts]:
    """List the streams of a file that may have several; empty where nothing is known."""
    with path.open("rb") as file:
        head = file.read(AVI_STREAMS + 4)
    one = head.startswith(RIFF) and int.from_bytes(head[AVI_STREAMS:], "little") < 2
    return list_streams(str(path)) if head.startswith(SIGNATURES) and not one else []


def _words(streams: Sequence[StreamFacts]) -> str:
    return ", ".join(
        f"{number} ({each.size[0]} x {each.size[1]}{f', {each.seconds:.1f} s' if each.seconds else ''})"
        for number, each in enumerate(streams)
    )
