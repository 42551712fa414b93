"""The analog link: `degrade` makes of a picture what a camera, a transmitter and a PAL receiver make of it."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.sim.line_filter import AnyPicture, LineNoise, LineReceiver, Words, expose, send
from matchset.sim.rendering.renderer import Picture

PIXEL_TIME = 81e-9  # format: s, of the 640 px that span the 52 us of an active PAL line (ITU-R BT.470)


class AnalogLink(msgspec.Struct, frozen=True, kw_only=True):
    """What lens, sensor, transmitter and receiver do to a frame.

    All filters have zero phase: a receiver's group delay is the same for every line and is calibrated out.

    Parameters
    ----------
    interlaced : bool
        Two fields, 1/(2 fps) s apart: even rows first, then odd rows. More of it: combing on whatever moves.
    blur : float
        Standard deviation of the lens's and sensor's Gaussian blur, px. 0: none.
    sensor_noise : float
        Standard deviation of white noise in each of B, G, R, display units (0 ... 255).
    luma_bandwidth, chroma_bandwidth : float
        Frequency where the filter of Y (of Cb and Cr) is 3 dB down, Hz; 0: no filter. Lower: softer edges
        (color bleeds). 1 px lasts 81 ns at a width of 640 px, less in wider pictures.
    luma_noise, chroma_noise : float
        Standard deviation of the noise in Y (in Cb and in Cr) as measured in the picture, display units. It
        is white noise sent through the same filter, so its grain is as coarse as the filter makes it.
    chroma_lines : bool
        Average chroma over neighboring lines of the same field as a delay-line receiver does. The mean of
        lines y - 2 and y lies half way between them; so does that of y and y + 2: their mean, weights 1/4,
        1/2, 1/4, moves nothing.
    line_jitter : float
        Standard deviation of the horizontal shift of each line, px.
    lost_lines : float
        Share of the lines that are lost, 0 ... 1: they show black-and-white noise without color.
    """

    interlaced: bool = False
    blur: float = 0.0
    sensor_noise: float = 0.0
    luma_bandwidth: float = 0.0
    chroma_bandwidth: float = 0.0
    luma_noise: float = 0.0
    chroma_noise: float = 0.0
    chroma_lines: bool = False
    line_jitter: float = 0.0
    lost_lines: float = 0.0

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} of an analog link must not be negative, got {getattr(self, name)}")
        if self.lost_lines > 1.0:
            raise ValueError(f"lost_lines is a share, 0 ... 1, got {self.lost_lines}")


CLEAN = AnalogLink(blur=0.5, sensor_noise=2.0)
TYPICAL = AnalogLink(
    interlaced=True,
    luma_bandwidth=3e6,
    chroma_bandwidth=0.6e6,
    luma_noise=6.0,
    chroma_noise=8.0,
    chroma_lines=True,
    line_jitter=0.3,
)
BAD = AnalogLink(
    interlaced=True,
    luma_bandwidth=2e6,
    chroma_bandwidth=0.4e6,
    luma_noise=15.0,
    chroma_noise=20.0,
    chroma_lines=True,
    line_jitter=1.0,
    lost_lines=0.01,
)
PRESETS = {"clean": CLEAN, "typical": TYPICAL, "bad": BAD}


def degrade(
    picture: Picture | npt.NDArray[np.uint8],
    link: AnalogLink,
    seed: int,
    gain: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> npt.NDArray[np.uint8]:
    """Send a picture through an analog link.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32 or uint8, or (h, w, 4), uint8
        BGR, 0 ... 255, and in the last case a byte that is not looked at; unchanged.
    link : AnalogLink
    seed : int
        Decides the noise, the jitter and the lost lines; not negative. The same seed gives the same bytes.
    gain : tuple of 3 floats
        Factors of B, G and R: exposure and white balance of the camera. It saturates at 255.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR.
    """
    depths = {np.dtype(np.float32): (3,), np.dtype(np.uint8): (3, 4)}
    if picture.ndim != 3 or picture.shape[2] not in depths.get(picture.dtype, ()):
        kind = f"{picture.dtype}, {picture.shape}"
        raise ValueError(f"a picture must be float32 or uint8 of shape (h, w, 3), or uint8 of (h, w, 4), got {kind}")
    height, width = picture.shape[:2]
    rng = np.random.default_rng((seed, 0x9A1))
    shift = np.asarray(rng.standard_normal(height) * link.line_jitter)
    lost = np.asarray(rng.random(height) < link.lost_lines)
    counter = rng.integers(0, 2**32, dtype=np.uint32)
    out = np.empty((height, width, 3), np.uint8)
    if not _is_analog(link):
        expose(_through_lens(picture, link.blur), np.array(gain), link.sensor_noise, counter, out)
        return out
    if link.sensor_noise > 0.0:
        raise ValueError("sensor_noise of an analog link is a part of luma_noise and chroma_noise: leave it 0")
    luma, chroma = pole(link.luma_bandwidth, width), pole(link.chroma_bandwidth, width)
    lines = math.sqrt(0.375) if link.chroma_lines else 1.0
    noise = LineNoise(link.luma_noise / noise_gain(luma), link.chroma_noise / (noise_gain(chroma) * lines), counter)
    neighbor = 0 if not link.chroma_lines else 2 if link.interlaced else 1
    send(_sent(picture, link.blur), np.array(gain), shift, noise, LineReceiver(luma, chroma, neighbor, lost), out)
    return out


def pole(bandwidth: float, width: int) -> float:
    """Pole p of a low-pass y_n = p y_(n-1) + (1 - p) x_n that, forward and back, is 3 dB down there.

    Once: |H|^2 = (1 - p)^2 / (1 - 2 p cos w + p^2) = 1/sqrt(2).

    Parameters
    ----------
    bandwidth : float
        Hz; 0 or more than half the pixel rate: no filter.
    width : int
        Width of the picture, px; an active line lasts 640 * 81 ns whatever its width.

    Returns
    -------
    float
        p, 0 ... 1.
    """
    omega = 2.0 * math.pi * bandwidth * PIXEL_TIME * 640.0 / width
    if not 0.0 < omega < math.pi:
        return 0.0
    half = (math.sqrt(2.0) - math.cos(omega)) / (math.sqrt(2.0) - 1.0)
    return half - math.sqrt(half * half - 1.0)


def noise_gain(p: float) -> float:
    """Compute the standard deviation that the filter of `pole`, forward and back, leaves of white noise of deviation 1.

    The response is h_n = (1 - p)/(1 + p) p^|n|, so the gain is sqrt(sum h_n^2).

    Parameters
    ----------
    p : float
        The pole, 0 ... 1.

    Returns
    -------
    float
        0 ... 1.
    """
    return (1.0 - p) / (1.0 + p) * math.sqrt((1.0 + p * p) / (1.0 - p * p))


def _is_analog(link: AnalogLink) -> bool:
    """Whether anything but blur and the sensor's noise is to be done."""
    return (
        max(
            link.luma_bandwidth,
            link.chroma_bandwidth,
            link.luma_noise,
            link.chroma_noise,
            link.line_jitter,
            link.lost_lines,
        )
        > 0.0
        or link.chroma_lines
    )


def _through_lens(picture: AnyPicture, blur: float) -> AnyPicture:
    """Blur a picture as the lens does, and leave out a fourth byte."""
    colors: AnyPicture = picture
    if picture.shape[2] == 4:
        colors = cv2.cvtColor(picture, cv2.COLOR_BGRA2BGR).astype(np.uint8, copy=False)
    return _blurred(colors.astype(np.float32, copy=False), blur) if blur > 0.0 else colors


def _sent(picture: AnyPicture, blur: float) -> AnyPicture | Words:
    """Blur a picture as the lens does; what has four bytes a pixel and is not blurred is sent as packed pixels."""
    if picture.shape[2] == 4 and blur == 0.0:
        return np.ascontiguousarray(picture).view(np.uint32)[..., 0]
    return _through_lens(picture, blur)


def _blurred(picture: Picture, sigma: float) -> Picture:
    size = 2 * math.ceil(4.0 * sigma) + 1
    blurred = cv2.GaussianBlur(picture, (size, size), sigma, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(blurred, dtype=np.float32)
