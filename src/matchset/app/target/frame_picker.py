"""One frame of a video: a given one (`frame_at`), which may not be black where it was clicked (`lit_frame_at`)."""

from itertools import islice

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.frame import Frame
from matchset.media.video import Video


class PickerParameters(msgspec.Struct, frozen=True):
    """Which frames are black, and how long to wait for another.

    Parameters
    ----------
    warm_up : int
        Frames of a camera that are skipped until its automatic exposure has settled. Chosen by hand; no benchmark has
        a camera.
    dark : int
        Gray level that no part of a black picture reaches. Higher takes night scenes for black ones. Chosen by hand:
        black of a limited-range video that was read as full range is 16.
    dark_part : int
        Side of such a part, px: larger overlooks small lights, smaller sees noise. Chosen by hand; the ball must be
        larger (docs/limits.md).
    dark_frames : int
        Frames that are read behind a black one in search of another.
    """

    warm_up: int = 15
    dark: int = 24
    dark_part: int = 4
    dark_frames: int = 3000


PARAMETERS = PickerParameters()


def frame_at(video: Video, index: int) -> Frame:
    """Read a video up to a frame.

    Parameters
    ----------
    video : Video
        Not yet read beyond the frame.
    index : int
        Its index; of a live source, the first frame at or after it.

    Raises
    ------
    ValueError
        If the video has no such frame, or it cannot be decoded.
    """
    last = -1
    for frame in video:
        last = frame.index
        if frame.index == index or (video.live and frame.index > index):
            return frame
        if frame.index > index:
            raise ValueError(f"frame {index} could not be decoded")
    raise ValueError(f"there is no frame {index}: the video has frames 0 ... {last}")


def lit_frame_at(video: Video, index: int) -> Frame:
    """Read a video up to a frame that somebody clicked on, or is to click on, and that is not black.

    Parameters
    ----------
    video : Video
        Not yet read beyond the frame.
    index : int
        Its index; of a live source, the first frame at or after it that is not black.

    Raises
    ------
    ValueError
        If the video has no such frame, it cannot be decoded, or it is black; then with the next one that is not.
    """
    frame = frame_at(video, index)
    if not is_black(frame.image):
        return frame
    for later in islice(video, PARAMETERS.dark_frames):
        if is_black(later.image):
            continue
        if video.live:
            return later
        raise ValueError(
            f"frame {index} is black; the first after it that is not is frame {later.index}: "
            f"choose that one, --pick X,Y@{later.index} or 'matchset learn' with --frame {later.index}"
        )
    raise ValueError(f"frame {index} is black, and so is what follows")


def is_black(image: npt.NDArray[np.uint8]) -> bool:
    """Whether a picture is black all over, noise aside."""
    size = [max(1, side // PARAMETERS.dark_part) for side in image.shape[1::-1]]
    return int(cv2.resize(image, size, interpolation=cv2.INTER_AREA).max()) < PARAMETERS.dark
