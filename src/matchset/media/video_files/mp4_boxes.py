"""Boxes of an MP4 or MOV file, chunks of an AVI file: `inside`, `find`, `chunks`."""

from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

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


def scale_and_duration(file: BinaryIO, box: Box) -> tuple[int, int]:
    """Read the ticks per second and the duration, ticks, of an `mvhd` or `mdhd` box, version 0 or 1."""
    file.seek(box.begin)
    data = file.read(32)
    if data[:1] == b"\x01":
        return int.from_bytes(data[20:24]), int.from_bytes(data[24:32])
    return int.from_bytes(data[12:16]), int.from_bytes(data[16:20])
