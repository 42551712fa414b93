"""Decoding with PyAV (the extra `av`) what OpenCV's own FFmpeg cannot, AV1 above all: `open_pyav`."""

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np

from matchset.image.capture import Capture

QUARTER = 90  # geometry: degrees of a quarter turn


def open_pyav(path: str) -> Capture | None:
    """Open a video file with PyAV.

    Parameters
    ----------
    path : str
        The file.

    Returns
    -------
    Capture or None
        None if PyAV is not installed; ask the result's `isOpened` whether it worked.
    """
    try:
        import av
    except ImportError:
        return None
    try:
        return PyavCapture(av.open(path))
    except (OSError, ValueError, IndexError):  # FFmpeg's errors are OSError or ValueError too; IndexError: only sound
        return PyavCapture(None)


class PyavCapture:
    """What `cv2.VideoCapture` does for a file, as far as it is used, done by PyAV.

    Parameters
    ----------
    container : av.container.InputContainer or None
        An open file; None for one that could not be opened.
    """

    def __init__(self, container: Any) -> None:
        self._container, self._frame = container, None
        if container is not None:
            self._stream = container.streams.video[0]
            self._stream.thread_type = "AUTO"
            self._frames: Iterator[Any] = self._decoded()

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        """Whether the file was opened."""
        return self._container is not None

    def getBackendName(self) -> str:  # noqa: N802 - OpenCV's name
        """Name of what decodes."""
        return "PyAV"

    def _decoded(self) -> Iterator[Any]:
        """Yield every frame; None for a packet that does not decode."""
        for packet in self._container.demux(self._stream):
            try:
                yield from packet.decode()
            except (OSError, ValueError):
                yield None

    def grab(self) -> bool:
        """Decode the next frame; False if it is broken, and at the end."""
        try:
            self._frame = next(self._frames, None)
        except (OSError, ValueError):  # the container itself is broken from here on
            self._frame = None
        return self._frame is not None

    def retrieve(self) -> tuple[bool, Any]:
        """Picture that was grabbed last, (h, w, 3) uint8 BGR, turned upright."""
        frame: Any = self._frame
        if frame is None:
            return False, None
        turns = round(frame.rotation / QUARTER) % 4
        return True, np.ascontiguousarray(np.rot90(frame.to_ndarray(format="bgr24"), turns))

    def get(self, propId: int, /) -> float:  # noqa: N803 - OpenCV's name
        """Value of one of OpenCV's properties; 0 if it is not known."""
        if propId == cv2.CAP_PROP_FRAME_COUNT:
            return float(self._stream.frames)
        if propId == cv2.CAP_PROP_FPS:
            return float(self._stream.average_rate or 0.0)
        if propId == cv2.CAP_PROP_POS_MSEC and self._frame is not None:
            frame: Any = self._frame
            start = float((self._stream.start_time or 0) * self._stream.time_base)
            return float("nan") if frame.time is None else 1000.0 * (frame.time - start)
        return 0.0

    def set(self, propId: int, value: float, /) -> bool:  # noqa: N803 - OpenCV's name
        """Go to a key picture at or before a time, ms; nothing else can be set."""
        if propId != cv2.CAP_PROP_POS_MSEC:
            return False
        ticks = int(value / 1000.0 / self._stream.time_base) + (self._stream.start_time or 0)
        try:
            self._container.seek(ticks, stream=self._stream)
        except (OSError, ValueError):
            return False
        self._frame, self._frames = None, self._decoded()
        return True

    def release(self) -> None:
        """Close the file."""
        if self._container is not None:
            self._container.close()
