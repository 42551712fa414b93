"""The match-set: edge points on short lines across the predicted outline (Epstein & Feldman, Eq. 1-4).

As in the paper every line runs along a row or a column: along the row where the outline is steep, along the column
where it is flat. On each line Eq. 1 is asked at every pixel p, with graded whiteness from the color table,

    difference(p) = (sum of scores of the `margin` pixels inside p) - (the same outside p) > threshold.

Color says that there is an edge, contrast says where: the edge points are the peaks of the squared contrast

    contrast(p) = |sum of the `margin` pixel values inside p - the same outside p|^2

at which Eq. 1 holds, to a fraction of a pixel. The strongest few of a line are kept: which of them belong to the shape
is the fit's question. The lines are read first and searched then, because memory is slower than arithmetic here.
"""

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import helper, kernel
from matchset.numeric.record import Record

Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]
Singles = npt.NDArray[np.float32]
Counts = npt.NDArray[np.int32]
Index = np.uintp | int

CANDIDATES = 3  # format: edge points kept per line, strongest first
MAX_PIXELS = 160  # format: pixels of a line at most; few, so that the working arrays stay in the processor's cache
SUMS = MAX_PIXELS + 1  # format: running sums along a line
S1, S2, S3 = np.uintp(SUMS), np.uintp(2 * SUMS), np.uintp(3 * SUMS)  # format: where those of each channel begin
ZERO, ONE, TWO, THREE = np.uintp(0), np.uintp(1), np.uintp(2), np.uintp(3)  # format: unsigned indices
SHIFT = 1 << 24  # theorem: int(x + SHIFT + 0.5) - SHIFT rounds x to the nearest integer, also below zero
ROUND = SHIFT + 0.5  # theorem: see SHIFT
# A jump back is a large unsigned number and wraps around; and what is masked is not read by vector instructions, which
# cost twice as much where a line has a dozen pixels.
WRAP = np.uintp((1 << 48) - 1)  # format: bits of an address
B3, B5, B10 = np.uint32(3), np.uint32(5), np.uint32(10)  # format: shifts of a color cell of 5 bits a channel
# theorem: E|a - 2 b + c| = sqrt(6) sqrt(2/pi) = 1.95 for independent normal a, b, c of unit variance
SECOND_DIFFERENCE = 1.95


class MatchParameters(msgspec.Struct, frozen=True):
    """What makes an edge point; all else follows from the size of the shape and the noise of the picture.

    Parameters
    ----------
    margin : int
        Most pixels that Eq. 1 counts on each side of an edge. Noisy pictures use them all, sharp ones two, small shapes
        a quarter of their half-width: more is steadier in noise and blur, less is more exact and tells stripes apart.
        Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    threshold : float
        The paper's nabla, as a share of a step from surely background to surely target: below it there is no edge.
        Slightly negative, since a pale stripe of the target may look more like background than what it lies before.
        Chosen by hand; `tests/test_real_clip.py` would show a change.
    full_step : float
        Share beyond which a larger step is no better, and the contrast alone decides where the edge is.
        Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    firm_step : float
        Share of the full step from which the contrast need not stand out of the noise.
        Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    weak_step : float
        Strength of an edge point without a step in color, as a share of that with a full step.
        Chosen by hand; `tests/test_real_clip.py` would show a change.
    min_contrast : float
        Contrast that an edge point without a firm step in color must have, in standard deviations of the noise.
        Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    size_share : float
        Largest margin, in half-widths of the shape: a small one has no room for more.
    base_margin, margin_per_noise : float
        Margin in a picture without noise, px, and what each gray level of noise adds.
        Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    min_margin : int
        Least margin as far as the size of the shape allows it, px.
    noise_memory : float
        Share of the pixels' noise, as known so far, that one look leaves.
    """

    margin: int = 4
    threshold: float = -0.05
    full_step: float = 0.6
    firm_step: float = 0.35
    weak_step: float = 0.4
    min_contrast: float = 5.0
    size_share: float = 0.25
    base_margin: float = 1.5
    margin_per_noise: float = 0.4
    min_margin: int = 2
    noise_memory: float = 0.9


@helper
def choose_criteria(work: Record) -> None:
    """Write `EdgeCriteria` but for its range: from the size of the shape, the noise and the field offset."""
    limits, noise, criteria, fields = work.match_limits, work.fit.pixel_noise, work.criteria, work.field_limits
    most = max(int(limits.base_margin + limits.margin_per_noise * noise), limits.min_margin)
    margin = max(min(int(limits.size_share * work.iteration.half_width), most, limits.margin), 1)
    full = 254.0 * margin  # whiteness of a step from surely background to surely target
    criteria.margin, criteria.threshold, criteria.full_step = margin, limits.threshold * full, limits.full_step * full
    criteria.min_contrast = 6.0 * margin * (limits.min_contrast * max(noise, 1.0)) ** 2  # of 2 margins, 3 channels
    apart = fields.comb_sigmas * max(work.iteration.noise, fields.comb_min_sigma)
    criteria.per_field = work.rows > 0 or abs(work.field_offset.expected[1]) > apart


@helper
def _place_line(work: Record, i: Index, height: int, width: int) -> None:
    """Where line i runs, the offset of its first pixel and its offset per pixel.

    Where the fields of an interlaced picture lie far apart, a line along a column reads one of them only. In a
    half-frame every line reads rows of the new field only.
    """
    outline, runs, starts, margin = work.outline, work.runs, work.starts, work.criteria.margin
    x, y, nx, ny = outline[i, 0], outline[i, 1], outline[i, 2], outline[i, 3]
    runs[i, 4] = 0
    if not (-1e6 < x < 1e6 and -1e6 < y < 1e6):
        return
    across = abs(nx) >= abs(ny)
    if not across:
        x, y, nx, ny = y, x, ny, nx
    size, other, rows, odd = (width, height, 1, 0) if across else (height, width, 1, 0)
    fixed, half = int(y + ROUND) - SHIFT, work.rows
    if half and across:  # the nearest row of this field
        fixed = 2 * (int(0.5 * (y - half + 1) + ROUND) - SHIFT) + half - 1
    start, slant = x - (fixed - y) * ny / nx, abs(nx)
    if work.criteria.per_field and not across:
        rows, odd = 2, half - 1 if half else int(i) & 1
        start, slant, size = 0.5 * (start - odd), 2.0 * slant, (size + 1 - odd) >> 1
    nearest = int(start + ROUND) - SHIFT
    span = min(int(work.criteria.range_px / slant) + 1 + margin, MAX_PIXELS // 2 - 2)
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
def _read_line(image: Bytes, flat: Bytes, work: Record, i: Index, at: int) -> int:
    """Copy the pixels of line i, inside first, to a place of `pixels`; returns the place behind them."""
    width, channels, runs, pixels = image.shape[1], image.shape[2], work.runs, work.pixels
    across, fixed, position, step = runs[i, 0], runs[i, 1], runs[i, 2], runs[i, 3]
    start = (fixed * width + position if across else position * width + fixed) * channels
    stride = (step if across else step * width) * channels
    k, there, jump = np.uintp(at), np.uintp(start), np.uintp(stride)
    if channels == 3:
        for _ in range(runs[i, 4]):
            pixels[k] = flat[there]
            pixels[k + ONE] = flat[there + ONE]
            pixels[k + TWO] = flat[there + TWO]
            k, there = k + THREE, (there + jump) & WRAP
    else:
        for _ in range(runs[i, 4]):
            pixels[k] = flat[there]
            k, there = k + ONE, (there + jump) & WRAP
    return int(at + channels * runs[i, 4])


@helper
def _sum_line(pixels: Bytes, at: int, length: int, table: Scores, sums: Counts) -> None:
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
            sums[after], sums[after + S1], sums[after + S2], sums[after + S3] = ts, t0, t1, t2
    else:
        for place in range(length):
            value, after = pixels[k + np.uintp(place)], np.uintp(place + 1)
            ts += np.int32(table[np.uintp(value)])
            t0 += np.int32(value)
            sums[after], sums[after + S1], sums[after + S2], sums[after + S3] = ts, t0, t1, t2


@helper
def _apply_criteria(work: Record, length: int) -> None:
    """At every pixel the squared contrast, and the whiteness of Eq. 1: 0 where there is no edge point."""
    criteria, limits, s, found = work.criteria, work.match_limits, work.running, work.responses
    margin, step = criteria.margin, criteria.full_step
    m, w = np.uintp(margin), np.uintp(2 * margin + 1)
    found[m - ONE] = found[np.uintp(length - margin)] = np.float32(0.0)
    firm, weak = np.float32(np.float32(limits.firm_step) * step), np.float32(np.float32(limits.weak_step) * step)
    full, least, nabla = np.float32(step), np.float32(criteria.min_contrast), np.float32(criteria.threshold)
    for index in range(length - 2 * margin):
        a = np.uintp(index)
        k, b, d = a + m, a + m + ONE, a + w
        difference = np.float32(np.int32(s[k] - s[a] - s[d] + s[b]))
        d0 = np.int32(s[k + S1] - s[a + S1] - s[d + S1] + s[b + S1])
        d1 = np.int32(s[k + S2] - s[a + S2] - s[d + S2] + s[b + S2])
        d2 = np.int32(s[k + S3] - s[a + S3] - s[d + S3] + s[b + S3])
        contrast = np.float32(np.int32(d0 * d0 + d1 * d1 + d2 * d2))  # below 2^24: exact
        found[k] = contrast
        is_edge = ((difference > firm) | (contrast > least)) & (difference > nabla)
        white = difference if difference > weak else weak
        found[k + S1] = (white if white < full else full) * np.float32(is_edge)


@helper
def _keep(work: Record, i: Index, j: Index, k: Index, strength: np.float32) -> None:
    """Write the peak at pixel k as edge point j of line i, to a fraction of a pixel."""
    found, start, edges = work.responses, work.starts, work.edges
    before, c, after = found[k - ONE], found[k], found[k + ONE]
    peak = float(k)
    if before > 0.0 and after > 0.0:
        peak += 0.5 * (after - before) / (2.0 * c - before - after)
    edges[i, j, 0], edges[i, j, 1] = start[i, 0] + peak * start[i, 1], strength
    edges[i, j, 2] = found[k + S1] / work.criteria.full_step


@helper
def _keep_best(work: Record, i: Index, length: int) -> None:
    """Keep the strongest peaks of line i: at a peak of the contrast its strength is contrast times whiteness."""
    q0 = q1 = q2 = np.float32(0.0)
    k0 = k1 = k2 = ZERO
    found, edges, margin = work.responses, work.edges, work.criteria.margin
    before, c = found[np.uintp(margin - 1)], found[np.uintp(margin)]
    for place in range(margin, length - margin):
        k = np.uintp(place)
        after = found[k + ONE]
        q = c * found[k + S1] * np.float32((c >= before) & (c > after))
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
        _keep(work, i, ZERO, k0, q0)
    if q1 > 0.0:
        _keep(work, i, ONE, k1, q1)
    if q2 > 0.0:
        _keep(work, i, TWO, k2, q2)


@helper
def _write_field_columns(work: Record, i: Index) -> None:
    """By how much an edge on line i moves along its normal per px of field offset: none if the line crosses both."""
    outline, runs, column = work.outline, work.runs, work.state_count + 4
    along, step = runs[i, 0], runs[i, 3]
    half = 0.5 - (runs[i, 1 if along else 2] & 1) if along or step * step > 1 else 0.0
    outline[i, column], outline[i, column + 1] = half * outline[i, 2], half * outline[i, 3]


@kernel(refcount=False, entry=False)
def find_edge_points(image: Bytes, table: Scores, work: Record) -> float:
    """Find the edge points on the lines across an outline (Epstein & Feldman, Eq. 1-4).

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    table : (32768,) or (256,) int8
        Score of each BGR cell or gray value, see `ColorModel`.
    work : record
        Reads `outline` and `criteria`; writes `runs`, `starts`, `edges` and the last two columns of `outline`: by how
        much an edge moves along its normal if the even rows of an interlaced picture lie (dx, dy) / 2 ahead of the mean
        and its odd rows behind; nothing on a line that crosses both.

    Returns
    -------
    float
        Standard deviation of the noise of the pixels inside the shape, gray levels.
    """
    n, height, width, channels = work.line_count, image.shape[0], image.shape[1], image.shape[2]
    flat, at = image.reshape((image.size,)), int(np.int64(0))
    for index in range(n):
        i = np.uintp(index)  # unsigned indices spare Numba's check for negative ones
        _place_line(work, i, height, width)
        at = _read_line(image, flat, work, i, at)
    rough, count, at, c = 0.0, 0, int(np.int64(0)), 1 if channels > 1 else 0
    pixels, runs, edges = work.pixels, work.runs, work.edges
    for index in range(n):
        i = np.uintp(index)
        length = runs[i, 4]
        if length > 2:
            a, b, d = np.uintp(at + c), np.uintp(at + c + channels), np.uintp(at + c + 2 * channels)
            rough += abs(float(pixels[a]) - 2.0 * float(pixels[b]) + float(pixels[d]))
            count += 1
        _write_field_columns(work, i)
        if length == 0:
            edges[i, ZERO, 1] = edges[i, ONE, 1] = edges[i, TWO, 1] = 0.0
            continue
        _sum_line(pixels, at, length, table, work.running)
        at += channels * length
        _apply_criteria(work, length)
        _keep_best(work, i, length)
    return rough / (SECOND_DIFFERENCE * max(count, 1))
