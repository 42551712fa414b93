"""A worse copy of a real clip, and its truth: `Copy`, `write_copy`."""

import itertools
import math
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.real.clips import Clip
from matchset.app.films.codecs import EVEN
from matchset.app.track.score import TruthRow
from matchset.sim.digital_camera.processing import saturate

Image = npt.NDArray[np.uint8]

FRAMES_PER_SECOND = 30


class Copy(msgspec.Struct, frozen=True):
    """How a clip is made worse.

    Parameters
    ----------
    clip : str
        Its name.
    width : int
        Of the pictures, px.
    crf : float
        Quality of H.264 (libx264's "crf"): more is worse.
    every : int
        Of so many pictures one stays, and all that are labelled.
    jumps : bool
        Whether exposure and white balance change every so often.
    frames : int
        How often, in pictures.
    exposure : (float, float)
        Logarithm of the factor of the brightness then, drawn anew each time.
    tint : float
        Standard deviation of the logarithm of the gain of a channel.
    saturation : float
        What is left of the color, as a share.
    """

    clip: str
    width: int
    crf: float
    every: int = 1
    jumps: bool = False
    frames: int = 7
    exposure: tuple[float, float] = (-0.5, 0.4)
    tint: float = 0.1
    saturation: float = 1.0

    @property
    def name(self) -> str:
        """Name of the clip, width, quality, and what else was done."""
        every = f", 1 of {self.every}" if self.every > 1 else ""
        color = f", {100.0 * self.saturation:.0f} % of the color" if self.saturation < 1.0 else ""
        return f"{self.clip}, {self.width} px, crf {self.crf:g}{every}{', light jumps' if self.jumps else ''}{color}"


def write_copy(copy: Copy, clip: Clip, folder: Path, most: int | None = None) -> Clip:
    """Write a copy of a clip into a folder; its truth comes with what is returned.

    Parameters
    ----------
    copy : Copy
    clip : Clip
        The original.
    folder : Path
    most : int, optional
        How many pictures of the copy; without it all.

    Returns
    -------
    Clip
    """
    width, height = (EVEN * round(size * copy.width / clip.width / EVEN) for size in (clip.width, clip.height))
    rows, kept = {row.frame: row for row in clip.truths}, list[TruthRow]()
    video = folder / f"{copy.name}.mp4"
    with _Writer(video, (width, height), copy.crf) as writer:
        pictures = itertools.islice(_pictures(copy, clip, (width, height), set(rows)), most)
        for count, (frame, image) in enumerate(pictures):
            writer.add(image)
            if frame in rows:
                kept.append(_scaled(rows[frame], count, (width / clip.width, height / clip.height)))
    return Clip(copy.name, video, kept, width, height)


def _pictures(copy: Copy, clip: Clip, size: tuple[int, int], labelled: set[int]) -> Iterator[tuple[int, Image]]:
    """Pictures of a copy before they are coded, with their number in the original."""
    random, count, gains = np.random.default_rng(0), 0, np.ones(3)
    with ms.Video(clip.video) as video:
        for frame in video:
            if frame.index % copy.every and frame.index not in labelled:
                continue
            if copy.jumps and count % copy.frames == 0:
                gains = np.exp(random.uniform(*copy.exposure) + random.normal(0.0, copy.tint, 3))
            small = cv2.resize(frame.image, size, interpolation=cv2.INTER_AREA)
            count += 1
            relit = np.clip(small * gains, 0.0, 255.0).astype(np.uint8).astype(np.float32)
            yield frame.index, np.clip(np.rint(saturate(relit, copy.saturation)), 0.0, 255.0).astype(np.uint8)


class _Writer:
    """Writes pictures into a video of H.264."""

    def __init__(self, path: Path, size: tuple[int, int], crf: float) -> None:
        import av

        self._av: Any = av
        self._file: Any = av.open(str(path), "w")
        self._stream = self._file.add_stream("libx264", rate=Fraction(FRAMES_PER_SECOND))
        self._stream.width, self._stream.height = size
        self._stream.pix_fmt, self._stream.thread_count = "yuv420p", 1
        # By default x264 sums differently where its memory lies differently: the same pictures gave other bytes.
        self._stream.options = {"crf": f"{crf:g}", "preset": "veryfast", "x264-params": "threads=1:cpu-independent=1"}

    def __enter__(self) -> "_Writer":
        return self

    def add(self, image: Image) -> None:
        """Encode a picture, (h, w, 3), uint8, BGR."""
        frame = self._av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="bgr24")
        self._file.mux(self._stream.encode(frame))

    def __exit__(self, *_: object) -> None:
        self._file.mux(self._stream.encode(None))
        self._file.close()


def _scaled(row: TruthRow, frame: int, scale: tuple[float, float]) -> TruthRow:
    """Row of a smaller picture, where it is another frame."""
    if row.circle is None:
        return msgspec.structs.replace(row, frame=frame)
    x, y, radius = row.circle
    across, down = scale
    place = (x + 0.5) * across - 0.5, (y + 0.5) * down - 0.5
    return msgspec.structs.replace(row, frame=frame, circle=(*place, math.sqrt(across * down) * radius))
