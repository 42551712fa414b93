"""Through a video encoder and back: `Codec`, motion JPEG or H.264 at a bit rate."""

from collections.abc import Callable
from typing import Literal

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.sim.digital_camera.h264 import H264Coder

Image = npt.NDArray[np.uint8]
Coder = Callable[[Image], Image]
BEST, WORST = 100, 1  # format: JPEG's scale of quality


class Codec(msgspec.Struct, frozen=True, kw_only=True):
    """A video encoder at a given bit rate; its chroma has half the resolution of luma along x and y (4:2:0).

    Parameters
    ----------
    name : str
        "mjpeg": every frame a JPEG of its own. "h264": libx264 by PyAV (the extra `av`), P-frames between
        I-frames: what is not worth its bits is taken over from the frame before.
    kbps : float
        Bit rate, thousands of bits per second, 10 ... 1e6. Lower: blocks, smeared motion, color beyond the edges. For
        640 x 480 px at 30 frames per second H.264 shows little at 4000 and has 300 to 1000 in a call; motion JPEG has
        20 000 in a web camera, and at 3000 all frames are blocks.
    keyframes : int
        Frames from one I-frame to the next; H.264 only. Fewer: what smeared lasts shorter, but there are fewer bits
        for all else.
    """

    name: Literal["mjpeg", "h264"] = "mjpeg"
    kbps: float = 2000.0
    keyframes: int = 60

    def __post_init__(self) -> None:
        if self.name not in ("mjpeg", "h264"):
            raise ValueError(f"a codec is mjpeg or h264, got {self.name!r}")
        if not 10.0 <= self.kbps <= 1e6:
            raise ValueError(f"a bit rate lies in 10 ... 1e6 kbit/s, got {self.kbps}")
        if not 1 <= self.keyframes <= 100_000:
            raise ValueError(f"from one I-frame to the next there are 1 ... 100000 frames, got {self.keyframes}")

    def start(self, width: int, height: int, fps: float) -> Coder:
        """Start an encoder and its decoder.

        Parameters
        ----------
        width, height : int
            Size of the pictures, px; even for H.264.
        fps : float
            Frames per second.

        Returns
        -------
        callable
            From a picture, (h, w, 3), uint8, BGR, to what the decoder makes of it; to be called in the order of time.

        Raises
        ------
        ValueError
            If the size is odd or PyAV is missing, for H.264.
        """
        if self.name == "h264":
            return H264Coder(width, height, fps, self.kbps, self.keyframes)
        return MotionJpegCoder(self.kbps * 1000.0 / 8.0 / fps)


class MotionJpegCoder:
    """JPEG with 4:2:0 chroma, at the best quality that fits a number of bytes.

    Parameters
    ----------
    most : float
        Bytes of a frame. One that does not fit even at quality 1 is larger.
    """

    def __init__(self, most: float) -> None:
        self._most = most

    def __call__(self, image: Image) -> Image:
        """Encode and decode one picture, (h, w, 3), uint8, BGR."""
        low, high = WORST, BEST
        best = _jpeg(image, low)
        while low < high:
            middle = (low + high + 1) // 2
            packed = _jpeg(image, middle)
            if len(packed) <= self._most:
                low, best = middle, packed
            else:
                high = middle - 1
        return np.asarray(cv2.imdecode(best, cv2.IMREAD_COLOR), dtype=np.uint8)


def _jpeg(image: Image, quality: int) -> Image:
    """Bytes of a JPEG of this quality, 4:2:0."""
    sampling = [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420]
    _, packed = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality, *sampling])
    return np.asarray(packed, dtype=np.uint8)
