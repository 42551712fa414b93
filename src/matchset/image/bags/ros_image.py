"""A message with a picture, sensor_msgs Image or CompressedImage of ROS 1 and ROS 2, from its bytes: `read_picture`.

Both messages have kept their fields since the first ROS, so no definitions are parsed. ROS 1 packs the fields one
behind the other; ROS 2 puts four bytes before them (CDR), aligns every integer to its size, and ends strings with 0.
Layouts: sensor_msgs/Image and sensor_msgs/CompressedImage of ros2/common_interfaces (Apache-2.0), OMG DDSI-RTPS 10.
"""

import struct
from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.files.picture import decode_picture

IMAGE, COMPRESSED_IMAGE = "sensor_msgs/Image", "sensor_msgs/CompressedImage"
NANO = 10**9  # format: nanoseconds in a second
LITTLE_ENDIAN = 1  # format: lowest bit of the second byte of a CDR message
PLAIN_CDR = (0, 1, 6, 7)  # format: second byte of a CDR message whose members follow each other, XCDR1 and XCDR2
# format: byte size, channels and conversion of each encoding; those of OpenCV are the names that ROS gives the pattern
ENCODINGS: dict[str, tuple[int, int, int | None]] = {
    "mono8": (1, 1, None),
    "8UC1": (1, 1, None),
    "bgr8": (1, 3, None),
    "8UC3": (1, 3, None),
    "rgb8": (1, 3, cv2.COLOR_RGB2BGR),
    "bgra8": (1, 4, cv2.COLOR_BGRA2BGR),
    "8UC4": (1, 4, cv2.COLOR_BGRA2BGR),
    "rgba8": (1, 4, cv2.COLOR_RGBA2BGR),
    "mono16": (2, 1, None),
    "16UC1": (2, 1, None),
    "bgr16": (2, 3, None),
    "rgb16": (2, 3, cv2.COLOR_RGB2BGR),
    "bgra16": (2, 4, cv2.COLOR_BGRA2BGR),
    "rgba16": (2, 4, cv2.COLOR_RGBA2BGR),
    "bayer_rggb8": (1, 1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr8": (1, 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg8": (1, 1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg8": (1, 1, cv2.COLOR_BayerGRBG2BGR),
    "bayer_rggb16": (2, 1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr16": (2, 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg16": (2, 1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg16": (2, 1, cv2.COLOR_BayerGRBG2BGR),
    "yuv422": (1, 2, cv2.COLOR_YUV2BGR_UYVY),
    "uyvy": (1, 2, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": (1, 2, cv2.COLOR_YUV2BGR_YUYV),
    "yuyv": (1, 2, cv2.COLOR_YUV2BGR_YUYV),
}
FULL_SCALE = 257.0  # format: 65535 / 255; the brightest of 16 bits becomes the brightest of 8

Picture = npt.NDArray[np.uint8]


class RosPicture(NamedTuple):
    """What a message holds.

    Attributes
    ----------
    stamp : int
        When the picture was taken, ns; 0 if the message does not say.
    encoding : str
        How the picture is stored, as the message names it.
    image : ndarray of shape (h, w, 3) or (h, w), uint8, or None
        BGR or gray; None if it does not decode.
    known : bool
        Whether pictures of this encoding can be read.
    """

    stamp: int
    encoding: str
    image: Picture | None
    known: bool


class Fields:
    """Reads the members of a message one after the other.

    Parameters
    ----------
    data : bytes
        A serialized message.
    ros1 : bool
        Whether it is packed as in ROS 1; otherwise it is CDR, as in ROS 2.

    Raises
    ------
    ValueError
        If the CDR is of a kind that no ROS writes; also while reading, if the message ends too early.
    """

    def __init__(self, data: bytes, ros1: bool) -> None:
        self._data, self._ros1 = memoryview(data), ros1
        self._start = self._at = 0 if ros1 else 4
        if not ros1 and (len(data) < 4 or data[0] != 0 or data[1] not in PLAIN_CDR):
            raise ValueError(f"a message begins with {bytes(data[:4]).hex()}, not with the header of plain CDR")
        little = ros1 or data[1] & LITTLE_ENDIAN
        self._uint32 = struct.Struct("<I" if little else ">I")

    def uint8(self) -> int:
        """Next byte."""
        return self._take(1)[0]

    def uint32(self) -> int:
        """Next unsigned integer of 32 bits."""
        if not self._ros1:
            self._at += (self._start - self._at) % self._uint32.size
        value: int = self._uint32.unpack(self._take(self._uint32.size))[0]
        return value

    def octets(self) -> memoryview:
        """Next sequence of bytes."""
        return self._take(self.uint32())

    def string(self) -> str:
        """Next string."""
        return bytes(self.octets()).rstrip(b"\0").decode("utf-8", "replace")

    def _take(self, count: int) -> memoryview:
        taken = self._data[self._at : self._at + count]
        if len(taken) != count:
            raise ValueError(f"a message of {len(self._data)} bytes ends too early")
        self._at += count
        return taken


def read_stamp(data: bytes, ros1: bool) -> int:
    """When the picture of a message was taken, ns.

    Parameters
    ----------
    data : bytes
        A serialized message that begins with a std_msgs/Header.
    ros1 : bool
        Whether it is packed as in ROS 1.

    Raises
    ------
    ValueError
        If the message is too short.
    """
    return _header(Fields(data, ros1), ros1)


def read_picture(data: bytes, kind: str, ros1: bool) -> RosPicture:
    """Read a message with a picture.

    Parameters
    ----------
    data : bytes
        A serialized message.
    kind : str
        `IMAGE` or `COMPRESSED_IMAGE`.
    ros1 : bool
        Whether it is packed as in ROS 1; otherwise it is CDR.

    Returns
    -------
    RosPicture

    Raises
    ------
    ValueError
        If the message ends too early or is no plain CDR.
    """
    fields = Fields(data, ros1)
    stamp = _header(fields, ros1)
    if kind == COMPRESSED_IMAGE:
        encoding = fields.string()
        image = decode_compressed(fields.octets())
        return RosPicture(stamp, encoding, image, image is not None)
    height, width = fields.uint32(), fields.uint32()
    encoding, big = fields.string(), fields.uint8() != 0
    step, pixels = fields.uint32(), fields.octets()
    layout = ENCODINGS.get(encoding)
    if layout is None:
        return RosPicture(stamp, encoding, None, False)
    rows = _rows(pixels, (height, width), step, layout[0] * layout[1])
    return RosPicture(stamp, encoding, None if rows is None else _converted(rows, layout, big), True)


def _header(fields: Fields, ros1: bool) -> int:
    """Read a std_msgs/Header; return its stamp, ns."""
    if ros1:
        fields.uint32()  # the number of the message
    stamp = fields.uint32() * NANO + fields.uint32()
    fields.octets()  # the name of the frame of coordinates
    return stamp


def decode_compressed(data: memoryview) -> Picture | None:
    """Decode a JPEG, PNG or other picture that OpenCV reads; None if it is broken, too large or something else."""
    try:
        image = decode_picture(data, cv2.IMREAD_ANYCOLOR)
    except ValueError:
        return None
    return None if image is None else np.asarray(image, np.uint8)


def _rows(pixels: memoryview, size: tuple[int, int], step: int, pixel: int) -> npt.NDArray[np.uint8] | None:
    """Bytes of the pixels, (h, w * pixel), without what fills up the rows; None if they are not all there."""
    height, width = size
    if height == 0 or width == 0 or step < width * pixel or len(pixels) < height * step:
        return None
    rows = np.frombuffer(pixels, np.uint8, height * step).reshape(height, step)
    return np.array(rows[:, : width * pixel])  # a copy: nobody else may hold or write the picture's memory


def _converted(rows: npt.NDArray[np.uint8], layout: tuple[int, int, int | None], big: bool) -> Picture | None:
    """Picture in BGR or gray of the bytes of its rows."""
    size, channels, conversion = layout
    image: Any = rows if size == 1 else rows.view(">u2" if big else "<u2").astype(np.uint16)
    if channels > 1:
        image = image.reshape(len(rows), -1, channels)
    try:
        if conversion is not None:
            image = cv2.cvtColor(image, conversion)
    except cv2.error:
        return None
    return np.asarray(image if size == 1 else cv2.convertScaleAbs(image, alpha=1.0 / FULL_SCALE), np.uint8)
