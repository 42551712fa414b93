"""Small videos whose headers say how they are to be looked at, written with PyAV: pixels, display matrices, streams."""

import struct
from collections.abc import Iterable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

Picture = npt.NDArray[np.uint8]
ONE = 1 << 16
BALL, WALL = (40, 60, 220), (150, 140, 120)


def need_av() -> Any:
    return pytest.importorskip("av", reason="the package av is missing: it is in the dependency group `test`")


def ball_picture(size: tuple[int, int], circle: tuple[float, float, float], squeeze: float = 1.0) -> Picture:
    """Draw a ball as it is stored where a pixel is as wide as `squeeze` heights.

    Parameters
    ----------
    size : tuple of int
        Width and height, stored px.
    circle : tuple of float
        x and y of the center, stored px; radius, px of the height.
    squeeze : float
    """
    width, height = size
    x, y, radius = circle
    rows, columns = np.mgrid[:height, :width].astype(float)
    share = np.clip(radius - np.hypot((columns - x) * squeeze, rows - y) + 0.5, 0.0, 1.0)[..., None]
    noise = np.random.default_rng(round(x)).normal(0.0, 2.0, (height, width, 3))
    return np.asarray(np.clip(np.array(BALL) * share + np.array(WALL) * (1.0 - share) + noise, 0, 255), np.uint8)


def write_clip(
    path: Path,
    streams: Sequence[Sequence[Picture]],
    codec: str = "libx264",
    ratio: Fraction | None = None,
    pixels: str = "yuv420p",
    options: dict[str, str] | None = None,
) -> Path:
    """Write a video with one or more streams of 25 pictures a second.

    Parameters
    ----------
    path : Path
        Its suffix says which container.
    streams : sequence of sequences of pictures
    codec : str
        FFmpeg's name of the encoder.
    ratio : Fraction, optional
        Width of a pixel, in its heights.
    pixels : str
        FFmpeg's name of the pixel format.
    options : dict, optional
        Of the encoder.
    """
    av = need_av()
    with av.open(str(path), "w") as container:
        made = []
        for pictures in streams:
            stream = container.add_stream(codec, rate=25, options=options or {})
            stream.height, stream.width = pictures[0].shape[:2]
            stream.pix_fmt = pixels
            stream.codec_context.bit_rate = 4_000_000
            if ratio is not None:
                stream.codec_context.sample_aspect_ratio = ratio
            made.append(stream)
        for stream, pictures in zip(made, streams, strict=True):
            for picture in pictures:
                container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")))
            container.mux(stream.encode(None))
    return path


def with_matrix(path: Path, matrix: tuple[int, int, int, int], scale: int = ONE) -> Path:
    """Copy an MP4 with another display matrix a, b, c, d in the header of its first track."""
    data = bytearray(path.read_bytes())
    at = data.find(b"tkhd") + 4 + 40
    a, b, c, d = (scale * value for value in matrix)
    data[at : at + 36] = struct.pack(">9i", a, b, 0, c, d, 0, 0, 0, 1 << 30)
    result = path.with_stem("_".join(("matrix", *map(str, matrix))))
    result.write_bytes(data)
    return result


def with_ratio(path: Path, wide: int, high: int) -> Path:
    """Copy an MP4 with another shape of its pixels in its header, which must have one."""
    data = bytearray(path.read_bytes())
    at = data.find(b"pasp") + 4
    assert at > 4
    data[at : at + 8] = struct.pack(">II", wide, high)
    result = path.with_stem(f"ratio_{wide}_{high}")
    result.write_bytes(data)
    return result


def access_units(
    pictures: Iterable[Picture], codec: str = "libx264", key: int = 10, own: str = "sliced-threads=0"
) -> list[bytes]:
    """Code pictures as messages hold them: one packet each, its headers before every key picture.

    `own` are more settings of x264, such as "intra-refresh=1": no key pictures, but a part of each made anew.
    """
    av = need_av()
    encoder: Any = None
    packets: list[Any] = []
    for index, picture in enumerate(pictures):
        if encoder is None:
            encoder = av.CodecContext.create(codec, "w")
            encoder.height, encoder.width = picture.shape[:2]
            encoder.pix_fmt, encoder.time_base, encoder.framerate = "yuv420p", Fraction(1, 25), Fraction(25)
            more = f"repeat-headers=1:scenecut=0:sliced-threads=0:slices=1:{own}"
            encoder.options = {"tune": "zerolatency", "g": str(key), "bf": "0", "x264-params": more}
        frame = av.VideoFrame.from_ndarray(picture, format="bgr24")
        frame.pts = index
        packets += encoder.encode(frame)
    packets += encoder.encode(None)
    return [bytes(packet) for packet in packets]


def middle_of(picture: Picture) -> tuple[float, float, float]:
    """Center and mean radius of the red ball in a picture, px, by its area."""
    blue, red = picture[..., 0].astype(float), picture[..., 2].astype(float)
    share = np.clip((red - blue - (WALL[2] - WALL[0])) / (BALL[2] - BALL[0] - WALL[2] + WALL[0]), 0.0, 1.0)
    share[share < 0.25] = 0.0
    moments = cv2.moments(share.astype(np.float32))
    area = moments["m00"]
    return moments["m10"] / area, moments["m01"] / area, float(np.sqrt(area / np.pi))
