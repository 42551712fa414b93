"""Slow and obvious twins of the tracking kernels, for the tests."""

import cmath
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kernels import Floats, Limits
from matchset.fitting.fit_quality import QualityParameters
from matchset.fitting.match_set import MAX_PIXELS, MatchParameters
from matchset.fitting.robust_fit import FitParameters

Scores = npt.NDArray[np.int8]
FIT, MATCH = FitParameters(), MatchParameters()
LEAST = QualityParameters().min_residual
USUAL = 64  # lines that the limits are for
FIRM, WEAK = np.float32(MATCH.firm_step), np.float32(MATCH.weak_step)


class EdgePoint(NamedTuple):
    offset: float
    strength: float
    whiteness: float


class Line(NamedTuple):
    """The pixels of a line, inside first, as (x, y), and the offset of each along the normal."""

    pixels: list[tuple[int, int]]
    offsets: list[float]


def line(shape: tuple[int, ...], point: Floats, normal: Floats, limits: Limits) -> Line | None:
    """Along the row where the normal is rather level, else along the column; None where it is not in the picture."""
    height, width = shape[:2]
    x, y, nx, ny = (float(value) for value in (*point, *normal))
    level = abs(nx) >= abs(ny)
    if level:
        fixed = math.floor(y + 0.5)
        crossing, size, side, inside = x - (fixed - y) * ny / nx, width, nx, 0 <= fixed < height
    else:
        fixed = math.floor(x + 0.5)
        crossing, size, side, inside = y - (fixed - x) * nx / ny, height, ny, 0 <= fixed < width
    nearest = math.floor(crossing + 0.5)
    span = min(int(limits.range_px / abs(side)) + 1 + limits.margin, MAX_PIXELS // 2 - 2)
    places = [p for p in range(nearest - span, nearest + span + 1) if 0 <= p < size]
    room = nearest - limits.margin >= 0 and nearest + limits.margin < size
    if not inside or not room:
        return None
    places.sort(reverse=side < 0)
    return Line([(p, fixed) if level else (fixed, p) for p in places], [side * (p - crossing) for p in places])


def one_field(
    image: npt.NDArray[np.uint8], point: Floats, normal: Floats, odd: int
) -> tuple[npt.NDArray[np.uint8], Floats, Floats]:
    """One field of an interlaced picture, and a line in it: its rows lie two px apart."""
    return image[odd::2], np.array((point[0], 0.5 * (point[1] - odd))), np.array((normal[0], 2.0 * normal[1]))


def score(pixel: npt.NDArray[np.uint8], table: Scores) -> int:
    if table.size == 256:
        return int(table[int(pixel[0])])
    b, g, r = (int(value) // 8 for value in pixel)
    return int(table[b * 1024 + g * 32 + r])


def edge_points(
    image: npt.NDArray[np.uint8], table: Scores, point: Floats, normal: Floats, limits: Limits
) -> list[EdgePoint]:
    """Peaks of the contrast at which Eq. 1 holds on one line, strongest first."""
    across = line(image.shape, point, normal, limits)
    if across is None:
        return []
    values = [image[y, x].astype(float) for x, y in across.pixels]
    scores = [score(image[y, x], table) for x, y in across.pixels]
    m, contrast = limits.margin, [0.0] * len(values)
    for k in range(m, len(values) - m):
        step = np.sum(values[k - m : k], axis=0) - np.sum(values[k + 1 : k + m + 1], axis=0)
        contrast[k] = float(step @ step)
    pitch = max(abs(float(normal[0])), abs(float(normal[1])))
    found = []
    for k in range(m, len(values) - m):
        difference = sum(scores[k - m : k]) - sum(scores[k + 1 : k + m + 1])
        clear = difference > FIRM * limits.full_step or contrast[k] > limits.min_contrast
        before, here, after = contrast[k - 1 : k + 2]
        if not (difference > limits.threshold and clear and here > 0.0 and before <= here > after):
            continue
        white = min(max(float(difference), float(WEAK) * limits.full_step), limits.full_step)
        shift = 0.5 * (after - before) / (2.0 * here - before - after) if before > 0.0 and after > 0.0 else 0.0
        offset = across.offsets[k] + shift * pitch
        found.append(EdgePoint(offset, here * white, white / limits.full_step))
    return sorted(found, key=lambda each: -each.strength)[:3]


def trust(strength: Floats, i: int, j: int) -> float:
    """Share of its full weight that an edge point has for its strength."""
    roots = [math.sqrt(each) for each in strength[:, 0] if each > 0.0]
    q = float(strength[i, j])
    return q / (q + FIT.half_weight_strength * (sum(roots) / len(roots)) ** 2)


def weigh(
    offset: Floats, strength: Floats, predicted: Floats, sigma: float
) -> tuple[list[int], list[float], list[float]]:
    """Which edge point each line takes, its residual and its weight (Tukey's biweight times its strength)."""
    chosen, residual, weight = [], [], []
    for i in range(len(offset)):
        there = [j for j in range(3) if strength[i, j] > 0.0]
        costs = [
            ((offset[i, j] - predicted[i]) / sigma) ** 2
            + FIT.strength_preference * math.log(strength[i, 0] / strength[i, j])
            for j in there
        ]
        best = there[int(np.argmin(costs))] if there else 0
        e = offset[i, best] - predicted[i] if there else math.inf
        z = e / ((FIT.outer_cut if e > 0 else FIT.inner_cut) * sigma)
        chosen.append(best)
        residual.append(e)
        weight.append((1 - z * z) ** 2 * trust(strength, i, best) if abs(z) < 1 else 0.0)
    return chosen, residual, weight


def review(
    residual: Floats, whiteness: Floats, seen: npt.NDArray[np.bool_], tolerance: float
) -> tuple[int, int, float, float, float, float]:
    """Seen, confirmed, agreement, evidence, wave and corners of n lines at even angles."""
    n = len(residual)
    there = [i for i in range(n) if seen[i]]
    confirmed = [i for i in there if abs(residual[i]) <= tolerance]
    near = {i: 1.0 - (residual[i] / tolerance) ** 2 for i in confirmed}
    evidence = sum(near[i] * (0.5 + 0.5 * whiteness[i]) for i in confirmed)
    apart = max(math.ceil(n / USUAL), 1)
    pairs = [(i, i - apart) for i in confirmed if i >= apart and seen[i - apart] and i - apart in near]
    square = sum(residual[i] ** 2 + LEAST**2 for i in confirmed)
    wide = [i for i in there if abs(residual[i]) <= 2.0 * tolerance]
    harmonics = [
        abs(sum(residual[i] * cmath.exp(1j * k * 2.0 * math.pi * (i + 0.5) / n) for i in wide)) for k in (3, 4)
    ]
    deviation = math.sqrt(0.5 * sum(residual[i] ** 2 + LEAST**2 for i in wide) + 1e-9)
    whole = max(len(there), 1)
    return (
        len(there),
        len(confirmed),
        sum(near.values()) / whole,
        evidence / whole,
        sum(residual[i] * residual[j] for i, j in pairs) / (square + 1e-9),
        max(harmonics) * min(math.sqrt(USUAL / n), 1.0) / deviation,
    )
