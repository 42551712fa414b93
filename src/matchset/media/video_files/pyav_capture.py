"""Decoding with PyAV (the extra `av`) what OpenCV's own FFmpeg cannot: AV1, another stream, what is damaged."""

import math
from collections.abc import Iterator
from typing import Any, Literal, NamedTuple

import cv2
import numpy as np

from matchset.media.capture import Capture
from matchset.media.damaged.damage import Damage
from matchset.media.damaged.frame_numbers import FrameNumbers

CODED = ("rtsp", "rtsps", "rtp", "udp", "tcp", "srt", "rtmp")  # format: addresses of streams that are mostly H.264
RTSP = {"rtsp_flags": "prefer_tcp"}  # as OpenCV asks for
FIELD_ORDERS: dict[int, Literal["frames", "top", "bottom"]] = {
    1: "frames",
    2: "top",
    3: "bottom",
    4: "bottom",
    5: "top",
}  # format: FFmpeg's AVFieldOrder; of 4 and 5 the other field is coded first
KINDS = ("attached_pic", "timed_thumbnails")  # format: FFmpeg's names of streams that are no video


class StreamFacts(NamedTuple):
    """What is known of a video stream.

    Attributes
    ----------
    seconds : float
        How long it plays; 0 if that is not known.
    size : tuple of int
        Width and height, px.
    """

    seconds: float
    size: tuple[int, int]


def has_pyav() -> bool:
    """Whether PyAV is installed."""
    try:
        import av  # noqa: F401
    except ImportError:
        return False
    return True


def open_pyav(path: str, stream: int = 0, looks: bool = False) -> Capture | None:
    """Open a video file with PyAV.

    Parameters
    ----------
    path : str
        The file.
    stream : int
        Which of its video streams, from 0.
    looks : bool
        Whether pictures that are missing are noticed, too.

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
        return PyavCapture(av.open(path), stream, looks)
    except (OSError, ValueError, IndexError, av.FFmpegError):  # IndexError: only sound
        return PyavCapture(None)


def open_pyav_stream(url: str, opening: float, reading: float) -> Capture | None:
    """Open a coded stream from the network with PyAV, which tells the errors of the decoder.

    Parameters
    ----------
    url : str
    opening, reading : float
        Longest times that opening, and waiting for more, may take, s.

    Returns
    -------
    Capture or None
        None if PyAV is not installed, or the address is not that of a coded stream: those of http:// are mostly JPEG,
        each picture on its own.
    """
    if not has_pyav() or url.partition("://")[0].lower() not in CODED:
        return None
    import av

    try:
        return PyavCapture(av.open(url, timeout=(opening, reading), options=RTSP), looks=True)
    except (OSError, ValueError, IndexError, av.FFmpegError):  # as above
        return PyavCapture(None)


def reports_damage(capture: Capture) -> bool:
    """Whether the decoder reported errors in the frame that was grabbed last, or in one that it was made from.

    Parameters
    ----------
    capture : Capture
        Of OpenCV: it does not say, so no.
    """
    return isinstance(capture, PyavCapture) and capture.damaged


def list_streams(path: str) -> list[StreamFacts]:
    """List the video streams of a file; empty if PyAV is not installed, or cannot open it."""
    try:
        import av
    except ImportError:
        return []
    try:
        with av.open(path) as container:
            return [StreamFacts(_seconds(each), (each.width, each.height)) for each in _videos(container)]
    except (OSError, ValueError, av.FFmpegError):
        return []


def stated_fields(path: str, stream: int) -> Literal["frames", "top", "bottom"] | None:
    """Which field comes first, as the header of a file says; None if it does not say, or PyAV is not installed.

    Parameters
    ----------
    path : str
        The file.
    stream : int
        Which of its video streams, from 0.
    """
    try:
        import av
    except ImportError:
        return None
    try:
        with av.open(path) as container:
            return FIELD_ORDERS.get(int(_videos(container)[stream].codec_context.field_order))
    except (OSError, ValueError, IndexError, AttributeError, av.FFmpegError):  # AttributeError: an older PyAV
        return None


def _videos(container: Any) -> list[Any]:
    """Streams of a file with video; a picture of the cover is none, unless there is nothing else."""
    found = list(container.streams.video)
    return [each for each in found if not any(kind in str(each.disposition) for kind in KINDS)] or found


def _seconds(stream: Any) -> float:
    """How long a stream plays, s: by its header, or by the label that Matroska writes; 0 if neither says."""
    if stream.duration is not None and stream.time_base is not None:
        return float(stream.duration * stream.time_base)
    label = next((text for name, text in stream.metadata.items() if name.upper().startswith("DURATION")), "")
    try:
        hours, minutes, seconds = label.split(":")
        return 3600.0 * float(hours) + 60.0 * float(minutes) + float(seconds)
    except ValueError:
        return 0.0


class PyavCapture:
    """What `cv2.VideoCapture` does for a file, as far as it is used, done by PyAV.

    Parameters
    ----------
    container : av.container.InputContainer or None
        An open file; None for one that could not be opened.
    stream : int
        Which of its video streams, from 0.
    looks : bool
        Whether pictures that are missing are noticed, too. Then, as while live, each picture comes out with its packet:
        pictures are not decoded at the same time, which takes longer.

    Attributes
    ----------
    damaged : bool
        Whether the decoder reported errors in the frame that was grabbed last, or in one that it was made from.
    """

    def __init__(self, container: Any, stream: int = 0, looks: bool = False) -> None:
        from av import FFmpegError

        self._errors = OSError, ValueError, FFmpegError  # what is silent for too long is an FFmpegError alone
        self._container, self._frame, self._ahead = container, None, None
        self.damaged, self._looks = False, looks
        if container is not None:
            self._stream = _videos(container)[stream]
            self._stream.thread_type = "SLICE" if looks else "AUTO"
            self._frames: Iterator[Any]
            self._begin()

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        """Whether the file was opened."""
        return self._container is not None

    def getBackendName(self) -> str:  # noqa: N802 - OpenCV's name
        """Name of what decodes."""
        return "PyAV"

    def _begin(self) -> None:
        """Know nothing of the pictures before the next one."""
        codec = self._stream.codec_context
        self._damage = Damage(FrameNumbers(bytes(codec.extradata or b"")) if codec.name == "h264" else None)
        self._frame, self._ahead, self._frames = None, None, self._decoded()

    def _decoded(self) -> Iterator[Any]:
        """Yield every frame; None for a packet that does not decode."""
        for packet in self._container.demux(self._stream):
            if self._looks and packet.size:
                self._damage.note_packet(bytes(packet))
            try:
                yield from packet.decode()
            except self._errors:
                self._damage.note_loss()
                yield None

    def grab(self) -> bool:
        """Decode the next frame; False if it is broken, and at the end."""
        if self._ahead is not None:
            self._frame, self._ahead = self._ahead, None
        else:
            self._frame = self._next()
        frame: Any = self._frame
        if frame is not None:
            self.damaged = self._damage.of(bool(frame.is_corrupt), bool(frame.key_frame))
        return frame is not None

    def _next(self) -> Any:
        try:
            return next(self._frames, None)
        except self._errors:  # a stream was silent for too long, a file is broken from here on
            self._frames = self._decoded() if self._looks else iter(())
            return None

    def retrieve(self) -> tuple[bool, Any]:
        """Picture that was grabbed last, (h, w, 3) uint8 BGR, as it is stored."""
        frame: Any = self._frame
        return (False, None) if frame is None else (True, np.ascontiguousarray(frame.to_ndarray(format="bgr24")))

    def get(self, propId: int, /) -> float:  # noqa: N803 - OpenCV's name
        """Value of one of OpenCV's properties; 0 if it is not known."""
        stream = self._stream
        if propId in (cv2.CAP_PROP_SAR_NUM, cv2.CAP_PROP_SAR_DEN):
            ratio = stream.sample_aspect_ratio
            if ratio is None:
                return 0.0
            return float(ratio.numerator if propId == cv2.CAP_PROP_SAR_NUM else ratio.denominator)
        if propId == cv2.CAP_PROP_POS_MSEC:
            frame: Any = self._frame
            start = float((stream.start_time or 0) * stream.time_base)
            return math.nan if frame is None or frame.time is None else 1000.0 * (frame.time - start)
        if propId == cv2.CAP_PROP_ORIENTATION_META:
            return self._angle()
        values = {
            cv2.CAP_PROP_FRAME_COUNT: stream.frames,
            cv2.CAP_PROP_FPS: stream.average_rate or 0.0,
            cv2.CAP_PROP_FRAME_WIDTH: stream.width,
            cv2.CAP_PROP_FRAME_HEIGHT: stream.height,
        }
        return float(values.get(propId, 0.0))

    def _angle(self) -> float:
        """Degrees by which pictures are to be turned clockwise; the first one says it."""
        if self._frame is None and self._ahead is None:
            self._ahead = self._next()
        frame: Any = self._frame or self._ahead
        return 0.0 if frame is None else float(-frame.rotation % 360)

    def set(self, propId: int, value: float, /) -> bool:  # noqa: N803 - OpenCV's name
        """Go to a key picture at or before a time, ms; nothing else can be set."""
        if propId != cv2.CAP_PROP_POS_MSEC:
            return False
        ticks = int(value / 1000.0 / self._stream.time_base) + (self._stream.start_time or 0)
        try:
            self._container.seek(ticks, stream=self._stream)
        except self._errors:
            return False
        self._begin()
        return True

    def release(self) -> None:
        """Close the file."""
        if self._container is not None:
            self._container.close()
