"""The video tracks of a Matroska or WebM file, as its header describes them (RFC 9559): `matroska_tracks`."""

import math
import struct
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

from matchset.media.video_files.mp4_tracks import ONE, Matrix, VideoTrack

# format: names of elements
EBML, SEGMENT, CLUSTER, TRACKS, TRACK = 0x1A45DFA3, 0x18538067, 0x1F43B675, 0x1654AE6B, 0xAE
KIND, VIDEO, WIDTH, HEIGHT, PROJECTION = 0x83, 0xE0, 0xB0, 0xBA, 0x7670  # format: as above
YAW, PITCH, ROLL = 0x7673, 0x7674, 0x7675  # format: as above
IS_VIDEO = 1  # format: kind of a track
HALF_TURN = 180.0  # geometry: degrees
FLOATS = {4: ">f", 8: ">d"}  # format: by their length


class Element(NamedTuple):
    """An element: its name, and where its content begins and ends in the file, bytes."""

    name: int
    begin: int
    end: int


def matroska_tracks(file: BinaryIO, size: int) -> list[VideoTrack]:
    """Read the video tracks of a file.

    Parameters
    ----------
    file : binary file
    size : int
        Its length, bytes.

    Returns
    -------
    list of VideoTrack
        How long they play is not known.
    """
    found: list[VideoTrack] = []
    for segment in _inside(file, 0, size):
        if segment.name != SEGMENT:
            continue
        for part in _inside(file, segment.begin, segment.end):
            if part.name == CLUSTER:  # pictures: the header is over
                return found
            if part.name == TRACKS:
                tracks = (track for track in _inside(file, part.begin, part.end) if track.name == TRACK)
                found += [video for track in tracks if (video := _video(file, track)) is not None]
    return found


def _video(file: BinaryIO, track: Element) -> VideoTrack | None:
    parts = {part.name: part for part in _inside(file, track.begin, track.end)}
    if VIDEO not in parts or KIND not in parts or _integer(file, parts[KIND]) != IS_VIDEO:
        return None
    inner = {part.name: part for part in _inside(file, parts[VIDEO].begin, parts[VIDEO].end)}
    width, height = (_integer(file, inner[name]) if name in inner else 0 for name in (WIDTH, HEIGHT))
    pose = {}
    if PROJECTION in inner:
        pose = {part.name: part for part in _inside(file, inner[PROJECTION].begin, inner[PROJECTION].end)}
    yaw, pitch, roll = (_float(file, pose[name]) if name in pose else 0.0 for name in (YAW, PITCH, ROLL))
    return VideoTrack(_matrix(yaw, pitch, roll), 0.0, (width, height), None)


def _matrix(yaw: float, pitch: float, roll: float) -> Matrix:
    """Display matrix of a pose, degrees; that of a picture as stored where it is none of a plane.

    A yaw by half a turn mirrors; the roll, counterclockwise, comes after it. So FFmpeg reads it (`matroskadec.c`).
    """
    if pitch != 0.0 or abs(yaw) not in (0.0, HALF_TURN) or not math.isfinite(roll):
        return ONE, 0, 0, ONE
    angle = math.radians(roll if yaw else -roll)
    cosine, sine = round(ONE * math.cos(angle)), round(ONE * math.sin(angle))
    mirror = -1 if yaw else 1
    return mirror * cosine, sine, mirror * -sine, cosine


def _inside(file: BinaryIO, begin: int, end: int) -> Iterator[Element]:
    """Yield the elements between two places, without those inside them."""
    while begin < end:
        file.seek(begin)
        head = file.read(12)
        name_length = _length(head, 0, 4)
        size_length = _length(head, name_length, 8)
        if not name_length or not size_length:
            return
        name = int.from_bytes(head[:name_length])
        packed = int.from_bytes(head[name_length : name_length + size_length])
        size = packed & ((1 << 7 * size_length) - 1)
        content = begin + name_length + size_length
        unknown = size == (1 << 7 * size_length) - 1
        begin = end if unknown else content + size
        yield Element(name, content, min(begin, end))


def _length(head: bytes, place: int, most: int) -> int:
    """How many bytes a name or a size has, by its leading zeros; 0 if it is none."""
    if place >= len(head) or not head[place]:
        return 0
    length = 9 - head[place].bit_length()
    return length if length <= most and place + length <= len(head) else 0


def _content(file: BinaryIO, element: Element) -> bytes:
    file.seek(element.begin)
    return file.read(min(element.end - element.begin, 8))


def _integer(file: BinaryIO, element: Element) -> int:
    return int.from_bytes(_content(file, element))


def _float(file: BinaryIO, element: Element) -> float:
    data = _content(file, element)
    return float(struct.unpack(FLOATS[len(data)], data)[0]) if len(data) in FLOATS else 0.0
