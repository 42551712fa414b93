"""A picture as the bytes of a PNG: `png_of`."""

import cv2
import numpy as np
import numpy.typing as npt


def png_of(image: npt.NDArray[np.uint8]) -> bytes:
    """Encode a picture, without loss.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.

    Raises
    ------
    ValueError
        If OpenCV cannot encode it.
    """
    done, packed = cv2.imencode(".png", np.ascontiguousarray(image))
    if not done:
        raise ValueError(f"a picture of shape {image.shape} cannot be encoded as PNG")
    return bytes(packed)
