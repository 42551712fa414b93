"""A picture on disk: `write_picture`."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.files.whole_file import write_whole


def write_picture(path: Path, image: npt.NDArray[np.uint8]) -> None:
    """Write a picture, whole or not at all; ValueError if it cannot be written."""
    good, packed = cv2.imencode(path.suffix, image)
    if not good:
        raise ValueError(f"cannot write a picture as {path.suffix}")
    try:
        write_whole(path, packed.tobytes())
    except OSError as error:
        raise ValueError(f"cannot write {path}: {error.strerror}") from error
