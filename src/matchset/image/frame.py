"""One picture of a video: `Frame`; and how a plain array becomes one (`ArrayFrames`)."""

import math
import time
from typing import Literal

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.display.png import png_of
from matchset.numeric.arguments import check_number
from matchset.numeric.words import one_line, short

Rows = Literal["all", "top", "bottom"]
ROWS: dict[Rows, int] = {"all": 0, "top": 1, "bottom": 2}  # format: rows of a frame's time, as kernels are told them
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
    damaged : bool
        Whether the decoder reported errors in it, or in a picture that it was made from: parts may be smeared or old.
    pixel_aspect : float
        Width of a pixel in its heights, as `Video.pixel_aspect`: where it is not 1 a ball is no circle.
    rows : str
        Which rows were taken at its time: "all"; or "top", the even ones, or "bottom", the odd ones, of a half-frame,
        whose other rows still hold the field before.

    Raises
    ------
    ValueError
        If the picture is not uint8, has another shape or no pixels, the time is not finite, or there are no such rows.
    TypeError
        If the time is no number.
    """

    image: npt.NDArray[np.uint8]
    time: float = 0.0
    index: int = 0
    damaged: bool = False
    pixel_aspect: float = 1.0
    rows: Rows = "all"

    def __post_init__(self) -> None:
        check_image(self.image)
        if type(self.time) is not float:
            check_number(f"the time of frame {self.index}", self.time)
        if self.rows not in ROWS:
            raise ValueError(f"rows of a frame are all, top or bottom, got {self.rows!r}")
        if not math.isfinite(self.time):
            raise ValueError(f"the time of frame {self.index} must be finite, got {self.time}")

    @one_line
    def __repr__(self) -> str:
        height, width = self.image.shape[:2]
        kind = "BGR" if self.image.ndim == 3 else "gray"
        more = (", damaged" if self.damaged else "") + (f", {self.rows} rows" if self.rows != "all" else "")
        return f"Frame({width} x {height} {kind}, {short(self.time)} s, index {self.index}{more})"

    def _repr_png_(self) -> bytes:
        """Show the picture in a notebook."""
        return png_of(self.image)


Picture = Frame | npt.NDArray[np.uint8]


class ArrayFrames:
    """Frames of the plain arrays that a caller hands in one after the other: numbered, with times of a rate or a clock.

    Parameters
    ----------
    fps : float or None
        Their rate: the times are index / fps. None: each has the time of the call on the clock of `time.monotonic`.

    Attributes
    ----------
    count : int
        How many there were.

    Raises
    ------
    ValueError
        If the rate is not positive and finite.
    """

    def __init__(self, fps: float | None) -> None:
        if fps is not None:
            check_number("fps", fps)
            if not 0.0 < fps < math.inf:
                raise ValueError(f"fps must be positive, or None for the clock, got {fps}")
        self.fps, self.count = fps, 0

    def next(self, picture: Picture, earlier: int) -> Frame:
        """Return the frame of a picture, `earlier` frames being known.

        Raises
        ------
        ValueError
            If an array comes after frames or the other way around, or it is no picture.
        TypeError
            If it is neither a frame nor an array.
        """
        if isinstance(picture, Frame) and not self.count:
            return picture
        if isinstance(picture, Frame) or (earlier and not self.count):
            came, before = ("Frame", "arrays") if isinstance(picture, Frame) else ("array", "Frames")
            raise ValueError(
                f"this {came} comes after {before}, and their times would not fit together: "
                "make each one with ms.Frame(image, time), or hand in arrays only"
            )
        frame = _framed(picture, time.monotonic() if self.fps is None else self.count / self.fps, self.count)
        self.count += 1
        return frame


def frame_of(picture: Picture, seconds: float = 0.0) -> Frame:
    """Return a frame as it is, an array as a frame of this time, s; TypeError or ValueError as for `ArrayFrames`."""
    return picture if isinstance(picture, Frame) else _framed(picture, seconds)


def image_of(picture: Picture) -> npt.NDArray[np.uint8]:
    """Return the array of a frame or an array, checked: ValueError if it is none."""
    image = picture.image if isinstance(picture, Frame) else picture
    check_image(image)
    return image


def _framed(picture: object, seconds: float, index: int = 0) -> Frame:
    """Make a frame of an array; TypeError for anything else, ValueError for an array that is no picture."""
    wanted = "an array (h, w, 3) BGR or (h, w) gray of uint8, or ms.Frame(image, time)"
    if not isinstance(picture, np.ndarray):
        raise TypeError(f"a picture must be {wanted}, got {type(picture).__name__}")
    try:
        return Frame(picture, seconds, index)
    except ValueError as error:
        raise ValueError(f"{error}; wanted is {wanted}") from None


def check_follows(frame: Frame, shape: tuple[int, ...] | None, seconds: float) -> None:
    """Refuse a frame whose shape is not that of the frames before, or that is not later than the last one (ValueError).

    Parameters
    ----------
    frame : Frame
    shape : tuple of int or None
        Of the pictures before; None if there was none.
    seconds : float
        The last one's time, s.
    """
    if shape is not None and frame.image.shape != shape:
        raise ValueError(f"frame {frame.index} has shape {frame.image.shape}, the frames before it had {shape}")
    if not frame.time > seconds:
        raise ValueError(
            f"time must run forward: frame {frame.index} is at {frame.time} s, the one before at {seconds} s"
        )


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


def channels_last(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """View of a picture as (h, w, channels); a copy only where it is not in one piece or may not be written to.

    Read-only arrays are another type to the compiler, which would start in the middle of a video.
    """
    whole = image if image.flags.carray else np.array(image, order="C")
    return whole if whole.ndim == 3 else whole[:, :, np.newaxis]
