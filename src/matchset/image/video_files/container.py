"""What the header of an AVI, MP4 or MOV file says, which OpenCV does not pass on."""

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

MP4_KINDS = {b"ftyp", b"moov", b"mdat", b"free", b"skip", b"wide", b"pnot", b"styp"}
MP4_PARTS = {b"moov", b"moof", b"mdat"}
FULL, LONG = 8, 16  # format: bytes of a box's header, and of one with a length of 64 bits


class Box(NamedTuple):
    """A box of an MP4 file, or a chunk of an AVI file.

    Parameters
    ----------
    kind : bytes
        Its name, four letters.
    begin, end : int
        Where its content begins and ends in the file, bytes; a file that was cut off is shorter than `end`.
    """

    kind: bytes
    begin: int
    end: int


class Container(NamedTuple):
    """What is known of a file from its outermost structure; all False for other formats.

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
    """

    counts_frames: bool = False
    counts_ticks: bool = False
    cut: bool = False
    indexed: bool = True
    encrypted: bool = False


def look_into(path: Path) -> Container:
    """Read the outermost structure of a file (ISO/IEC 14496-12 for MP4; RIFF for AVI).

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
        if head[4:8] not in MP4_KINDS:
            return Container()
        boxes = list(inside(file, 0, size))
        cut = any(box.end > size for box in boxes if box.kind in MP4_PARTS)
        movie = next((box for box in boxes if box.kind == b"moov"), None)
        if movie is None:
            return Container(cut=cut, indexed=False)
        fragments = any(box.kind == b"moof" for box in boxes) or any(find(file, movie, b"mvex"))
        whole = not fragments and not _is_trimmed(file, movie)
        return Container(whole, cut=cut, encrypted=_is_encrypted(file, movie))


def inside(file: BinaryIO, begin: int, end: int) -> Iterator[Box]:
    """Yield the boxes of an MP4 file between two places, without those inside them."""
    while begin + FULL <= end:
        file.seek(begin)
        head = file.read(LONG)
        if len(head) < FULL:
            return
        length, content = int.from_bytes(head[:4]), begin + FULL
        if length == 1:  # the length follows, with 64 bits
            length, content = int.from_bytes(head[FULL:]), begin + LONG
        elif length == 0:  # up to the end of the file
            length = end - begin
        if length < content - begin:
            return
        yield Box(head[4:8], content, begin + length)
        begin += length


def chunks(file: BinaryIO, end: int) -> Iterator[Box]:
    """Yield the outermost chunks of an AVI file; a long one has several. What follows them is not looked at."""
    begin = 0
    while begin + FULL <= end:
        file.seek(begin)
        head = file.read(FULL)
        if head[:4] != b"RIFF":
            return
        length = int.from_bytes(head[4:], "little")
        yield Box(head[:4], begin + FULL, begin + FULL + length)
        begin += FULL + length + length % 2


def find(file: BinaryIO, outer: Box, *path: bytes) -> Iterator[Box]:
    """Yield the boxes at a path of names inside another one."""
    for box in inside(file, outer.begin, outer.end):
        if box.kind == path[0]:
            yield from find(file, box, *path[1:]) if path[1:] else [box]


def _is_trimmed(file: BinaryIO, movie: Box) -> bool:
    """Whether the edit list of a track plays less than its samples last; times are rounded to the movie's scale."""
    scales = [_scale_and_duration(file, box)[0] for box in find(file, movie, b"mvhd")]
    if not scales or scales[0] == 0:
        return False
    for track in find(file, movie, b"trak"):
        played = [_played(file, box) / scales[0] for box in find(file, track, b"edts", b"elst")]
        for box in find(file, track, b"mdia", b"mdhd"):
            scale, duration = _scale_and_duration(file, box)
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


def _scale_and_duration(file: BinaryIO, box: Box) -> tuple[int, int]:
    """Read the ticks per second and the duration, ticks, of an `mvhd` or `mdhd` box, version 0 or 1."""
    file.seek(box.begin)
    data = file.read(32)
    if data[:1] == b"\x01":
        return int.from_bytes(data[20:24]), int.from_bytes(data[24:32])
    return int.from_bytes(data[12:16]), int.from_bytes(data[16:20])


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
