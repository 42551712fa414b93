"""The match-set: edge points on short lines across the predicted outline (Epstein & Feldman, Eq. 1-4).

As in the paper every line runs along a row or a column: along the row where the outline is steep, along the column
where it is flat. On each line Eq. 1 is asked at every pixel p, with graded whiteness from the color table,

    difference(p) = (sum of scores of the `margin` pixels inside p) - (the same outside p) > threshold.

Color says that there is an edge, contrast says where: the edge points are the peaks of the squared contrast

    contrast(p) = |sum of the `margin` pixel values inside p - the same outside p|^2

at which Eq. 1 holds, to a fraction of a pixel. The strongest few of a line are kept: which of them belong to the shape
is the fit's question. The lines are read first and judged then, because memory is slower than arithmetic here.
"""

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int64]
Index = np.uintp | int

CANDIDATES = 3  # edge points kept per line, strongest first
LONGEST = 160  # pixels a line can have; few, so that the working arrays stay in the cache
WEAK = np.float32(0.4)  # strength that an edge point without a step in color has, of one with a full step
FIRM = np.float32(0.35)  # share of a full step in color from which the contrast need not stand out of the noise
SHIFT = 1 << 24  # makes places positive, so that cutting off the fraction is rounding down
ROUND = SHIFT + 0.5
ONE, TWO = np.uintp(1), np.uintp(2)
B3, B5, B10 = np.uint32(3), np.uint32(5), np.uint32(10)


class Lines:
    """Working arrays of a match-set of n lines, made once per tracker.

    Parameters
    ----------
    n : int
        Number of lines.
    states : int
        How many numbers the state of the shape has.

    Attributes
    ----------
    outline : ndarray of shape (n, 4 + s + 2), float64
        Where each line crosses the outline: x, y, px, the outward unit normal, and by how much the outline moves along
        it per unit of each number of the state, and of the distance between the fields.
    edges : ndarray of shape (n, 3, 3), float64
        Edge points of each line, strongest first: offset along the outward normal, px; strength, 0 where there is
        none; step in color, as a share of a full one.
    runs : ndarray of shape (n, 5), int64
        Where each line runs: 1 along a row or 0 along a column, which one, first pixel, step, number of pixels; the
        last is 0 where the picture does not reach `margin` pixels beyond the outline on both sides.
    """

    def __init__(self, n: int, states: int) -> None:
        self.outline, self.edges = np.zeros((n, 4 + states + 2)), np.zeros((n, CANDIDATES, 3))
        self.runs, self.starts = np.zeros((n, 5), np.int64), np.zeros((n, 2))
        self.pixels = np.zeros((n, LONGEST, 3), np.uint8)
        self.sums = np.zeros((6, LONGEST + 1), np.float32)


@kernel
def _place(
    outline: Floats,
    i: Index,
    reach: float,
    margin: int,
    height: int,
    width: int,
    runs: Ints,
    starts: Floats,
) -> None:
    """Where line i runs, the offset of its first pixel and its offset per pixel."""
    x, y, nx, ny = outline[i, 0], outline[i, 1], outline[i, 2], outline[i, 3]
    runs[i, 4] = 0
    if not (-1e6 < x < 1e6 and -1e6 < y < 1e6):
        return
    across = abs(nx) >= abs(ny)
    if not across:
        x, y, nx, ny = y, x, ny, nx
    size, other = (width, height) if across else (height, width)
    fixed = int(y + ROUND) - SHIFT
    start, slant = x - (fixed - y) * ny / nx, abs(nx)
    nearest = int(start + ROUND) - SHIFT
    span = min(int(reach / slant) + 1 + margin, LONGEST // 2 - 2)
    if nx > 0:
        step, low, high = 1, max(-span, -nearest), min(span, size - 1 - nearest)
    else:
        step, low, high = -1, max(-span, nearest - size + 1), min(span, nearest)
    if fixed < 0 or fixed >= other or -low < margin or high < margin:
        return
    first = nearest + step * low
    runs[i, 0], runs[i, 1], runs[i, 2], runs[i, 3], runs[i, 4] = across, fixed, first, step, high - low + 1
    starts[i, 0], starts[i, 1] = step * (first - start) * slant, slant


@kernel
def _read(flat: Bytes, width: int, channels: int, runs: Ints, i: Index, pixels: Bytes) -> None:
    """Copy the pixels of line i, inside first."""
    across, fixed, position, step = runs[i, 0], runs[i, 1], runs[i, 2], runs[i, 3]
    start = (fixed * width + position if across else position * width + fixed) * channels
    stride = (step if across else step * width) * channels
    if channels == 3:
        for place in range(runs[i, 4]):
            k, at = np.uintp(place), np.uintp(start + place * stride)
            pixels[i, k, 0] = flat[at]
            pixels[i, k, 1] = flat[at + ONE]
            pixels[i, k, 2] = flat[at + TWO]
    else:
        for place in range(runs[i, 4]):
            pixels[i, np.uintp(place), 0] = flat[np.uintp(start + place * stride)]


@kernel
def _sum(
    pixels: Bytes,
    i: Index,
    length: int,
    table: npt.NDArray[np.int8],
    s0: Singles,
    s1: Singles,
    s2: Singles,
    s3: Singles,
) -> None:
    """Take running sums of scores and values along line i: s[k] covers the pixels before k."""
    ts = t0 = t1 = t2 = np.int32(0)
    if table.size > 256:
        for place in range(length):
            k, after = np.uintp(place), np.uintp(place + 1)
            b, g, r = np.uint32(pixels[i, k, 0]), np.uint32(pixels[i, k, 1]), np.uint32(pixels[i, k, 2])
            ts += table[np.uintp((b >> B3) << B10 | (g >> B3) << B5 | r >> B3)]
            t0 += b
            t1 += g
            t2 += r
            s0[after], s1[after], s2[after], s3[after] = ts, t0, t1, t2
    else:
        for place in range(length):
            k, after = np.uintp(place), np.uintp(place + 1)
            ts += table[np.uintp(pixels[i, k, 0])]
            t0 += pixels[i, k, 0]
            s0[after], s1[after], s2[after], s3[after] = ts, t0, t1, t2


@kernel
def _judge(
    s0: Singles,
    s1: Singles,
    s2: Singles,
    s3: Singles,
    length: int,
    margin: int,
    threshold: float,
    enough: float,
    plain: float,
    contrast: Singles,
    white: Singles,
) -> None:
    """At every pixel the squared contrast, and the whiteness of Eq. 1: 0 where there is no edge point."""
    for end in range(min(margin, length)):
        contrast[end] = contrast[length - 1 - end] = np.float32(0.0)
    m, w, one = np.uintp(margin), np.uintp(2 * margin + 1), np.uintp(1)
    firm, weak, full, least = (
        np.float32(FIRM * enough),
        np.float32(WEAK * enough),
        np.float32(enough),
        np.float32(plain),
    )
    for index in range(length - 2 * margin):
        a = np.uintp(index)
        k, b, d = a + m, a + m + one, a + w
        difference = s0[k] - s0[a] - s0[d] + s0[b]
        d0, d1, d2 = (
            s1[k] - s1[a] - s1[d] + s1[b],
            s2[k] - s2[a] - s2[d] + s2[b],
            s3[k] - s3[a] - s3[d] + s3[b],
        )
        c = d0 * d0 + d1 * d1 + d2 * d2
        contrast[k] = c
        is_edge = difference > firm or c > least
        white[k] = min(max(difference, weak), full) if is_edge and difference > threshold else np.float32(0.0)


@kernel
def _keep_best(
    contrast: Singles,
    white: Singles,
    length: int,
    margin: int,
    i: Index,
    starts: Floats,
    enough: float,
    edges: npt.NDArray[np.float64],
) -> None:
    """Keep the strongest peaks of the contrast at edge points of line i, to a fraction of a pixel."""
    for j in range(CANDIDATES):
        edges[i, j, 1] = 0.0
    for place in range(margin, length - margin):
        k = np.uintp(place)
        if white[k] == 0.0:
            continue
        before, c, after = contrast[np.uintp(place - 1)], contrast[k], contrast[np.uintp(place + 1)]
        if c > 0.0 and c >= before and c > after:
            q = float(c) * white[k]
            if q <= edges[i, CANDIDATES - 1, 1]:
                continue
            peak = float(place)
            if before > 0.0 and after > 0.0:
                peak += 0.5 * (after - before) / (2.0 * c - before - after)
            j = CANDIDATES - 1
            while j > 0 and q > edges[i, j - 1, 1]:
                for m in range(3):
                    edges[i, j, m] = edges[i, j - 1, m]
                j -= 1
            edges[i, j, 0], edges[i, j, 1] = starts[i, 0] + peak * starts[i, 1], q
            edges[i, j, 2] = white[k] / enough


@kernel
def match_lines(
    image: Bytes,
    table: npt.NDArray[np.int8],
    outline: Floats,
    reach: float,
    margin: int,
    threshold: float,
    enough: float,
    plain: float,
    edges: npt.NDArray[np.float64],
    runs: Ints,
    starts: Floats,
    pixels: Bytes,
    sums: Singles,
) -> float:
    """Find the edge points on the lines across an outline.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    table : (32768,) or (256,) int8
        Score of each BGR cell or gray value, see `ColorModel`.
    outline : (n, 4 + s + 2), the last two columns written
        See `Lines`. What is written: by how much an edge moves along its normal if the even rows of an interlaced
        picture lie (dx, dy) / 2 ahead of the mean and its odd rows behind.
    reach : float
        How far the edge may be from there along the normal, px.
    margin : int
        Pixels that Eq. 1 counts on each side.
    threshold : float
        By how much their scores must differ (the paper's nabla), table units.
    enough : float
        Difference beyond which more whiteness is no better and contrast alone decides, table units.
    plain : float
        Squared contrast that noise alone can have: an edge point without a firm step in color must stand out of it.
    edges, runs, starts, pixels, sums
        Working arrays of `Lines`.

    Returns
    -------
    float
        Standard deviation of the noise of the pixels inside the shape, gray levels.
    """
    s0, s1, s2, s3, contrast, white = sums
    height, width, channels = image.shape
    flat, fields = image.reshape(-1), outline.shape[1] - 2
    for index in range(outline.shape[0]):
        i = np.uintp(index)  # unsigned indices spare Numba's check for negative ones
        _place(outline, i, reach, margin, height, width, runs, starts)
        _read(flat, width, channels, runs, i, pixels)
    rough, count, c = 0.0, 0, min(1, channels - 1)
    for index in range(outline.shape[0]):
        i = np.uintp(index)
        length = runs[i, 4]
        if length > 2:
            rough += abs(float(pixels[i, 0, c]) - 2.0 * float(pixels[i, 1, c]) + float(pixels[i, 2, c]))
            count += 1
        half = 0.5 - (runs[i, 1] & 1) if runs[i, 0] else 0.0
        outline[i, fields], outline[i, fields + 1] = half * outline[i, 2], half * outline[i, 3]
        _sum(pixels, i, length, table, s0, s1, s2, s3)
        _judge(s0, s1, s2, s3, length, margin, threshold, enough, plain, contrast, white)
        _keep_best(contrast, white, length, margin, i, starts, enough, edges)
    return rough / (1.95 * max(count, 1))  # E|a - 2b + c| of unit noise
