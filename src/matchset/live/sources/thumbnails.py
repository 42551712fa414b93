"""Small pictures of the videos in the menu: `Thumbnails`."""

import threading
from collections import OrderedDict
from pathlib import Path

import cv2
import msgspec

from matchset.media.video import Video


class ThumbnailParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How small they are, and how many are kept.

    Parameters
    ----------
    width : int
        px
    quality : int
        Of the JPEG, 1 ... 100. Chosen by hand.
    kept : int
        Pictures, of some 8 kB. Chosen by hand: more than a menu has entries.
    """

    width: int = 240
    quality: int = 75
    kept: int = 100


class Thumbnails:
    """Reads the first picture of a video once; for any thread, one at a time.

    Parameters
    ----------
    parameters : ThumbnailParameters, optional
    """

    def __init__(self, parameters: ThumbnailParameters | None = None) -> None:
        self._parameters = parameters or ThumbnailParameters()
        self._kept: OrderedDict[tuple[str, int], bytes] = OrderedDict()
        self._lock = threading.Lock()

    def of(self, origin: str) -> bytes:
        """Return the first picture of a video file, a JPEG.

        Raises
        ------
        ValueError
            If there is none.
        """
        try:
            key = origin, Path(origin).stat().st_mtime_ns
        except OSError as error:
            raise ValueError(f"{origin}: {error.strerror}") from None
        with self._lock:
            if key not in self._kept:
                self._kept[key] = self._make(origin)
            while len(self._kept) > self._parameters.kept:
                self._kept.popitem(last=False)
            return self._kept[key]

    def _make(self, origin: str) -> bytes:
        with Video(origin) as video:
            frame = next(iter(video), None)
        if frame is None:
            raise ValueError(f"{origin} has no picture")
        height, width = frame.image.shape[:2]
        size = self._parameters.width, max(1, round(self._parameters.width * height / width))
        small = cv2.resize(frame.image, size, interpolation=cv2.INTER_AREA)
        return cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, self._parameters.quality])[1].tobytes()
