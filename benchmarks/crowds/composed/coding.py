"""What a camera's coding makes of pictures: `coded`."""

import itertools
from collections.abc import Iterable, Iterator
from typing import Any

import cv2
import numpy as np

from benchmarks.crowds.composed.footage import HEIGHT, WIDTH, Bytes

CODINGS = ("jpeg", "mpeg4")


def coded(pictures: Iterable[Bytes], coding: str, quality: float) -> Iterator[Bytes]:
    """Code pictures and decode them again.

    Parameters
    ----------
    pictures : iterable of arrays
    coding : str
        One of `CODINGS`.
    quality : float
        From 0 to 1.

    Yields
    ------
    array of uint8
    """
    if coding == "jpeg":
        for picture in pictures:
            _, data = cv2.imencode(".jpg", picture, (cv2.IMWRITE_JPEG_QUALITY, round(60 + 32 * quality)))
            yield np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), np.uint8)
        return
    yield from _mpeg4(pictures, round(9 - 6 * quality))


def _mpeg4(pictures: Iterable[Bytes], scale: int) -> Iterator[Bytes]:
    """Code by MPEG-4 with one quantizer."""
    import av

    encoder: Any = av.CodecContext.create("mpeg4", "w")
    encoder.width, encoder.height, encoder.pix_fmt = WIDTH, HEIGHT, "yuv420p"
    encoder.framerate, encoder.thread_count, encoder.max_b_frames = 30, 1, 0
    encoder.bit_rate = 40_000_000
    encoder.options = {"qmin": str(scale), "qmax": str(scale)}
    decoder: Any = av.CodecContext.create("mpeg4", "r")
    decoder.thread_count = 1
    for picture in itertools.chain(pictures, (None,)):
        frame = None if picture is None else av.VideoFrame.from_ndarray(picture, format="bgr24")
        for packet in encoder.encode(frame):
            for decoded in decoder.decode(packet):
                yield np.asarray(decoded.to_ndarray(format="bgr24"), np.uint8)
    for decoded in decoder.decode(None):
        yield np.asarray(decoded.to_ndarray(format="bgr24"), np.uint8)
