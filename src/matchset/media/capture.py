"""How OpenCV is asked for a file, a camera or a stream, without its chatter on the terminal."""

import os
import threading
from types import TracebackType
from typing import Any, Protocol

import cv2

FFMPEG_LEVEL = "OPENCV_FFMPEG_LOGLEVEL"
USER_LEVELS = "OPENCV_LOG_LEVEL", "OPENCV_VIDEOIO_DEBUG"


class Capture(Protocol):
    """What is used of `cv2.VideoCapture`; the tests put a fake in its place."""

    def isOpened(self) -> bool:  # noqa: N802, D102 - OpenCV's name
        ...

    def getBackendName(self) -> str:  # noqa: N802, D102 - OpenCV's name
        ...

    def grab(self) -> bool:  # noqa: D102
        ...

    def retrieve(self) -> tuple[bool, Any]:  # noqa: D102
        ...

    def get(self, propId: int, /) -> float:  # noqa: N803, D102 - OpenCV's name
        ...

    def set(self, propId: int, value: float, /) -> bool:  # noqa: N803, D102 - OpenCV's name
        ...

    def release(self) -> None:  # noqa: D102
        ...


class SilentOpencv:
    """Context in which OpenCV logs nothing, unless the user's environment asks it to.

    The level belongs to the whole process, so nested and concurrent uses are counted: the last one out puts
    the user's level back. OpenCV reads FFmpeg's level from the environment once, when the first video of the
    process is opened, and what FFmpeg says of broken frames follows it from then on.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._depth = 0
        self._level: Any = 0
        self._own_ffmpeg = False
        # OpenCV 4.10 has cv2.setLogLevel, OpenCV 5 has cv2.utils.logging.setLogLevel
        self._log: Any = getattr(cv2.utils, "logging", cv2)

    def __enter__(self) -> None:
        with self._lock:
            self._depth += 1
            if self._depth > 1:
                return
            self._level = self._log.getLogLevel()
            if not any(name in os.environ for name in USER_LEVELS):
                self._log.setLogLevel(0)
            self._own_ffmpeg = FFMPEG_LEVEL not in os.environ and "OPENCV_FFMPEG_DEBUG" not in os.environ
            if self._own_ffmpeg:
                os.environ[FFMPEG_LEVEL] = "-8"  # AV_LOG_QUIET

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            self._depth -= 1
            if self._depth:
                return
            self._log.setLogLevel(self._level)
            if self._own_ffmpeg:
                os.environ.pop(FFMPEG_LEVEL, None)


hushed = SilentOpencv()


def opencv_name(name: str) -> str:
    """Return a file's name as it is, if OpenCV can open it: one that is not UTF-8 would end the program without a word.

    Raises
    ------
    ValueError
        With the name.
    """
    try:
        name.encode()
    except UnicodeEncodeError:
        raise ValueError(f"OpenCV cannot open a name that is not UTF-8: rename {name!a}") from None
    return name


def open_capture(
    source: int | str, timeout: float | None = None, silence: float | None = None, threads: int | None = None
) -> Capture:
    """Open a video with OpenCV; ask the result's `isOpened` whether it worked.

    Parameters
    ----------
    source : int or str
        Camera number, path or URL.
    timeout : float, optional
        For a stream: the longest that opening may block, s.
    silence : float, optional
        The same of reading, s; that of opening if it is not given.
    threads : int, optional
        How many may unpack a stream; as many as FFmpeg thinks right if it is not given.

    Returns
    -------
    Capture
        An OpenCV capture.

    Raises
    ------
    ValueError
        If the name is not UTF-8.
    """
    if isinstance(source, str):
        opencv_name(source)
    with hushed:
        if timeout is None:
            return cv2.VideoCapture(source)
        opening, reading = (max(1, round(1000 * limit)) for limit in (timeout, timeout if silence is None else silence))
        limits = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, opening, cv2.CAP_PROP_READ_TIMEOUT_MSEC, reading]
        number = getattr(cv2, "CAP_PROP_N_THREADS", None)  # OpenCV 4.10 has it, not everywhere
        if number is not None and threads is not None:
            limits += [number, threads]
        return cv2.VideoCapture(str(source), cv2.CAP_ANY, limits)


def unpack(capture: Capture) -> Any:
    """Picture that was grabbed last, gray ones as (h, w); None if it does not decode.

    Parameters
    ----------
    capture : Capture
        An open capture whose `grab` succeeded.

    Returns
    -------
    ndarray or None
        A picture of its own, never written to again.
    """
    decoded, image = capture.retrieve()
    if not decoded or image is None or image.size == 0:
        return None
    return image[..., 0] if image.ndim == 3 and image.shape[2] == 1 else image
