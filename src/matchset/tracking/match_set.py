"""The match-set: edge points on short lines across the predicted outline (Epstein & Feldman, Eq. 1-4).

As in the paper every line runs along a row or a column: along the row where the outline is steep, along the column
where it is flat. On each line Eq. 1 is asked at every pixel p, with graded whiteness from the color table,

    difference(p) = (sum of scores of the `margin` pixels inside p) - (the same outside p) > threshold.

Color says that there is an edge, contrast says where: the edge points are the peaks of the squared contrast

    contrast(p) = |sum of the `margin` pixel values inside p - the same outside p|^2

at which Eq. 1 holds, to a fraction of a pixel. The strongest few of a line are kept: which of them belong to the shape
is the fit's question. The lines are read first and judged then, because memory is slower than arithmetic here.
"""

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import cut, helper, kernel

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int64]
Counts = npt.NDArray[np.int32]
Index = np.uintp | int

CANDIDATES = 3  # edge points kept per line, strongest first
LONGEST = 160  # pixels a line can have; few, so that the working arrays stay in the cache
WEAK = np.float32(0.4)  # strength that an edge point without a step in color has, of one with a full step
FIRM = np.float32(0.35)  # share of a full step in color from which the contrast need not stand out of the noise
SHIFT = 1 << 24  # makes places positive, so that cutting off the fraction is rounding down
ROUND = SHIFT + 0.5
ZERO, ONE, TWO, THREE = np.uintp(0), np.uintp(1), np.uintp(2), np.uintp(3)
WIDTH = LONGEST + 1  # numbers kept of each kind along a line
W1, W2, W3 = np.uintp(WIDTH), np.uintp(2 * WIDTH), np.uintp(3 * WIDTH)
SUMS = 6 * WIDTH
# A jump back is a large unsigned number and comes round; and what goes round is not read by vectors, which costs twice
# as much where a line has a dozen pixels.
ROUND_ABOUT = np.uintp((1 << 48) - 1)
B3, B5, B10 = np.uint32(3), np.uint32(5), np.uint32(10)


class MatchParameters(msgspec.Struct, frozen=True):
    """What makes an edge point and a fit; all else follows from the size of the shape and the noise of the picture.

    Parameters
    ----------
    margin : int
        Most pixels that Eq. 1 counts on each side of an edge. Noisy pictures use them all, sharp ones two, small shapes
        a quarter of their half-width: more is steadier in noise and blur, less is more exact and tells stripes apart.
    threshold : float
        The paper's nabla, as a share of a step from surely background to surely target: below it there is no edge.
        Slightly negative, since a pale stripe of the target may look more like background than what it lies before.
    enough : float
        Share beyond which a larger step is no better, and the contrast alone decides where the edge is.
    clear : float
        Contrast, in standard deviations of the noise, that an edge point without a step in color must have.
    floor : float
        Least noise of an edge point that is believed, px: smaller, and a chance agreement of few points wins.
    tolerance : float
        How near an edge point must be to the outline to confirm it, in half-widths, between 1.2 and 3 px.
    turns : int
        How often the outline is traced anew at most.
    start, side_start : float
        Noise with which a fit begins at least, px, for round shapes and for those with corners: one side that is off
        is not called back by the others, so it must be seen from farther.
    """

    margin: int = 4
    threshold: float = -0.05
    enough: float = 0.6
    clear: float = 5.0
    floor: float = 0.4
    tolerance: float = 0.06
    turns: int = 4
    start: float = 1.0
    side_start: float = 2.0


@helper
def _place(
    outline: Floats,
    i: Index,
    reach: float,
    margin: int,
    height: int,
    width: int,
    combed: bool,
    runs: Ints,
    starts: Floats,
) -> None:
    """Where line i runs, the offset of its first pixel and its offset per pixel.

    Where the fields of an interlaced picture lie apart, columns are combed: a line along one keeps to one field.
    """
    x, y, nx, ny = outline[i, 0], outline[i, 1], outline[i, 2], outline[i, 3]
    runs[i, 4] = 0
    if not (-1e6 < x < 1e6 and -1e6 < y < 1e6):
        return
    across = abs(nx) >= abs(ny)
    if not across:
        x, y, nx, ny = y, x, ny, nx
    size, other, rows, odd = (width, height, 1, 0) if across else (height, width, 1, 0)
    fixed = int(y + ROUND) - SHIFT
    start, slant = x - (fixed - y) * ny / nx, abs(nx)
    if combed and not across:
        rows, odd = 2, int(i) & 1
        start, slant, size = 0.5 * (start - odd), 2.0 * slant, (size + 1 - odd) >> 1
    nearest = int(start + ROUND) - SHIFT
    span = min(int(reach / slant) + 1 + margin, LONGEST // 2 - 2)
    if nx > 0:
        step, low, high = 1, max(-span, -nearest), min(span, size - 1 - nearest)
    else:
        step, low, high = -1, max(-span, nearest - size + 1), min(span, nearest)
    if fixed < 0 or fixed >= other or -low < margin or high < margin:
        return
    first = nearest + step * low
    runs[i, 0], runs[i, 1], runs[i, 4] = across, fixed, high - low + 1
    runs[i, 2], runs[i, 3] = rows * first + odd, rows * step
    starts[i, 0], starts[i, 1] = step * (first - start) * slant, slant


@helper
def _read(flat: Bytes, width: int, channels: int, runs: Ints, i: Index, pixels: Bytes, at: int) -> int:
    """Copy the pixels of line i, inside first, to a place of `pixels`; returns the place behind them."""
    across, fixed, position, step = runs[i, 0], runs[i, 1], runs[i, 2], runs[i, 3]
    start = (fixed * width + position if across else position * width + fixed) * channels
    stride = (step if across else step * width) * channels
    k, there, jump = np.uintp(at), np.uintp(start), np.uintp(stride)
    if channels == 3:
        for _ in range(runs[i, 4]):
            pixels[k] = flat[there]
            pixels[k + ONE] = flat[there + ONE]
            pixels[k + TWO] = flat[there + TWO]
            k, there = k + THREE, (there + jump) & ROUND_ABOUT
    else:
        for _ in range(runs[i, 4]):
            pixels[k] = flat[there]
            k, there = k + ONE, (there + jump) & ROUND_ABOUT
    return int(at + channels * runs[i, 4])


@helper
def _sum(pixels: Bytes, at: int, length: int, table: npt.NDArray[np.int8], sums: Counts) -> None:
    """Take running sums of scores and values along a line: those at k cover the pixels before k."""
    ts = t0 = t1 = t2 = np.int32(0)
    k = np.uintp(at)
    if table.size > 256:
        for place in range(length):
            after = np.uintp(place + 1)
            b, g, r = np.uint32(pixels[k]), np.uint32(pixels[k + ONE]), np.uint32(pixels[k + TWO])
            ts += np.int32(table[np.uintp((b >> B3) << B10 | (g >> B3) << B5 | r >> B3)])
            t0 += np.int32(b)
            t1 += np.int32(g)
            t2 += np.int32(r)
            k += THREE
            sums[after], sums[after + W1], sums[after + W2], sums[after + W3] = ts, t0, t1, t2
    else:
        for place in range(length):
            value, after = pixels[k + np.uintp(place)], np.uintp(place + 1)
            ts += np.int32(table[np.uintp(value)])
            t0 += np.int32(value)
            sums[after], sums[after + W1], sums[after + W2], sums[after + W3] = ts, t0, t1, t2


@helper
def _judge(s: Counts, length: int, margin: int, threshold: float, enough: float, plain: float, asked: Singles) -> None:
    """At every pixel the squared contrast, and the whiteness of Eq. 1: 0 where there is no edge point."""
    m, w = np.uintp(margin), np.uintp(2 * margin + 1)
    asked[m - ONE] = asked[np.uintp(length - margin)] = np.float32(0.0)
    firm, weak, full = np.float32(FIRM * enough), np.float32(WEAK * enough), np.float32(enough)
    least, nabla = np.float32(plain), np.float32(threshold)
    for index in range(length - 2 * margin):
        a = np.uintp(index)
        k, b, d = a + m, a + m + ONE, a + w
        difference = np.float32(np.int32(s[k] - s[a] - s[d] + s[b]))
        d0 = np.int32(s[k + W1] - s[a + W1] - s[d + W1] + s[b + W1])
        d1 = np.int32(s[k + W2] - s[a + W2] - s[d + W2] + s[b + W2])
        d2 = np.int32(s[k + W3] - s[a + W3] - s[d + W3] + s[b + W3])
        contrast = np.float32(np.int32(d0 * d0 + d1 * d1 + d2 * d2))  # below 2^24: exact
        asked[k] = contrast
        is_edge = ((difference > firm) | (contrast > least)) & (difference > nabla)
        white = difference if difference > weak else weak
        asked[k + W1] = (white if white < full else full) * np.float32(is_edge)


@helper
def _keep(
    i: Index, j: Index, k: Index, strength: np.float32, asked: Singles, start: Floats, enough: float, edges: Floats
) -> None:
    """Write the peak at pixel k as edge point j of line i, to a fraction of a pixel."""
    before, c, after = asked[k - ONE], asked[k], asked[k + ONE]
    peak = float(k)
    if before > 0.0 and after > 0.0:
        peak += 0.5 * (after - before) / (2.0 * c - before - after)
    edges[i, j, 0], edges[i, j, 1] = start[i, 0] + peak * start[i, 1], strength
    edges[i, j, 2] = asked[k + W1] / enough


@helper
def _keep_best(
    length: int, margin: int, i: Index, starts: Floats, enough: float, asked: Singles, edges: Floats
) -> None:
    """Keep the strongest peaks of line i: at a peak of the contrast its strength is contrast times whiteness."""
    q0 = q1 = q2 = np.float32(0.0)
    k0 = k1 = k2 = ZERO
    before, c = asked[np.uintp(margin - 1)], asked[np.uintp(margin)]
    for place in range(margin, length - margin):
        k = np.uintp(place)
        after = asked[k + ONE]
        q = c * asked[k + W1] * np.float32((c >= before) & (c > after))
        before, c = c, after
        if q > q2:
            if q > q0:
                q0, q1, q2, k0, k1, k2 = q, q0, q1, k, k0, k1
            elif q > q1:
                q1, q2, k1, k2 = q, q1, k, k1
            else:
                q2, k2 = q, k
    edges[i, ZERO, 1] = edges[i, ONE, 1] = edges[i, TWO, 1] = 0.0
    if q0 > 0.0:
        _keep(i, ZERO, k0, q0, asked, starts, enough, edges)
    if q1 > 0.0:
        _keep(i, ONE, k1, q1, asked, starts, enough, edges)
    if q2 > 0.0:
        _keep(i, TWO, k2, q2, asked, starts, enough, edges)


@kernel(refcount=False)
def match_lines(
    image: Bytes,
    table: npt.NDArray[np.int8],
    outline: Floats,
    reach: float,
    margin: int,
    threshold: float,
    enough: float,
    plain: float,
    combed: bool,
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
        See `Views`. What is written: by how much an edge moves along its normal if the even rows of an interlaced
        picture lie (dx, dy) / 2 ahead of the mean and its odd rows behind; nothing on a line that crosses both.
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
    combed : bool
        Whether the fields of an interlaced picture lie so far apart that a line along a column must keep to one.
    edges, runs, starts, pixels, sums
        Working arrays, see `Views`.

    Returns
    -------
    float
        Standard deviation of the noise of the pixels inside the shape, gray levels.
    """
    half_way = 4 * WIDTH
    running, asked = sums[:half_way].view(np.int32), sums[half_way:]
    height, width, channels = image.shape
    flat, fields, at = cut(image, 0, (image.size,)), outline.shape[1] - 2, 0
    for index in range(outline.shape[0]):
        i = np.uintp(index)  # unsigned indices spare Numba's check for negative ones
        _place(outline, i, reach, margin, height, width, combed, runs, starts)
        at = _read(flat, width, channels, runs, i, pixels, at)
    rough, count, at, c = 0.0, 0, 0, min(1, channels - 1)
    for index in range(outline.shape[0]):
        i = np.uintp(index)
        length = runs[i, 4]
        if length > 2:
            a, b, d = np.uintp(at + c), np.uintp(at + c + channels), np.uintp(at + c + 2 * channels)
            rough += abs(float(pixels[a]) - 2.0 * float(pixels[b]) + float(pixels[d]))
            count += 1
        along, step = runs[i, 0], runs[i, 3]
        half = 0.5 - (runs[i, 1 if along else 2] & 1) if along or step * step > 1 else 0.0
        outline[i, fields], outline[i, fields + 1] = half * outline[i, 2], half * outline[i, 3]
        if length == 0:
            edges[i, ZERO, 1] = edges[i, ONE, 1] = edges[i, TWO, 1] = 0.0
            continue
        _sum(pixels, at, length, table, running)
        at += channels * length
        _judge(running, length, margin, threshold, enough, plain, asked)
        _keep_best(length, margin, i, starts, enough, asked, edges)
    return rough / (1.95 * max(count, 1))  # E|a - 2b + c| of unit noise
