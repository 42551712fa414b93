"""What OpenCV found in the header of an open file or stream: shape of the pixels, angle, size."""

import math

import cv2

from matchset.media.capture import Capture
from matchset.media.upright.orientation import AS_STORED, QUARTER, Orientation


def take_as_stored(capture: Capture) -> None:
    """Ask OpenCV not to turn pictures itself: it turns those that are to be mirrored."""
    capture.set(cv2.CAP_PROP_ORIENTATION_AUTO, 0.0)


def pixel_ratio(capture: Capture) -> tuple[float, float]:
    """Width and height of a pixel, in any unit, by container or codec; 0, 0 where none says it.

    Parameters
    ----------
    capture : Capture
        An open file or stream. FFmpeg reads MP4, MOV, Matroska, AVI and MPEG headers, H.264 and MPEG-4.
    """
    ratio = capture.get(cv2.CAP_PROP_SAR_NUM), capture.get(cv2.CAP_PROP_SAR_DEN)
    return ratio if all(math.isfinite(value) and value > 0.0 for value in ratio) else (0.0, 0.0)


def stated_orientation(capture: Capture) -> Orientation:
    """Orientation by the angle that OpenCV found in a header; as stored where there is none, or no quarter turn."""
    angle = capture.get(cv2.CAP_PROP_ORIENTATION_META)
    if not math.isfinite(angle) or angle % QUARTER:
        return AS_STORED
    return Orientation.of_turn(int(angle))


def stored_size(capture: Capture) -> tuple[int, int]:
    """Width and height of the pictures of an open file as they are stored, px.

    Parameters
    ----------
    capture : Capture
        One that turns no pictures, see `take_as_stored`.
    """
    size = capture.get(cv2.CAP_PROP_FRAME_WIDTH), capture.get(cv2.CAP_PROP_FRAME_HEIGHT)
    width, height = (int(value) if math.isfinite(value) else 0 for value in size)
    return width, height
