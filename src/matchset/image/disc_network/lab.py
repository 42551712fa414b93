"""Colors of a picture in CIE Lab, which the network and its searches read: `lab_of`."""

import cv2
import numpy as np
import numpy.typing as npt

CHANNELS = 3  # format: of a picture with color


def lab_of(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """Colors of a picture in CIE Lab; those of a gray one have no chroma.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
        BGR or gray.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
        L 0 ... 100, a and b about -100 ... 100.
    """
    share = image.astype(np.float32) / np.float32(255.0)
    if share.shape[2:] != (CHANNELS,):
        share = np.asarray(cv2.cvtColor(share, cv2.COLOR_GRAY2BGR), np.float32)
    return np.asarray(cv2.cvtColor(share, cv2.COLOR_BGR2Lab), np.float32)
