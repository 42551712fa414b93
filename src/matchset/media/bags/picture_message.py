"""A message of any kind that holds a picture, read: `read_message`, `stamp_of`; which kinds there are."""

from matchset.media.bags import foxglove
from matchset.media.bags.bag_file import BagMessage
from matchset.media.bags.packed_fields import ROS1
from matchset.media.bags.ros_image import COMPRESSED_IMAGE, IMAGE, RosPicture, read_picture, read_stamp, unpacked
from matchset.media.upright.depth import DepthScaling

KINDS = (IMAGE, COMPRESSED_IMAGE, *foxglove.KINDS)


def read_message(message: BagMessage, kind: str, depth: DepthScaling) -> RosPicture:
    """Read a message with a picture.

    Parameters
    ----------
    message : BagMessage
    kind : str
        One of `KINDS`.
    depth : DepthScaling
        Of the pictures before it.

    Raises
    ------
    ValueError
        If it ends too early, or is packed in another way.
    """
    if kind in foxglove.KINDS:
        return unpacked(foxglove.read_foxglove(message.data, kind, message.packing), depth)
    return read_picture(message.data, kind, message.packing == ROS1, depth)


def stamp_of(message: BagMessage, kind: str) -> int:
    """Return when the picture of a message was taken, ns; 0 if it does not say, or is broken."""
    try:
        if kind in foxglove.KINDS:
            return foxglove.read_foxglove(message.data, kind, message.packing).stamp
        return read_stamp(message.data, message.packing == ROS1)
    except ValueError:
        return 0
