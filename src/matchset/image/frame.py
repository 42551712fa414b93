"""One picture of a video: `Frame`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import check_kind, check_number

BYTES = np.dtype(np.uint8)  # made once: to make it costs more than all else that is checked


class Frame(msgspec.Struct, frozen=True):
    """One picture and when it was taken.

    Pixel centers lie at integer coordinates: x to the right, y down; the picture spans -0.5 ... width - 0.5.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.
    time : float
        When it was taken, s, in any clock that runs forward.
    index : int
        Its place in the video, from 0, in decode order.

    Raises
    ------
    ValueError
        If the picture is not uint8, has another shape or no pixels, or the time is not finite.
    TypeError
        If the time is no number.
    """

    image: npt.NDArray[np.uint8]
    time: float = 0.0
    index: int = 0

    def __post_init__(self) -> None:
        check_image(self.image)
        if type(self.time) is not float:
            check_number(f"the time of frame {self.index}", self.time)
        if not math.isfinite(self.time):
            raise ValueError(f"the time of frame {self.index} must be finite, got {self.time}")


def check_frame(frame: Frame) -> None:
    """Refuse what is not a `Frame` (TypeError): an array, for one, has no time."""
    if not isinstance(frame, Frame):
        check_kind("a frame", frame, Frame, "make one with matchset.Frame(image, time, index)")


def check_image(image: npt.NDArray[np.uint8]) -> None:
    """Refuse what is not a BGR or gray picture of bytes.

    Parameters
    ----------
    image : ndarray
        What a caller handed in.

    Raises
    ------
    ValueError
        If it is not an array of uint8 of shape (h, w, 3) or (h, w) with at least one pixel.
    """
    if not isinstance(image, np.ndarray) or image.dtype != BYTES:
        found = image.dtype if isinstance(image, np.ndarray) else type(image).__name__
        raise ValueError(f"a picture must be an array of uint8, got {found}")
    if image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] != 3) or image.size == 0:
        raise ValueError(f"a picture must have shape (h, w, 3) or (h, w), got {image.shape}")
