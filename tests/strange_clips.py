"""Small videos of the kinds that strangers have, written with PyAV: any codec, container and time stamps."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

Picture = npt.NDArray[np.uint8]

needs_opencv5 = pytest.mark.skipif(
    int(cv2.__version__.split(".")[0]) < 5, reason="OpenCV 4 does not read this file right (docs/limits.md)"
)

WIDTH, HEIGHT, BITS = 160, 120, 6
ENCODERS = {
    "libx264": {"bf": "0"},
    "libx265": {"x265-params": "log-level=none"},
    "libsvtav1": {"preset": "8", "crf": "12"},
}


def numbered(index: int, width: int = WIDTH, height: int = HEIGHT) -> Picture:
    """Return a picture that shows its number in binary, as bright and dark bars."""
    image = np.full((height, width, 3), 40, np.uint8)
    for bit in range(BITS):
        image[:, width * bit // BITS : width * (bit + 1) // BITS] = 200 if index >> bit & 1 else 40
    return image


def number_of(image: Picture) -> int:
    """Return the number that a picture shows."""
    row = image[image.shape[0] // 2].mean(axis=1)
    width = len(row)
    return int(sum((row[(2 * bit + 1) * width // (2 * BITS)] > 120) << bit for bit in range(BITS)))


def write(
    path: Path,
    codec: str,
    stamps: Sequence[float],
    *,
    ticks: int = 24000,
    pixels: str = "yuv420p",
    options: dict[str, str] | None = None,
    muxer: dict[str, str] | None = None,
) -> Path:
    """Write numbered pictures.

    Parameters
    ----------
    path : Path
        Its suffix says which container.
    codec : str
        FFmpeg's name of the encoder.
    stamps : sequence of float
        Times of the pictures, s, never falling.
    ticks : int
        Ticks per second of the time stamps.
    pixels : str
        FFmpeg's name of the pixel format.
    options, muxer : dict, optional
        Options of the encoder and of the container.

    Returns
    -------
    Path
        The same.
    """
    av = pytest.importorskip("av", reason="the package av is missing: it is in the dependency group `test`")
    equal = len(set(stamps)) < len(stamps)
    with av.open(str(path), "w", options=muxer or {}) as container:
        stream = container.add_stream(codec, rate=25, options=ENCODERS.get(codec, {}) | (options or {}))
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, pixels
        stream.time_base = stream.codec_context.time_base = base = Fraction(1, ticks)
        packets: list[Any] = []
        for index, stamp in enumerate(stamps):
            frame = av.VideoFrame.from_ndarray(numbered(index), format="bgr24").reformat(format=pixels)
            frame.time_base, frame.pts = base, index * 100 if equal else round(stamp * ticks)
            packets += stream.encode(frame)
        packets += stream.encode(None)
        for index, packet in enumerate(packets):
            if equal:  # an encoder takes no equal stamps, a container does as long as decoding times rise
                packet.time_base, packet.pts, packet.duration = base, round(stamps[index] * ticks), 0
                packet.dts = packet.pts - len(packets) + index
            container.mux(packet)
    return path
