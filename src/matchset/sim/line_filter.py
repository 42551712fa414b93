"""The kernels of the analog link: noise, line jitter, and low-pass filters along the lines.

Every random number is a hash of a counter and of the pixel's place: lines can be worked on in any order. They are sent
and received in blocks that stay in the processor's cache, and filtered side by side, a column of the block after the
other, since each value along a line needs the one before it.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Array = npt.NDArray[np.float64]
Picture = npt.NDArray[np.float32]
AnyPicture = Picture | npt.NDArray[np.uint8]
Words = npt.NDArray[np.uint32]

BLOCK = 32  # geometry: lines that are received at once
REACH = 2  # geometry: lines above and below a block whose chroma is averaged with its own
_PAIR = np.uint32(0x00FF00FF)  # format: two of four bytes
# theorem: 1 / the standard deviation of the sum of four independent uniform bytes, each of variance (256^2 - 1) / 12
_DEVIATION = 1.0 / math.sqrt(4.0 * (256.0**2 - 1.0) / 12.0)


class LineNoise(NamedTuple):
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
    pairs = np.uint32((bits & _PAIR) + ((bits >> np.uint32(8)) & _PAIR))
    z = np.int32((pairs & np.uint32(0xFFFF)) + (pairs >> np.uint32(16)))
    return np.float32(np.int32(z - 510)) * np.float32(_DEVIATION)


@kernel
def _to_byte(value: np.float32) -> np.uint32:
    """Round to 0 ... 255."""
    return np.uint32(np.int32(min(max(value + np.float32(0.5), np.float32(0.0)), np.float32(255.0))))


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


class LineReceiver(NamedTuple):
    """What a receiver does to the lines.

    Parameters
    ----------
    luma_pole, chroma_pole : float
        Of its low-pass filters.
    neighbor : int
        Chroma is averaged over lines y - neighbor, y, y + neighbor (1/4, 1/2, 1/4); 0 ... 2.
    lost : (h,)
        Which lines are noise.
    """

    luma_pole: float
    chroma_pole: float
    neighbor: int
    lost: npt.NDArray[np.bool_]


@kernel
def send(
    picture: AnyPicture | Words,
    gain: Array,
    shift: Array,
    noise: LineNoise,
    receiver: LineReceiver,
    out: npt.NDArray[np.uint8],
) -> None:
    """Transmit a picture and write what is received, BGR.

    Parameters
    ----------
    picture : (h, w, 3) or (h, w)
        BGR, or packed pixels.
    gain : (3,)
        Of B, G, R.
    shift : (h,)
        How far each line is shifted to the right, px.
    noise : LineNoise
    receiver : LineReceiver
    out : (h, w, 3), written
    """
    height, width = picture.shape[0], picture.shape[1]
    sent = np.empty((BLOCK + 2 * REACH, 3, width), np.float32)  # line y is at y modulo their number
    line, rows = np.empty((3, width + 1), np.float32), np.empty((BLOCK, width), np.float32)
    columns, words = np.empty((3, width, BLOCK), np.float32), np.empty((width, BLOCK), np.uint32)
    done = 0
    for first in range(0, height, BLOCK):
        coming = min(first + BLOCK + REACH, height)
        for y in range(done, coming):
            whole = math.floor(-shift[y])
            begin = int(min(max(whole, -width), width))
            if picture.ndim == 2:
                _move_packed(picture[y], begin, line)
            else:
                _move(picture[y], begin, line)
            _transmit(line, gain, np.float32(-shift[y] - whole), noise, y, sent[y % sent.shape[0]])
        done = coming
        for plane in range(3):
            _gather(sent, first, height, plane, receiver.neighbor, rows)
            _turn(rows, columns[plane])
            _smooth(columns[plane], np.float32(receiver.chroma_pole if plane else receiver.luma_pole))
        _to_words(columns[0], columns[1], columns[2], words)
        _write(words, first, out)
        for y in range(first, min(first + BLOCK, height)):
            if receiver.lost[y]:
                _streak(out[y], np.uint32(noise.counter + np.uint32(y * width)))


@kernel
def _transmit(line: Picture, gain: Array, part: np.float32, noise: LineNoise, y: int, sent: Picture) -> None:
    """Write Y, Cb, Cr (without offset) of gain * line, moved by a part of a pixel, plus white noise."""
    luma, blue, red = sent[0], sent[1], sent[2]
    _to_ycc(line, gain, part, luma, blue, red)
    width, chroma = sent.shape[1], np.float32(noise.chroma)
    start = np.uint32(noise.counter + np.uint32(3 * y * width))
    _add_noise(luma, np.float32(noise.luma), start)
    _add_noise(blue, chroma, np.uint32(start + np.uint32(width)))
    _add_noise(red, chroma, np.uint32(start + np.uint32(2 * width)))


@kernel
def _move_packed(row: Words, whole: int, line: Picture) -> None:
    """Do what `_move` does, with a row of packed pixels."""
    width, count, byte = row.shape[0], line.shape[1], np.uint32(255)
    first, last = max(-whole, 0), min(width - whole, count)
    source = row[first + whole : last + whole]
    blue, green, red = line[0, first:last], line[1, first:last], line[2, first:last]
    for x in range(last - first):
        word = source[x]
        blue[x] = np.float32(np.int32(word & byte))
        green[x] = np.float32(np.int32((word >> np.uint32(8)) & byte))
        red[x] = np.float32(np.int32((word >> np.uint32(16)) & byte))
    for k in range(3):
        shift = np.uint32(8 * k)
        line[k, :first] = np.float32((row[0] >> shift) & byte)
        line[k, last:] = np.float32((row[width - 1] >> shift) & byte)


@kernel
def _to_ycc(line: Picture, gain: Array, part: np.float32, luma: Picture, blue: Picture, red: Picture) -> None:
    """Write Y, Cb and Cr, without offset, of gain * B, G and R, a part of a pixel on (ITU-R BT.601)."""
    top, one, two, three = np.float32(255.0), np.float32(gain[0]), np.float32(gain[1]), np.float32(gain[2])
    first, second, third = line[0], line[1], line[2]
    for x in range(luma.shape[0]):
        b = min(one * (first[x] + part * (first[x + 1] - first[x])), top)
        g = min(two * (second[x] + part * (second[x + 1] - second[x])), top)
        r = min(three * (third[x] + part * (third[x + 1] - third[x])), top)
        gray = np.float32(0.114) * b + np.float32(0.587) * g + np.float32(0.299) * r
        luma[x] = gray
        blue[x] = np.float32(0.564) * (b - gray)
        red[x] = np.float32(0.713) * (r - gray)


@kernel
def _move(row: AnyPicture, whole: int, line: Picture) -> None:
    """Write B, G and R of a row of pixels, from its pixel `whole` on; beyond its ends it stays as it ends."""
    width, count = row.shape[0], line.shape[1]
    first, last = max(-whole, 0), min(width - whole, count)
    for k in range(3):
        channel = line[k]
        channel[:first] = row[0, k]
        channel[last:] = row[width - 1, k]
    source = row[first + whole : last + whole]
    blue, green, red = line[0, first:last], line[1, first:last], line[2, first:last]
    for x in range(last - first):
        blue[x], green[x], red[x] = source[x, 0], source[x, 1], source[x, 2]


@kernel
def _add_noise(line: Picture, sigma: np.float32, start: np.uint32) -> None:
    """Add white noise to a line."""
    for x in range(line.shape[0]):
        line[x] += sigma * _normal(_hash(np.uint32(start + np.uint32(x))))


@kernel
def _gather(sent: Picture, first: int, height: int, plane: int, neighbor: int, rows: Picture) -> None:
    """Copy a block of one plane's lines, those of chroma averaged with their neighbors of the same field."""
    count, half, quarter = sent.shape[0], np.float32(0.5), np.float32(0.25)
    for k in range(rows.shape[0]):
        y = min(first + k, height - 1)
        above = y - neighbor if y >= neighbor else y
        below = y + neighbor if y + neighbor < height else y
        row, here = rows[k], sent[y % count, plane]
        if plane == 0:
            row[:] = here
            continue
        up, down = sent[above % count, plane], sent[below % count, plane]
        for x in range(row.shape[0]):
            row[x] = half * here[x] + quarter * (up[x] + down[x])


@kernel
def _turn(rows: Picture, columns: Picture) -> None:
    """Write the transpose."""
    for x in range(columns.shape[0]):
        for k in range(BLOCK):
            columns[x, k] = rows[k, x]


@kernel
def _smooth(columns: Picture, pole: np.float32) -> None:
    """Filter lines forward and back, in place, which shifts no phase; (w, n), many side by side."""
    for x in range(1, columns.shape[0]):
        for k in range(columns.shape[1]):
            columns[x, k] += pole * (columns[x - 1, k] - columns[x, k])
    for x in range(columns.shape[0] - 2, -1, -1):
        for k in range(columns.shape[1]):
            columns[x, k] += pole * (columns[x + 1, k] - columns[x, k])


@kernel
def _to_words(luma: Picture, blue: Picture, red: Picture, words: Words) -> None:
    """Write B, G and R, one word a pixel, of Y, Cb and Cr."""
    count = words.size
    y, cb, cr, out = luma.reshape(count), blue.reshape(count), red.reshape(count), words.reshape(count)
    for i in range(count):
        blue_byte = _to_byte(y[i] + np.float32(1.773) * cb[i])
        green_byte = _to_byte(y[i] - np.float32(0.3444) * cb[i] - np.float32(0.7144) * cr[i])
        red_byte = _to_byte(y[i] + np.float32(1.4025) * cr[i])
        out[i] = blue_byte | (green_byte << np.uint32(8)) | (red_byte << np.uint32(16))


@kernel
def _write(words: Words, first: int, out: npt.NDArray[np.uint8]) -> None:
    """Write a block of words as bytes of the lines from `first` on, four at a time: those beyond the last are it."""
    end = out.shape[0] - 1
    for k in range(0, BLOCK, 4):
        one, two = out[min(first + k, end)], out[min(first + k + 1, end)]
        three, four = out[min(first + k + 2, end)], out[min(first + k + 3, end)]
        for x in range(words.shape[0]):
            column = words[x, k : k + 4]
            _put(column[0], one, x)
            _put(column[1], two, x)
            _put(column[2], three, x)
            _put(column[3], four, x)


@kernel
def _put(word: np.uint32, line: npt.NDArray[np.uint8], x: int) -> None:
    """Write B, G and R of a pixel."""
    line[x, 0], line[x, 1], line[x, 2] = word, word >> np.uint32(8), word >> np.uint32(16)


@kernel
def _streak(line: npt.NDArray[np.uint8], counter: np.uint32) -> None:
    """Fill a lost line with coarse black-and-white noise."""
    for x in range(line.shape[0]):
        line[x, :] = _to_byte(
            np.float32(128.0) + np.float32(75.0) * _normal(_hash(~np.uint32(counter + np.uint32(x // 3))))
        )
