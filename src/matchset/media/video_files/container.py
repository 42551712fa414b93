"""What the header of an AVI, MP4, MOV or Matroska file says, which OpenCV does not pass on."""

from pathlib import Path
from typing import BinaryIO, NamedTuple

from matchset.media.video_files.matroska_tracks import EBML, matroska_tracks
from matchset.media.video_files.mp4_boxes import FULL, Box, chunks, find, inside, scale_and_duration
from matchset.media.video_files.mp4_tracks import VideoTrack, video_tracks

MP4_KINDS = {b"ftyp", b"moov", b"mdat", b"free", b"skip", b"wide", b"pnot", b"styp"}
MP4_PARTS = {b"moov", b"moof", b"mdat"}


class Container(NamedTuple):
    """What is known of a file from its outermost structure; all False or empty for other formats.

    Parameters
    ----------
    counts_frames : bool
        Whether the header holds the number of frames to come: that of an MP4 or MOV does that is neither written in
        fragments nor trimmed by an edit list. Elsewhere OpenCV guesses it from duration and rate.
    counts_ticks : bool
        Whether it holds the number of frame periods, in some of which there may be no new frame: that of an AVI.
    cut : bool
        Whether the file ends before its last part does.
    indexed : bool
        Whether it is an MP4 or MOV that has its index (`moov`), or no such file.
    encrypted : bool
        Whether it is an MP4 with an encrypted track.
    tracks : tuple of VideoTrack
        Of an MP4, MOV, Matroska or WebM.
    """

    counts_frames: bool = False
    counts_ticks: bool = False
    cut: bool = False
    indexed: bool = True
    encrypted: bool = False
    tracks: tuple[VideoTrack, ...] = ()


def look_into(path: Path) -> Container:
    """Read the outermost structure of a file (ISO/IEC 14496-12 for MP4; RIFF for AVI; RFC 9559 for Matroska).

    Parameters
    ----------
    path : Path
        A file that can be read.

    Returns
    -------
    Container
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(12)
        if head[:4] == b"RIFF" and head[8:] == b"AVI ":
            return Container(counts_ticks=True, cut=any(chunk.end > size for chunk in chunks(file, size)))
        if head[:4] == EBML.to_bytes(4):
            return Container(tracks=tuple(matroska_tracks(file, size)))
        if head[4:8] not in MP4_KINDS:
            return Container()
        boxes = list(inside(file, 0, size))
        cut = any(box.end > size for box in boxes if box.kind in MP4_PARTS)
        movie = next((box for box in boxes if box.kind == b"moov"), None)
        if movie is None:
            return Container(cut=cut, indexed=False)
        fragments = any(box.kind == b"moof" for box in boxes) or any(find(file, movie, b"mvex"))
        whole = not fragments and not _is_trimmed(file, movie)
        return Container(whole, cut=cut, encrypted=_is_encrypted(file, movie), tracks=tuple(video_tracks(file, movie)))


def _is_trimmed(file: BinaryIO, movie: Box) -> bool:
    """Whether the edit list of a track plays less than its samples last; times are rounded to the movie's scale."""
    scales = [scale_and_duration(file, box)[0] for box in find(file, movie, b"mvhd")]
    if not scales or scales[0] == 0:
        return False
    for track in find(file, movie, b"trak"):
        played = [_played(file, box) / scales[0] for box in find(file, track, b"edts", b"elst")]
        for box in find(file, track, b"mdia", b"mdhd"):
            scale, duration = scale_and_duration(file, box)
            if played and scale and sum(played) < duration / scale - 2.0 / scales[0]:
                return True
    return False


def _is_encrypted(file: BinaryIO, movie: Box) -> bool:
    """Whether a video track says that its samples are encrypted (`encv`, ISO/IEC 23001-7)."""
    for table in find(file, movie, b"trak", b"mdia", b"minf", b"stbl", b"stsd"):
        entries = inside(file, table.begin + FULL, table.end)  # behind version, flags and count
        if any(entry.kind == b"encv" for entry in entries):
            return True
    return False


def _played(file: BinaryIO, edits: Box) -> int:
    """Sum the durations in an edit list, ticks of the movie, without its pauses."""
    file.seek(edits.begin)
    data = file.read(edits.end - edits.begin)
    wide = 8 if data[:1] == b"\x01" else 4
    total = 0
    for at in range(8, len(data) - 2 * wide, 2 * wide + 4):
        start = int.from_bytes(data[at + wide : at + 2 * wide], signed=True)
        total += int.from_bytes(data[at : at + wide]) if start >= 0 else 0
    return total
