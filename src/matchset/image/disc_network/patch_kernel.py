"""Read a patch along the rays of a circle, in compiled code: `read_patch_kernel`, `read_places_kernel`."""

import math
from typing import Annotated

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.lab_cells import MOST_TAPS, SIDE, read_cells, window_of
from matchset.image.disc_network.patch_format import (
    AROUND,
    BINS_AB,
    BINS_L,
    COLORS,
    DIRECTIONS,
    FLOOR,
    INSIDE,
    LAB_UNIT,
    LEAST_SPREAD,
    LOW_AB,
    MIDDLE,
    MOST,
    NUMBERS,
    PER_AB,
    PER_L,
    PLACES,
    RADII,
    RAYS,
    SPREAD,
    Colors,
    Image,
    Patch,
)
from matchset.image.disc_network.selection import median
from matchset.numeric.jit import helper, kernel
from matchset.numeric.record import Block, Record, record_dtype

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

MIDDLE_PLACES = int(np.sum(RADII < MIDDLE))  # format: places of a ray in the middle
INSIDE_PLACES = int(np.sum(RADII < INSIDE))
FIRST_AROUND = int(np.sum(RADII <= AROUND))  # format: first place of a ray around
NOT_YET = 2.0  # format: log-odds, at most 1, that were not worked out


class PatchMemory:
    """Working memory of a reading."""

    away: Annotated[Floats, (PLACES,), "f8"]
    window: Annotated[npt.NDArray[np.int64], (6,), "i8"]
    where: Annotated[npt.NDArray[np.int64], (2, SIDE, MOST_TAPS), "i8"]
    share: Annotated[Singles, (2, SIDE, MOST_TAPS), "f4"]
    cells: Annotated[Singles, (SIDE, SIDE, 3), "f4"]
    colors: Annotated[Singles, (RAYS, PLACES, 3), "f4"]
    seen: Annotated[Singles, (RAYS, PLACES), "f4"]
    which: Annotated[npt.NDArray[np.int64], (RAYS, PLACES), "i8"]
    middle: Annotated[Singles, (RAYS * MIDDLE_PLACES,), "f4"]
    inside: Annotated[Singles, (BINS_L, BINS_AB, BINS_AB), "f4"]
    around: Annotated[Singles, (BINS_L, BINS_AB, BINS_AB), "f4"]
    blurred: Annotated[Singles, (BINS_L, BINS_AB, BINS_AB), "f4"]
    odds: Annotated[Singles, (COLORS,), "f4"]
    known_odds: Annotated[Singles, (COLORS,), "f4"]


PATCH_MEMORY = record_dtype(PatchMemory)


@helper
def _interpolate(cells: Singles, column: float, row: float, out: Singles) -> None:
    """Write the color between four cells."""
    left, top = np.uint64(column), np.uint64(row)
    right, below = left + np.uint64(1), top + np.uint64(1)
    u, v = np.float32(column - left), np.float32(row - top)
    for k in range(3):
        upper = cells[top, left, k] + u * (cells[top, right, k] - cells[top, left, k])
        lower = cells[below, left, k] + u * (cells[below, right, k] - cells[below, left, k])
        out[k] = upper + v * (lower - upper)


@kernel(refcount=False, entry=False)
def _read_places(image: Image, circle: Floats, memory: Record) -> bool:
    """Read the color of each place, CIE Lab, and whether it is in the picture; False where hardly anything is."""
    height, width = image.shape[:2]
    window, cells = memory.window, memory.cells
    if not window_of(height, width, circle, window):
        return False
    read_cells(image, circle, window, memory.where, memory.share, cells)
    columns, rows, away = window[4], window[5], memory.away
    across, down = columns / window[2], rows / window[3]
    x, y = circle[0], circle[1]
    left, top = (x - window[0] + 0.5) * across - 0.5, (y - window[1] + 0.5) * down - 0.5
    for place in range(PLACES):
        away[place] = circle[2] * RADII[place]
    for ray in range(RAYS):
        u, v = DIRECTIONS[ray, 0], DIRECTIONS[ray, 1]
        for place in range(PLACES):
            right, below = away[place] * u, away[place] * v
            memory.seen[ray, place] = 0.0 <= x + right <= width - 1.0 and 0.0 <= y + below <= height - 1.0
            column = min(max(left + right * across, 0.0), columns - 1.0)
            row = min(max(top + below * down, 0.0), rows - 1.0)
            _interpolate(cells, column, row, memory.colors[ray, place])
    return True


@kernel(refcount=False, entry=False)
def _normalize(memory: Record, patch: Patch) -> None:
    """Write colors less the median of the middle, in units of the spread of all."""
    total = 0.0
    for k in range(3):
        for ray in range(RAYS):
            for place in range(MIDDLE_PLACES):
                memory.middle[ray * MIDDLE_PLACES + place] = memory.colors[ray, place, k]
        middle = np.float32(median(memory.middle))
        for ray in range(RAYS):
            for place in range(PLACES):
                apart = np.float32(LAB_UNIT) * (memory.colors[ray, place, k] - middle)
                patch[ray, place, k] = apart
                total += apart * apart
    unit = np.float32(SPREAD / max(math.sqrt(total / (RAYS * PLACES * 3)), LEAST_SPREAD))
    for ray in range(RAYS):
        for place in range(PLACES):
            for k in range(3):
                patch[ray, place, k] *= unit


@kernel(refcount=False, entry=False)
def _find_bins(memory: Record) -> None:
    """Write the bin of each place's color in a histogram."""
    for ray in range(RAYS):
        for place in range(PLACES):
            color = memory.colors[ray, place]
            light = min(max(int(color[0] * PER_L), 0), BINS_L - 1)
            a = min(max(int((color[1] - LOW_AB) * PER_AB), 0), BINS_AB - 1)
            b = min(max(int((color[2] - LOW_AB) * PER_AB), 0), BINS_AB - 1)
            memory.which[ray, place] = (light * BINS_AB + a) * BINS_AB + b


@kernel(refcount=False, entry=False)
def _count(memory: Record, first: int, last: int, counts: Singles) -> float:
    """Write how much of each color there is between two places of the rays, by the area; how much in all."""
    flat = counts.reshape(COLORS)
    flat[:] = 0.0
    total = 0.0
    for ray in range(RAYS):
        for place in range(first, last):
            weight = np.float32(RADII[place]) * memory.seen[ray, place]
            flat[memory.which[ray, place]] += weight
            total += weight
    return total


@kernel(refcount=False, entry=False)
def _blur(counts: Singles, other: Singles) -> None:
    """Blur a histogram along each axis as if that were a ring; `other` is overwritten."""
    half, quarter = np.float32(0.5), np.float32(0.25)
    for light in range(BINS_L):
        for a in range(BINS_AB):
            before, after = (a - 1) % BINS_AB, (a + 1) % BINS_AB
            for b in range(BINS_AB):
                other[light, a, b] = half * counts[light, a, b] + quarter * (
                    counts[light, before, b] + counts[light, after, b]
                )
    for light in range(BINS_L):
        before, after = (light - 1) % BINS_L, (light + 1) % BINS_L
        for a in range(BINS_AB):
            for b in range(BINS_AB):
                counts[light, a, b] = half * other[light, a, b] + quarter * (other[before, a, b] + other[after, a, b])
    for light in range(BINS_L):
        for a in range(BINS_AB):
            row = counts[light, a]
            first, last = row[0], row[BINS_AB - 1]
            own = last
            for b in range(BINS_AB):
                here, following = row[b], row[b + 1] if b + 1 < BINS_AB else first
                row[b] = half * here + quarter * (own + following)
                own = here


@kernel(refcount=False)
def read_patch_kernel(image: Image, circle: Floats, known: Colors, block: Block, patch: Patch) -> bool:
    """Write a patch; False where hardly anything of the circle is in the picture.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1), uint8
    circle : (3,), float64
        x, y and radius, px.
    known : (9216,) or (0,), float32
        Shares of the colors known; none where it is empty.
    block : float64
        A `PATCH_MEMORY`.
    patch : (64, 32, 6), float32, written
    """
    memory = block.view(PATCH_MEMORY)[0]
    if not _read_places(image, circle, memory):
        return False
    _normalize(memory, patch)
    _find_bins(memory)
    inside, around = memory.inside, memory.around
    all_inside = max(_count(memory, 0, INSIDE_PLACES, inside), 1e-6)
    all_around = max(_count(memory, FIRST_AROUND, PLACES, around), 1e-6)
    _blur(inside, memory.blurred)
    _blur(around, memory.blurred)
    _write_log_odds(memory, all_inside, all_around, known, patch)
    return True


@kernel(refcount=False, entry=False)
def _write_log_odds(memory: Record, all_inside: float, all_around: float, known: Colors, patch: Patch) -> None:
    """Write the log-odds of each place's color, worked out once a color, and which places are in the picture."""
    inside, around = memory.inside.reshape(COLORS), memory.around.reshape(COLORS)
    odds, known_odds, which = memory.odds, memory.known_odds, memory.which.reshape(RAYS * PLACES)
    flat, seen = patch.reshape(RAYS * PLACES, NUMBERS), memory.seen.reshape(RAYS * PLACES)
    for place in range(RAYS * PLACES):
        odds[which[place]] = NOT_YET
    for place in range(RAYS * PLACES):
        color = which[place]
        if odds[color] == NOT_YET:
            rest = around[color] / all_around + FLOOR
            odds[color] = min(max(math.log((inside[color] / all_inside + FLOOR) / rest) / MOST, -1.0), 1.0)
            known_odds[color] = 0.0
            if known.shape[0] > 0:
                known_odds[color] = min(max(math.log((known[color] + FLOOR) / rest) / MOST, -1.0), 1.0)
        flat[place, 3], flat[place, 4], flat[place, 5] = odds[color], seen[place], known_odds[color]


@kernel(refcount=False)
def read_places_kernel(image: Image, circle: Floats, block: Block) -> bool:
    """Read the colors of the places of a circle, and their bins, into a `PATCH_MEMORY`.

    False where hardly anything of the circle is in the picture.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1), uint8
    circle : (3,), float64
        x, y and radius, px.
    block : float64
    """
    memory = block.view(PATCH_MEMORY)[0]
    if not _read_places(image, circle, memory):
        return False
    _find_bins(memory)
    return True
