"""Pictures that come as a video, a piece of it in each message, decoded by PyAV (the extra `av`): `VideoMessages`."""

import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.media.damaged.damage import Damage
from matchset.media.damaged.frame_numbers import FrameNumbers
from matchset.numeric.imports import advice

# format: FFmpeg's names of the codecs that messages name
CODECS = {"h264": "h264", "avc": "h264", "h265": "hevc", "hevc": "hevc", "vp9": "vp9", "av1": "av1"}


class DecodedPicture(NamedTuple):
    """A picture of a video.

    Attributes
    ----------
    number : int
        Of the message that it belongs to.
    image : ndarray of shape (h, w, 3), uint8
        BGR.
    damaged : bool
        Whether the decoder reports errors in it, or in one that it was made from.
    """

    number: int
    image: npt.NDArray[np.uint8]
    damaged: bool


def codec_of(form: str) -> str | None:
    """Return FFmpeg's name of the codec that a message names; None if its picture is none of a video."""
    words = re.split(r"[^a-z0-9]+", form.lower().replace("h.26", "h26"))
    return next((CODECS[word] for word in words if word in CODECS), None)


class VideoMessages:
    """Decodes the messages of one topic, in their order.

    Parameters
    ----------
    codec : str
        FFmpeg's name of it.

    Raises
    ------
    ValueError
        If PyAV is not installed.
    """

    def __init__(self, codec: str) -> None:
        try:
            import av
        except ImportError:
            raise ValueError(f"its pictures are a video ({codec}), which PyAV decodes: {advice('av')}") from None
        self._errors = OSError, ValueError, av.FFmpegError
        self._packet, self._damage = av.Packet, Damage(FrameNumbers() if codec == "h264" else None)
        self._decoder: Any = av.CodecContext.create(codec, "r")
        self._decoder.thread_count = 1  # more of them hand out each picture some messages later

    def decode(self, number: int, data: bytes) -> Iterator[DecodedPicture]:
        """Yield the pictures that are complete with the data of a message; often this one's alone."""
        self._damage.note_packet(data)
        packet = self._packet(data)
        packet.pts = packet.dts = number
        return self._pictures(packet, number)

    def finish(self) -> Iterator[DecodedPicture]:
        """Yield the pictures that are left at the end."""
        return self._pictures(None, 0)

    def _pictures(self, packet: Any, number: int) -> Iterator[DecodedPicture]:
        try:
            frames = self._decoder.decode(packet)
        except self._errors:
            self._damage.note_loss()
            return
        for frame in frames:
            damaged = self._damage.of(bool(frame.is_corrupt), bool(frame.key_frame))
            image = np.ascontiguousarray(frame.to_ndarray(format="bgr24"))
            yield DecodedPicture(number if frame.pts is None else int(frame.pts), image, damaged)
