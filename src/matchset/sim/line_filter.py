"""The kernels of the analog link: noise, line jitter, and low-pass filters along the lines.

Every random number is a hash of a counter and of the pixel's place: lines can be worked on in any order.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Array = npt.NDArray[np.float64]
Picture = npt.NDArray[np.float32]
AnyPicture = Picture | npt.NDArray[np.uint8]

_BLOCK = 8  # geometry: lines that are filtered at once
# theorem: 1 / the standard deviation of the sum of four independent uniform bytes, each of variance (256^2 - 1) / 12
_DEVIATION = 1.0 / math.sqrt(4.0 * (256.0**2 - 1.0) / 12.0)


class Noise(NamedTuple):
    """White noise that is added before the filters.

    Parameters
    ----------
    luma, chroma : float
        Standard deviation in Y, and in Cb and Cr, display units (0 ... 255).
    counter : numpy.uint32
        Where the random numbers begin.
    """

    luma: float
    chroma: float
    counter: np.uint32


@kernel
def _hash(counter: np.uint32) -> np.uint32:
    """Return 32 random bits for a counter (Chris Wellons's `lowbias32`)."""
    z = np.uint32(counter ^ (counter >> np.uint32(16)))
    z = np.uint32(z * np.uint32(0x7FEB352D))
    z = np.uint32(z ^ (z >> np.uint32(15)))
    z = np.uint32(z * np.uint32(0x846CA68B))
    return np.uint32(z ^ (z >> np.uint32(16)))


@kernel
def _normal(bits: np.uint32) -> np.float32:
    """Nearly normal deviate of variance 1, |z| < 3.5: the sum of four bytes."""
    z = np.int32(bits & np.uint32(255)) + np.int32((bits >> np.uint32(8)) & np.uint32(255))
    z += np.int32((bits >> np.uint32(16)) & np.uint32(255)) + np.int32(bits >> np.uint32(24))
    return np.float32(np.int32(z - 510)) * np.float32(_DEVIATION)


@kernel
def _to_byte(value: np.float32) -> np.uint8:
    """Round to 0 ... 255."""
    return np.uint8(np.int32(min(max(value + np.float32(0.5), np.float32(0.0)), np.float32(255.0))))


@kernel
def expose(picture: AnyPicture, gain: Array, sigma: float, counter: np.uint32, out: npt.NDArray[np.uint8]) -> None:
    """Write gain * picture, cut off at 255, + white noise of deviation sigma in each channel, as bytes."""
    height, width = picture.shape[0], picture.shape[1]
    scale, top = np.float32(sigma), np.float32(255.0)
    factor = np.empty(3 * width, np.float32)
    for k in range(3):
        factor[k::3] = gain[k]
    for y in range(height):
        line, bytes_ = picture[y].reshape(3 * width), out[y].reshape(3 * width)
        start = np.uint32(counter + np.uint32(y * 3 * width))
        for i in range(3 * width):
            noise = scale * _normal(_hash(np.uint32(start + np.uint32(i))))
            bytes_[i] = _to_byte(min(line[i] * factor[i], top) + noise)


@kernel
def transmit(picture: AnyPicture, gain: Array, shift: Array, noise: Noise, planes: Picture) -> None:
    """Write Y, Cb, Cr (without offset) of gain * picture, each line shifted by `shift` px, plus white noise.

    A line that is shifted to the right shows at x what was at x - shift, linear between pixels.
    """
    height, width = picture.shape[0], picture.shape[1]
    luma_sigma, chroma_sigma, top = np.float32(noise.luma), np.float32(noise.chroma), np.float32(255.0)
    line = np.empty((3, width + 1), np.float32)
    for y in range(height):
        whole = math.floor(-shift[y])
        part = np.float32(-shift[y] - whole)
        _move(picture[y], int(min(max(whole, -width), width)), line)
        for k in range(3):
            level, channel = np.float32(gain[k]), line[k]
            for x in range(width):
                channel[x] = min(level * (channel[x] + part * (channel[x + 1] - channel[x])), top)
        luma, blue, red = planes[y, 0], planes[y, 1], planes[y, 2]
        _to_ycc(line, luma, blue, red)
        start = np.uint32(noise.counter + np.uint32(3 * y * width))
        _add_noise(luma, luma_sigma, start)
        _add_noise(blue, chroma_sigma, np.uint32(start + np.uint32(width)))
        _add_noise(red, chroma_sigma, np.uint32(start + np.uint32(2 * width)))


@kernel
def _to_ycc(line: Picture, luma: Picture, blue: Picture, red: Picture) -> None:
    """Write Y, Cb and Cr, without offset, of one line of B, G and R (ITU-R BT.601)."""
    for x in range(luma.shape[0]):
        gray = np.float32(0.114) * line[0, x] + np.float32(0.587) * line[1, x] + np.float32(0.299) * line[2, x]
        luma[x] = gray
        blue[x] = np.float32(0.564) * (line[0, x] - gray)
        red[x] = np.float32(0.713) * (line[2, x] - gray)


@kernel
def _move(row: AnyPicture, whole: int, line: Picture) -> None:
    """Write B, G and R of a row of pixels, from its pixel `whole` on; beyond its ends it stays as it ends."""
    width, count = row.shape[0], line.shape[1]
    first, last = max(-whole, 0), min(width - whole, count)
    for k in range(3):
        channel = line[k]
        channel[:first] = row[0, k]
        channel[last:] = row[width - 1, k]
    source, within = row[first + whole : last + whole], line[:, first:last]
    for x in range(last - first):
        within[0, x], within[1, x], within[2, x] = source[x, 0], source[x, 1], source[x, 2]


@kernel
def _add_noise(line: Picture, sigma: np.float32, start: np.uint32) -> None:
    """Add white noise to a line."""
    for x in range(line.shape[0]):
        line[x] += sigma * _normal(_hash(np.uint32(start + np.uint32(x))))


@kernel
def _smooth(lines: Picture, poles: Picture) -> None:
    """Filter lines forward and back, in place, which shifts no phase; many at once, which is faster."""
    count, width = lines.shape
    for x in range(1, width):
        for k in range(count):
            lines[k, x] += poles[k] * (lines[k, x - 1] - lines[k, x])
    for x in range(width - 2, -1, -1):
        for k in range(count):
            lines[k, x] += poles[k] * (lines[k, x + 1] - lines[k, x])


@kernel
def receive(
    planes: Picture,
    filters: tuple[float, float],
    neighbor: int,
    lost: npt.NDArray[np.bool_],
    counter: np.uint32,
    out: npt.NDArray[np.uint8],
) -> None:
    """Average chroma over lines y - neighbor, y, y + neighbor (1/4, 1/2, 1/4), filter, write BGR.

    `filters` are the poles of the low-pass filters of luma and of chroma.
    """
    luma_pole, chroma_pole = filters
    height, width = planes.shape[0], planes.shape[2]
    lines = np.empty((3 * _BLOCK, width), np.float32)
    poles = np.empty(3 * _BLOCK, np.float32)
    poles[0::3] = luma_pole
    poles[1::3] = chroma_pole
    poles[2::3] = chroma_pole
    half, quarter = np.float32(0.5), np.float32(0.25)
    for first in range(0, height, _BLOCK):
        for j in range(_BLOCK):
            y = min(first + j, height - 1)
            above = y - neighbor if y >= neighbor else y
            below = y + neighbor if y + neighbor < height else y
            lines[3 * j] = planes[y, 0]
            for k in range(1, 3):
                mean, up, here, down = lines[3 * j + k], planes[above, k], planes[y, k], planes[below, k]
                for x in range(width):
                    mean[x] = half * here[x] + quarter * (up[x] + down[x])
        _smooth(lines, poles)
        for j in range(min(_BLOCK, height - first)):
            if lost[first + j]:
                _streak(out[first + j], np.uint32(counter + np.uint32((first + j) * width)))
                continue
            _to_bgr(lines[3 * j], lines[3 * j + 1], lines[3 * j + 2], out[first + j])


@kernel
def _to_bgr(luma: Picture, blue: Picture, red: Picture, out: npt.NDArray[np.uint8]) -> None:
    """Write one line; `blue` and `red` are its Cb and Cr, which are overwritten."""
    for x in range(luma.shape[0]):
        cb, cr = blue[x], red[x]
        blue[x] = luma[x] + np.float32(1.773) * cb
        red[x] = luma[x] + np.float32(1.4025) * cr
        luma[x] = luma[x] - np.float32(0.3444) * cb - np.float32(0.7144) * cr
    for x in range(luma.shape[0]):
        out[x, 0], out[x, 1], out[x, 2] = _to_byte(blue[x]), _to_byte(luma[x]), _to_byte(red[x])


@kernel
def _streak(line: npt.NDArray[np.uint8], counter: np.uint32) -> None:
    """Fill a lost line with coarse black-and-white noise."""
    for x in range(line.shape[0]):
        line[x, :] = _to_byte(
            np.float32(128.0) + np.float32(75.0) * _normal(_hash(~np.uint32(counter + np.uint32(x // 3))))
        )
