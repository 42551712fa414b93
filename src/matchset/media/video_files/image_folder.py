"""A folder of pictures, or a single one, read as a video."""

import re
from pathlib import Path
from typing import Any

from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_limited
from matchset.image.frame import Frame
from matchset.media.picture import decode_deep
from matchset.media.upright.depth import DepthScaling
from matchset.media.video_files.recorded import Recorded

SUFFIXES = {".bmp", ".jpeg", ".jpg", ".pgm", ".png", ".pnm", ".ppm", ".tif", ".tiff", ".webp"}
DEFAULT_FPS = 30.0  # format: a folder states no frame rate


class ImageFolder(Recorded):
    """The pictures of a folder in natural order (2 before 10), one frame each; gray ones stay gray.

    Parameters
    ----------
    path : Path
        A folder, or one picture.
    fps : float or None
        Pictures per second, 30 if None: times are index / fps.

    Raises
    ------
    ValueError
        If there is no picture, or none of them decodes.
    """

    damaged = 0

    def __init__(self, path: Path, fps: float | None) -> None:
        self._paths = in_order(path)
        if not self._paths:
            raise ValueError(f"no pictures ({', '.join(sorted(SUFFIXES))}) in the folder {path}")
        self.fps, self.length = fps or DEFAULT_FPS, len(self._paths)
        self.broken, self._next = 0, 0
        self._depth = DepthScaling()
        self._first = self._decode()
        if self._first is None:
            raise ValueError(f"no picture of {path} could be decoded")
        self.shape = self._first.image.shape

    @property
    def warnings(self) -> list[str]:
        """What is not as it should be, so far."""
        return self._depth.notes

    def go_to(self, index: int) -> None:
        """Go on with the picture of this index."""
        self._first, self._next = None, index

    def _decode(self) -> Frame | None:
        while self._next < self.length:
            index, self._next = self._next, self._next + 1
            image = decode(self._paths[index])
            if image is not None:
                return Frame(self._depth.to_bytes(image), index / self.fps, index)
            self.broken += 1
        return None

    def close(self) -> None:
        """Nothing is held open between two pictures."""


def in_order(path: Path) -> list[Path]:
    """Picture files of a folder in natural order; of a picture, itself."""
    if not path.is_dir():
        return [path]
    try:
        found = [item for item in path.iterdir() if is_picture(item) and not item.name.startswith(".")]
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from None
    return sorted(found, key=lambda item: natural(item.name))


def is_picture(path: Path) -> bool:
    """Whether the name is that of a picture."""
    return path.suffix.lower() in SUFFIXES


def natural(name: str) -> tuple[list[tuple[int, int, str]], str]:
    """Sort key in which numbers count as numbers; equal names differ by their spelling."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name.casefold())
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in parts], name


def decode(path: Path) -> Any:
    """Picture of a file as (h, w, 3) or (h, w), uint8 or uint16, or None if it is broken or cannot be read.

    Raises
    ------
    ValueError
        If it is larger than `matchset.image.files.limits.InputLimits` allows.
    """
    try:
        # cv2.imread fails on Windows where a name is not ASCII
        return decode_deep(read_limited(path, LIMITS.picture_file))
    except OSError:
        return None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
