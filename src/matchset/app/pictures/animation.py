"""An animated picture of a run, GIF or WebP: `Animation`."""

import io
from pathlib import Path

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
from PIL import Image

from matchset.app.films.codecs import check_animation
from matchset.image.files.whole_file import write_whole

Picture = npt.NDArray[np.uint8]


class AnimationParameters(msgspec.Struct, frozen=True):
    """Size and length of an animated picture; larger ones are slow to load. Chosen by hand.

    Parameters
    ----------
    width : int
        Largest width, px.
    rate : float
        Largest number of pictures a second.
    pictures : int
        Most pictures: of a longer run every second is left out, as often as needed.
    quality : int
        Of WebP, 0 ... 100.
    """

    width: int = 480
    rate: float = 12.0
    pictures: int = 150
    quality: int = 70


PARAMETERS = AnimationParameters()


class Animation:
    """Collects pictures, reduced, and writes them at the end.

    Parameters
    ----------
    path : Path
        Ends in .gif or .webp.
    fps : float
        Pictures per second that are offered; it is shown at this speed.
    """

    def __init__(self, path: Path, fps: float) -> None:
        check_animation(path)
        self.path, self._fps = path, fps
        self._step = max(1, round(fps / PARAMETERS.rate))
        self._offered = 0
        self._kept: list[Picture] = []

    def append(self, picture: Picture) -> None:
        """Offer the next BGR picture."""
        if self._offered % self._step == 0:
            if len(self._kept) == PARAMETERS.pictures:
                del self._kept[1::2]
                self._step *= 2
            if self._offered % self._step == 0:
                scale = min(1.0, PARAMETERS.width / picture.shape[1])
                small = cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
                self._kept.append(np.ascontiguousarray(small[..., ::-1], np.uint8))
        self._offered += 1

    def close(self) -> None:
        """Write the file, whole or not at all; nothing without pictures."""
        if not self._kept:
            return
        pictures = [Image.fromarray(each) for each in self._kept]
        self._kept = []
        packed, steps = io.BytesIO(), np.arange(len(pictures) + 1)
        shown_ms = 10 * np.diff(np.round(np.maximum(100.0 * self._step / self._fps, 2.0) * steps)).astype(int)
        if self.path.suffix.lower() == ".gif":
            colors = pictures[len(pictures) // 2].quantize(256)
            pictures = [each.quantize(256, palette=colors, dither=Image.Dither.NONE) for each in pictures]
        pictures[0].save(
            packed,
            "GIF" if self.path.suffix.lower() == ".gif" else "WEBP",
            save_all=True,
            append_images=pictures[1:],
            duration=shown_ms.tolist(),  # GIF counts hundredths of a second
            loop=0,
            quality=PARAMETERS.quality,
        )
        write_whole(self.path, packed.getvalue())
