"""Pictures whose size is read, and held against a limit, before they are decoded: `decode_picture`, `decode_deep`.

Layouts: PNG (ISO/IEC 15948), JPEG (ITU-T T.81), GIF89a, BMP, TIFF 6.0, WebP (RFC 9649), Netpbm. Other kinds of OpenCV
are refused: their size would be known only after they are unpacked.
"""

import re
import struct
from typing import Any

import cv2
import numpy as np

from matchset.image.files.limits import LIMITS, InputLimits
from matchset.media.capture import hushed

PNG, RIFF = b"\x89PNG\r\n\x1a\n", b"RIFF"
TIFF_ORDERS = {b"II*\0": "<", b"MM\0*": ">"}
TIFF_WIDTH, TIFF_HEIGHT, TIFF_SHORT = 256, 257, 3  # format: tags, and type, of TIFF
# format: markers of JPEG that begin a frame; markers without a length
FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
ALONE = {0x01, *range(0xD0, 0xD9)}  # format: as above
NETPBM = re.compile(rb"P[1-7]\s(?:\s*#[^\n]*\n)*\s*(\d{1,9})\s(?:\s*#[^\n]*\n)*\s*(\d{1,9})")
PAM = re.compile(rb"P7\n.*?WIDTH (\d{1,9})\n.*?HEIGHT (\d{1,9})\n", re.DOTALL)

Size = tuple[int, int]


def decode_picture(data: bytes | memoryview, flags: int, limits: InputLimits = LIMITS) -> Any:
    """Decode a picture.

    Parameters
    ----------
    data : bytes
        A file.
    flags : int
        Of `cv2.imdecode`.
    limits : InputLimits

    Returns
    -------
    ndarray or None
        What OpenCV makes of it; None if it does not decode.

    Raises
    ------
    ValueError
        If it has more pixels than are allowed.
    """
    size = picture_size(data)
    if size is None:
        return None
    if size[0] * size[1] > limits.picture:
        raise ValueError(f"a picture of {size[0]} x {size[1]} px is larger than {limits.picture / 1e6:g} million px")
    try:
        with hushed:
            return cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error:
        return None


def decode_deep(data: bytes | memoryview, limits: InputLimits = LIMITS) -> Any:
    """Decode a picture with all its bits.

    Parameters
    ----------
    data : bytes
        A file.
    limits : InputLimits

    Returns
    -------
    ndarray of shape (h, w) or (h, w, 3), uint8 or uint16, or None
        BGR or gray; None if it does not decode. Numbers of other kinds are brought to uint8 by OpenCV.

    Raises
    ------
    ValueError
        If it has more pixels than are allowed.
    """
    image = decode_picture(data, cv2.IMREAD_ANYCOLOR | cv2.IMREAD_ANYDEPTH, limits)
    if image is None or image.dtype in (np.uint8, np.uint16):
        return image
    return decode_picture(data, cv2.IMREAD_ANYCOLOR, limits)


def picture_size(data: bytes | memoryview) -> Size | None:
    """Read width and height, px, from the beginning of a picture file; None if it is of no known kind or damaged."""
    head = bytes(data[:64])
    try:
        if head.startswith(PNG):
            width, height = struct.unpack(">II", head[16:24])
            return width, height
        if head.startswith(b"\xff\xd8"):
            return _jpeg(data)
        if head.startswith(b"GIF8"):
            width, height = struct.unpack("<HH", head[6:10])
            return width, height
        if head.startswith(b"BM"):
            return _bmp(head)
        if head[:4] in TIFF_ORDERS:
            return _tiff(data, TIFF_ORDERS[head[:4]])
        if head.startswith(RIFF) and head[8:12] == b"WEBP":
            return _webp(head)
        return _netpbm(bytes(data[:1000]))
    except (struct.error, IndexError):
        return None


def _jpeg(data: bytes | memoryview) -> Size | None:
    place = 2
    while place + 9 <= len(data):
        if data[place] != 0xFF:
            place += 1
        elif data[place + 1] in FRAMES:
            height, width = struct.unpack_from(">HH", data, place + 5)
            return width, height
        elif data[place + 1] == 0xFF:
            place += 1
        else:
            alone = data[place + 1] in ALONE or data[place + 1] == 0
            place += 2 if alone else 2 + struct.unpack_from(">H", data, place + 2)[0]
    return None


def _bmp(head: bytes) -> Size:
    if struct.unpack("<I", head[14:18])[0] == 12:
        width, height = struct.unpack("<HH", head[18:22])
    else:
        width, height = struct.unpack("<ii", head[18:26])
    return abs(width), abs(height)


def _tiff(data: bytes | memoryview, order: str) -> Size | None:
    found: dict[int, int] = {}
    place: int = struct.unpack_from(f"{order}I", data, 4)[0]
    for entry in range(struct.unpack_from(f"{order}H", data, place)[0]):
        tag, kind = struct.unpack_from(f"{order}HH", data, place + 2 + 12 * entry)
        value = struct.unpack_from(f"{order}{'H' if kind == TIFF_SHORT else 'I'}", data, place + 10 + 12 * entry)[0]
        found[tag] = value
    width, height = found.get(TIFF_WIDTH), found.get(TIFF_HEIGHT)
    return None if width is None or height is None else (width, height)


def _webp(head: bytes) -> Size | None:
    kind = head[12:16]
    if kind == b"VP8X":
        return int.from_bytes(head[24:27], "little") + 1, int.from_bytes(head[27:30], "little") + 1
    if kind == b"VP8L":
        bits = struct.unpack("<I", head[21:25])[0]
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    width, height = struct.unpack("<HH", head[26:30])
    return width & 0x3FFF, height & 0x3FFF


def _netpbm(head: bytes) -> Size | None:
    found = PAM.match(head) or NETPBM.match(head)
    return None if found is None else (int(found[1]), int(found[2]))
