"""A message with a picture, sensor_msgs Image or CompressedImage of ROS 1 and ROS 2, from its bytes: `read_picture`.

Both messages have kept their fields since the first ROS, so no definitions are parsed. `CompressedImage` and Foxglove's
messages hold JPEG, PNG, or a piece of a video, which is for `video_messages`.
Layouts: sensor_msgs/Image and sensor_msgs/CompressedImage of ros2/common_interfaces (Apache-2.0).
"""

from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from matchset.media.bags.packed_fields import NANO, Fields, PackedPicture
from matchset.media.bags.video_messages import codec_of
from matchset.media.picture import decode_deep
from matchset.media.upright.depth import DepthScaling

IMAGE, COMPRESSED_IMAGE = "sensor_msgs/Image", "sensor_msgs/CompressedImage"
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
    coded : bytes
        A piece of a video, which is decoded with those before it; empty if the picture is none of a video.
    """

    stamp: int
    encoding: str
    image: Picture | None
    known: bool
    coded: bytes = b""


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


def read_picture(data: bytes, kind: str, ros1: bool, depth: DepthScaling | None = None) -> RosPicture:
    """Read a message with a picture.

    Parameters
    ----------
    data : bytes
        A serialized message.
    kind : str
        `IMAGE` or `COMPRESSED_IMAGE`.
    ros1 : bool
        Whether it is packed as in ROS 1; otherwise it is CDR.
    depth : DepthScaling, optional
        That of the pictures before it; by default that of this picture counts.

    Returns
    -------
    RosPicture

    Raises
    ------
    ValueError
        If the message ends too early or is no plain CDR.
    """
    fields = Fields(data, ros1)
    stamp, depth = _header(fields, ros1), depth or DepthScaling()
    if kind == COMPRESSED_IMAGE:
        return unpacked(PackedPicture(stamp, fields.string(), bytes(fields.octets())), depth)
    height, width = fields.uint32(), fields.uint32()
    encoding, big = fields.string(), fields.uint8() != 0
    step, pixels = fields.uint32(), fields.octets()
    layout = ENCODINGS.get(encoding)
    if layout is None:
        return RosPicture(stamp, encoding, None, False)
    rows = _rows(pixels, (height, width), step, layout[0] * layout[1])
    return RosPicture(stamp, encoding, None if rows is None else _converted(rows, layout, big, depth), True)


def _header(fields: Fields, ros1: bool) -> int:
    """Read a std_msgs/Header; return its stamp, ns."""
    if ros1:
        fields.uint32()  # the number of the message
    stamp = fields.uint32() * NANO + fields.uint32()
    fields.octets()  # the name of the frame of coordinates
    return stamp


def unpacked(picture: PackedPicture, depth: DepthScaling) -> RosPicture:
    """Decode a JPEG, PNG or other picture that OpenCV reads; a piece of a video is handed on as it is.

    Parameters
    ----------
    picture : PackedPicture
    depth : DepthScaling
        Of the pictures before it.

    Returns
    -------
    RosPicture
        Without a picture if it is broken, too large or something else.
    """
    if codec_of(picture.form) is not None:
        return RosPicture(picture.stamp, picture.form, None, True, picture.data)
    try:
        image = decode_deep(picture.data)
    except ValueError:
        image = None
    shown = None if image is None else depth.to_bytes(image)
    return RosPicture(picture.stamp, picture.form, shown, shown is not None)


def _rows(pixels: memoryview, size: tuple[int, int], step: int, pixel: int) -> npt.NDArray[np.uint8] | None:
    """Bytes of the pixels, (h, w * pixel), without what fills up the rows; None if they are not all there."""
    height, width = size
    if height == 0 or width == 0 or step < width * pixel or len(pixels) < height * step:
        return None
    rows = np.frombuffer(pixels, np.uint8, height * step).reshape(height, step)
    return np.array(rows[:, : width * pixel])  # a copy: nobody else may hold or write the picture's memory


def _converted(
    rows: npt.NDArray[np.uint8], layout: tuple[int, int, int | None], big: bool, depth: DepthScaling
) -> Picture | None:
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
    return depth.to_bytes(image)
