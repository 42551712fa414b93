"""The video tracks of an MP4 or MOV file, as its index describes them: `video_tracks`.

FFmpeg numbers streams in the order of the tracks. OpenCV reads the first that holds video; of its display matrix it
knows an angle, not whether it mirrors.
"""

import struct
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

from matchset.media.video_files.mp4_boxes import FULL, Box, find, inside, scale_and_duration

# format: where the matrix stands in the content of `tkhd` and `mvhd`, bytes, by their version
TRACK_MATRIX, MOVIE_MATRIX = {0: 40, 1: 52}, {0: 36, 1: 48}
MATRIX = 36  # format: bytes of a matrix of nine numbers
ONE = 1 << 16  # format: 1 in numbers of 16.16 bits
SAMPLE_ENTRY = 78  # format: bytes of a VisualSampleEntry before the boxes in it
VIDEO = b"vide"

Matrix = tuple[int, int, int, int]


class VideoTrack(NamedTuple):
    """A video track.

    Attributes
    ----------
    matrix : tuple of 4 int
        a, b, c, d of the display matrix, that of the whole file included, in units of 2**-16.
    seconds : float
        How long it plays; 0 if its header does not say, as in fragments.
    size : tuple of int
        Width and height at which it is to be shown, px.
    ratio : tuple of int or None
        What it says of the width and height of a pixel (`pasp`); None if nothing.
    """

    matrix: Matrix
    seconds: float
    size: tuple[int, int]
    ratio: tuple[int, int] | None


def video_tracks(file: BinaryIO, movie: Box) -> list[VideoTrack]:
    """Read the video tracks of a file (ISO/IEC 14496-12).

    Parameters
    ----------
    file : binary file
    movie : Box
        Its index, `moov`.
    """
    whole = next((_matrix(file, box, MOVIE_MATRIX) for box in find(file, movie, b"mvhd")), None)
    return list(_tracks(file, movie, whole or (ONE, 0, 0, ONE)))


def _tracks(file: BinaryIO, movie: Box, whole: Matrix) -> Iterator[VideoTrack]:
    for track in find(file, movie, b"trak"):
        if not any(_content(file, box)[8:12] == VIDEO for box in find(file, track, b"mdia", b"hdlr")):
            continue
        for head in find(file, track, b"tkhd"):
            matrix = _matrix(file, head, TRACK_MATRIX)
            if matrix is not None:
                times = [scale_and_duration(file, box) for box in find(file, track, b"mdia", b"mdhd")]
                seconds = next((duration / scale for scale, duration in times if scale), 0.0)
                yield VideoTrack(_product(matrix, whole), seconds, _size(file, head), _ratio(file, track))


def _content(file: BinaryIO, box: Box) -> bytes:
    """Read the beginning of a box."""
    file.seek(box.begin)
    return file.read(min(box.end - box.begin, 128))


def _matrix(file: BinaryIO, box: Box, places: dict[int, int]) -> Matrix | None:
    """Read a, b, c, d; None if the box is too short."""
    data = _content(file, box)
    place = places.get(data[0] if data else 0)
    if place is None or len(data) < place + MATRIX:
        return None
    a, b, _, c, d, _, *_ = struct.unpack_from(">9i", data, place)
    return a, b, c, d


def _product(first: Matrix, second: Matrix) -> Matrix:
    """Matrix that does one, then the other."""
    a, b, c, d = first
    e, f, g, h = second
    return (a * e + b * g) // ONE, (a * f + b * h) // ONE, (c * e + d * g) // ONE, (c * f + d * h) // ONE


def _size(file: BinaryIO, head: Box) -> tuple[int, int]:
    data = _content(file, head)
    place = TRACK_MATRIX[data[0]] + MATRIX
    if len(data) < place + 8:
        return 0, 0
    width, height = struct.unpack_from(">II", data, place)
    return width // ONE, height // ONE


def _ratio(file: BinaryIO, track: Box) -> tuple[int, int] | None:
    """Read the first `pasp` of a track."""
    for table in find(file, track, b"mdia", b"minf", b"stbl", b"stsd"):
        for entry in inside(file, table.begin + FULL, table.end):  # behind version, flags and count
            for box in inside(file, entry.begin + SAMPLE_ENTRY, entry.end):
                data = _content(file, box)
                if box.kind == b"pasp" and len(data) >= FULL:
                    wide, high = struct.unpack_from(">II", data)
                    return wide, high
    return None
