"""H.264 in memory: `H264Coder`; H.264 by PyAV."""

from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.numeric.imports import advice

Image = npt.NDArray[np.uint8]


class H264Coder:
    """Encode pictures by libx264 and decode them again, one by one: P-frames, no frame delayed, 4:2:0.

    Parameters
    ----------
    width, height : int
        Even, px.
    fps : float
        Frames per second.
    kbps : float
        Bit rate, thousands of bits per second, kept within about half a second.
    keyframes : int
        Frames from one I-frame to the next.

    Raises
    ------
    ValueError
        If PyAV is missing or the size is odd.
    """

    def __init__(self, width: int, height: int, fps: float, kbps: float, keyframes: int) -> None:
        if width % 2 or height % 2:
            raise ValueError(f"H.264 with 4:2:0 chroma needs an even width and height, got {width} x {height} px")
        try:
            import av
        except ImportError:
            raise ValueError(f"H.264 needs the package av: {advice('av')}") from None
        self._av: Any = av
        self._count = 0
        encoder: Any = av.CodecContext.create("libx264", "w")
        encoder.width, encoder.height, encoder.pix_fmt = width, height, "yuv420p"
        encoder.time_base = 1 / Fraction(fps).limit_denominator(1_000_000)
        encoder.framerate = 1 / encoder.time_base
        encoder.bit_rate, encoder.gop_size = int(kbps * 1000.0), keyframes
        # One thread: the same bytes everywhere. The buffer of half a second is what streams use.
        rate = f"vbv-maxrate={kbps:.0f}:vbv-bufsize={0.5 * kbps:.0f}:scenecut=0:threads=1:sliced-threads=0"
        encoder.options = {"preset": "veryfast", "tune": "zerolatency", "x264-params": rate}
        encoder.thread_count = 1
        self._encoder = encoder
        self._decoder: Any = av.CodecContext.create("h264", "r")
        self._decoder.thread_count = 1

    def __call__(self, image: Image) -> Image:
        """Encode and decode one picture, (h, w, 3), uint8, BGR."""
        frame = self._av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="bgr24")
        frame = frame.reformat(format="yuv420p")
        frame.pts, frame.time_base = self._count, self._encoder.time_base
        self._count += 1
        decoded = [out for packet in self._encoder.encode(frame) for out in self._decoder.decode(packet)]
        if len(decoded) != 1:
            raise ValueError(f"the H.264 coder returned {len(decoded)} frames for frame {self._count - 1}, not one")
        return np.asarray(decoded[0].to_ndarray(format="bgr24"), dtype=np.uint8)
