"""Pixels that are not square, made square: `square_size`, `squared`; refused where they stay: `check_square`.

DV, HDV, DVDs and many analog cameras store pictures whose pixels are wider or narrower than they are high. A ball is an
ellipse there, and its distance wrong. Pictures are resampled once, along their rows: these stay as they are, so the two
fields of an interlaced picture stay apart. Only where a picture would lose too much, one whose pixels are much higher
than wide, rows are added: such pictures are single fields.
"""

import cv2
import msgspec
import numpy as np
import numpy.typing as npt


class PixelParameters(msgspec.Struct, frozen=True):
    """When pixels are taken for not square.

    Parameters
    ----------
    even : float
        Difference of width and height, as a share, up to which pixels are taken for square: a distance is wrong by half
        of it. Less resamples pictures for headers that are rounded to multiples of 16 px. Chosen by: 1080 of 1088 rows
        are 0.7 %, the least ratio that a standard names is 10:11.
    most : float
        Ratio, either way, from which a header is taken for wrong. Chosen by: the widest of H.264 (Table E-1) is 32:11.
    narrowest : float
        Ratio of width and height below which rows are added, in place of pixels of a row that are taken away. Chosen
        by: NTSC (8:9, 10:11), which is interlaced, lies above, single fields (1:2) below.
    """

    even: float = 0.008
    most: float = 4.0
    narrowest: float = 0.7


DEFAULT = PixelParameters()


def is_square(aspect: float, parameters: PixelParameters = DEFAULT) -> bool:
    """Whether pixels of this width, in heights, are as good as square."""
    return abs(aspect - 1.0) <= parameters.even


def check_square(aspect: float, how: str = "square=False") -> None:
    """Refuse to locate in pictures whose pixels are not square.

    Parameters
    ----------
    aspect : float
        Width of a pixel, in its heights.
    how : str
        What the user said, so that pictures come as they are stored.

    Raises
    ------
    ValueError
        If they are not square.
    """
    if not is_square(aspect):
        raise ValueError(
            f"pixels are {aspect:.4g} times as wide as high: a ball is no circle in such pictures, and nothing can be "
            f"located; leave out {how}, they are made square then"
        )


def is_credible(aspect: float, parameters: PixelParameters = DEFAULT) -> bool:
    """Whether there are pixels of this width, in heights."""
    return 1.0 / parameters.most <= aspect <= parameters.most


def square_size(width: int, height: int, aspect: float, parameters: PixelParameters = DEFAULT) -> tuple[int, int]:
    """Size, px, that a picture has with square pixels.

    Parameters
    ----------
    width, height : int
        As stored, px.
    aspect : float
        Width of a pixel, in its heights.
    parameters : PixelParameters

    Returns
    -------
    tuple of int
        Width and height.
    """
    if is_square(aspect, parameters):
        return width, height
    if aspect < parameters.narrowest:
        return width, max(1, round(height / aspect))
    return max(1, round(width * aspect)), height


def squared(image: npt.NDArray[np.uint8], aspect: float) -> npt.NDArray[np.uint8]:
    """Resample a picture to square pixels.

    A point at x becomes x' = (x + 1/2) w' / w - 1/2: pixel centers are at integers, before and after.

    Parameters
    ----------
    image : ndarray of shape (h, w) or (h, w, 3), uint8
    aspect : float
        Width of a pixel, in its heights.

    Returns
    -------
    ndarray
        The same picture if its pixels are square.
    """
    height, width = image.shape[:2]
    size = square_size(width, height, aspect)
    if size == (width, height):
        return image
    shrinks = size[0] < width  # there cubic interpolation would let fine patterns alias
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC), np.uint8)
