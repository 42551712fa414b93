"""The region of a blurred target in compiled code: `find_region`; see `soft_region`."""

import math
from typing import Annotated

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.selection import median, quantile
from matchset.numeric.jit import helper, kernel
from matchset.numeric.linalg import invert_3x3
from matchset.numeric.record import Block, Record, record_dtype

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Cells = npt.NDArray[np.int64]

MOST_CELLS = 64  # format: cells of the window in a row at most
PLACES, FIRST_PLACE, LAST_PLACE = 49, 0.4, 1.6  # geometry: of a line across the rim, half-widths from the center
MOST_LINES = 128  # format: lines across the rim at most
TAPS = 3  # geometry: pixels of a cell along an axis that are read at most
FEW = 8  # theorem: pixels that a covariance of three channels needs at least, twice over
ROW = 0.5  # geometry: half the width of a row of cells, cells
IN_REGION, OUTSIDE = 1, 2  # format: what is known of a cell, 0 if nothing


class RegionLimits:
    """`SoftRegionParameters` as the kernel reads them."""

    inner: float
    nearest: float
    farthest: float
    window: float
    border: float
    cells: float
    pixel_noise: float
    contrast: float
    level: float
    rounds: float
    still: float
    lines: float
    high: float
    low: float
    sharper: float


class RegionMemory:
    """Working memory, and what was found."""

    limits: RegionLimits
    x: float
    y: float
    half_width: float
    agreement: float
    swept: float
    rim: float
    left: float
    top: float
    step: float
    count: float
    here: Annotated[Floats, (3,), "f8"]
    there: Annotated[Floats, (3,), "f8"]
    center: Annotated[Floats, (3,), "f8"]
    weights: Annotated[Floats, (3,), "f8"]
    spread: Annotated[Floats, (3, 3), "f8"]
    inverse: Annotated[Floats, (3, 3), "f8"]
    columns: Annotated[Cells, (MOST_CELLS * TAPS,), "i8"]
    rows: Annotated[Cells, (MOST_CELLS * TAPS,), "i8"]
    pixels: Annotated[Floats, (3, MOST_CELLS * MOST_CELLS), "f8"]
    away: Annotated[Floats, (MOST_CELLS * MOST_CELLS,), "f8"]
    values: Annotated[Floats, (3, MOST_CELLS * MOST_CELLS), "f8"]
    labels: Annotated[Cells, (MOST_CELLS * MOST_CELLS,), "i8"]
    stack: Annotated[Cells, (MOST_CELLS * MOST_CELLS,), "i8"]
    widths: Annotated[Floats, (MOST_LINES,), "f8"]
    line: Annotated[Floats, (PLACES,), "f8"]


REGION_MEMORY = record_dtype(RegionMemory)


@helper
def _pixel(image: Image, x: float, y: float, channel: int) -> float:
    """Pixel at a place; beyond the picture the border repeats."""
    column = min(max(int(x), 0), image.shape[1] - 1)
    row = min(max(int(y), 0), image.shape[0] - 1)
    return float(image[row, column, channel])


@kernel(refcount=False, entry=False)
def _read_window(image: Image, memory: Record) -> bool:
    """Read the window around the disc in cells; False where the disc is not wholly in the picture."""
    limits, height, width = memory.limits, image.shape[0], image.shape[1]
    x, y, size = memory.x, memory.y, memory.half_width
    if x < size or y < size or x > width - 1 - size or y > height - 1 - size:
        return False
    half = limits.window * size
    side = max(round(2.0 * half), 2)
    memory.left, memory.top = round(x - half), round(y - half)
    cells = min(int(limits.cells), side)
    memory.step, memory.count = side / cells, cells
    taps = min(max(math.ceil(memory.step), 1), TAPS)
    share = 1.0 / (taps * taps)
    for k in range(cells * taps):
        at = (k // taps + (k % taps + 0.5) / taps) * memory.step
        memory.columns[k] = min(max(int(memory.left + at), 0), width - 1)
        memory.rows[k] = min(max(int(memory.top + at), 0), height - 1)
    for row in range(cells):
        for column in range(cells):
            index = row * cells + column
            across = memory.left + (column + 0.5) * memory.step - 0.5 - x
            down = memory.top + (row + 0.5) * memory.step - 0.5 - y
            memory.away[index] = math.sqrt((across) ** 2 + (down) ** 2) / size
            for channel in range(image.shape[2]):
                total = 0
                for k in range(row * taps, row * taps + taps):
                    for m in range(column * taps, column * taps + taps):
                        total += image[memory.rows[k], memory.columns[m], channel]
                memory.pixels[channel, index] = share * total
    return True


@kernel(refcount=False, entry=False)
def _add_spread(memory: Record, channels: int, least: float, most: float, typical: Floats) -> int:
    """Add half the covariance of the pixels between two distances, and write their median; how many they are."""
    cells, away, count, values = int(memory.count), memory.away, 0, memory.values
    for index in range(cells * cells):
        if least < away[index] < most:
            for channel in range(channels):
                values[channel, count] = memory.pixels[channel, index]
            count += 1
    if count < FEW:
        return count
    for channel in range(channels):
        total = 0.0
        for k in range(count):
            total += values[channel, k]
        memory.center[channel] = total / count
    for a in range(channels):
        for b in range(a, channels):
            total = 0.0
            for k in range(count):
                total += (values[a, k] - memory.center[a]) * (values[b, k] - memory.center[b])
            memory.spread[a, b] += 0.5 * total / (count - 1)
            memory.spread[b, a] = memory.spread[a, b]
    for channel in range(channels):
        typical[channel] = median(values[channel, :count])
    return count


@kernel(refcount=False, entry=False)
def _discriminate(memory: Record, channels: int) -> bool:
    """Write Fisher's discriminant of the pixels inside and around; False where they hardly differ."""
    limits, spread, here, there = memory.limits, memory.spread, memory.here, memory.there
    for a in range(3):
        here[a], there[a], memory.weights[a] = 0.0, 0.0, 0.0
        for b in range(3):
            spread[a, b] = limits.pixel_noise * limits.pixel_noise if a == b else 0.0
    if _add_spread(memory, channels, -1.0, limits.inner, here) < FEW:
        return False
    if _add_spread(memory, channels, limits.nearest, limits.farthest, there) < FEW:
        return False
    if not invert_3x3(spread, memory.inverse):
        return False
    apart = 0.0
    for a in range(3):
        for b in range(3):
            memory.weights[a] += memory.inverse[a, b] * (here[b] - there[b])
        apart += memory.weights[a] * (here[a] - there[a])
    if not apart > limits.contrast * limits.contrast:
        return False
    for a in range(3):
        memory.weights[a] /= apart
    return True


@kernel(refcount=False, entry=False)
def _flood(memory: Record, first: int, wanted: int, label: int, diagonal: bool) -> int:
    """Label the cells that are connected with one, all of what is wanted; how many there are."""
    cells, labels, stack = int(memory.count), memory.labels, memory.stack
    labels[first], stack[0], filled, size = label, first, 1, 0
    while filled > 0:
        filled -= 1
        index = stack[filled]
        size += 1
        row, column = index // cells, index % cells
        for down in range(-1, 2):
            for across in range(-1, 2):
                if down * across != 0 and not diagonal:
                    continue
                if 0 <= row + down < cells and 0 <= column + across < cells:
                    other = (row + down) * cells + column + across
                    if labels[other] == wanted:
                        labels[other], stack[filled] = label, other
                        filled += 1
    return size


@kernel(refcount=False, entry=False)
def _find_main(memory: Record, channels: int) -> bool:
    """Mark the largest connected region of what is more target than background, its holes filled."""
    cells, labels, limits = int(memory.count), memory.labels, memory.limits
    for index in range(cells * cells):
        share = 0.0
        for channel in range(channels):
            share += (memory.pixels[channel, index] - memory.there[channel]) * memory.weights[channel]
        labels[index] = -1 if share > limits.level and memory.away[index] < limits.border else 0
    best, most, label = 0, 0, 1
    for index in range(cells * cells):
        if labels[index] == -1:
            label += 1
            size = _flood(memory, index, -1, label, True)
            if size > most:
                best, most = label, size
    if most == 0:
        return False
    for index in range(cells * cells):
        labels[index] = IN_REGION if labels[index] == best else 0
    for k in range(cells):
        for index in (k, (cells - 1) * cells + k, k * cells, k * cells + cells - 1):
            if labels[index] == 0:
                _flood(memory, index, 0, OUTSIDE, False)
    for index in range(cells * cells):
        labels[index] = 0 if labels[index] == OUTSIDE else IN_REGION
    return True


@kernel(refcount=False, entry=False)
def _take_disc(memory: Record) -> None:
    """Write the disc with the region's center and area, and how far both agree."""
    cells, labels = int(memory.count), memory.labels
    area = across = down = 0.0
    for index in range(cells * cells):
        if labels[index] == IN_REGION:
            area += 1.0
            across += index % cells
            down += index // cells
    across, down, size = across / area, down / area, math.sqrt(area / math.pi)
    both = either = 0.0
    for index in range(cells * cells):
        within = math.hypot(index % cells - across, index // cells - down) <= size
        both += within and labels[index] == IN_REGION
        either += within or labels[index] == IN_REGION
    memory.agreement = both / either
    memory.x = memory.left + (across + 0.5) * memory.step - 0.5
    memory.y = memory.top + (down + 0.5) * memory.step - 0.5
    memory.half_width = size * memory.step


@kernel(refcount=False, entry=False)
def _measure_swept(memory: Record) -> None:
    """Write the agreement with the disc swept along a way that has the region's area and moments.

    A disc of radius r swept along 2 a has the area A = pi r^2 + 4 a r, and across its way the variance
    V = r^2 / 3 - pi r^4 / (12 A): a quadratic equation of r^2.
    """
    cells, labels = int(memory.count), memory.labels
    area = x = y = xx = xy = yy = 0.0
    for index in range(cells * cells):
        if labels[index] == IN_REGION:
            area, x, y = area + 1.0, x + index % cells, y + index // cells
    x, y = x / area, y / area
    for index in range(cells * cells):
        if labels[index] == IN_REGION:
            across, down = index % cells - x, index // cells - y
            xx, xy, yy = xx + across * across, xy + across * down, yy + down * down
    xx, xy, yy = xx / area, xy / area, yy / area
    apart = math.hypot(0.5 * (xx - yy), xy)
    least = max(0.5 * (xx + yy) - apart, 0.0)
    turn = 0.5 * math.atan2(2.0 * xy, xx - yy)
    along_x, along_y = math.cos(turn), math.sin(turn)
    root = 1.0 / 9.0 - math.pi * least / (3.0 * area)
    squared = 6.0 * area / math.pi * (1.0 / 3.0 - math.sqrt(max(root, 0.0)))
    size = max(min(math.sqrt(max(squared, 0.0)), math.sqrt(area / math.pi)), ROW)
    half = max(area - math.pi * size * size, 0.0) / (4.0 * size)
    both = either = 0.0
    for index in range(cells * cells):
        across, down = index % cells - x, index // cells - y
        along = min(max(across * along_x + down * along_y, -half), half)
        within = math.hypot(across - along * along_x, down - along * along_y) <= size
        both += within and labels[index] == IN_REGION
        either += within or labels[index] == IN_REGION
    memory.swept = both / either


@helper
def _share_at(image: Image, memory: Record, x: float, y: float) -> float:
    """Share of the target between four pixels."""
    left, top = math.floor(x), math.floor(y)
    u, v, share = x - left, y - top, 0.0
    for channel in range(image.shape[2]):
        upper = (1.0 - u) * _pixel(image, left, top, channel) + u * _pixel(image, left + 1.0, top, channel)
        lower = (1.0 - u) * _pixel(image, left, top + 1.0, channel) + u * _pixel(image, left + 1.0, top + 1.0, channel)
        share += (math.floor((1.0 - v) * upper + v * lower + 0.5) - memory.there[channel]) * memory.weights[channel]
    return share


@kernel(refcount=False, entry=False)
def _width_of_line(image: Image, memory: Record, turn: float) -> float:
    """Width of the rim along a line from the center, half-widths; 1 where it does not end, -1 where none is crossed."""
    limits, line, spacing = memory.limits, memory.line, (LAST_PLACE - FIRST_PLACE) / (PLACES - 1)
    end, across, down = 0, math.cos(turn), math.sin(turn)
    for place in range(PLACES):
        away = memory.half_width * (FIRST_PLACE + spacing * place)
        line[place] = _share_at(image, memory, memory.x + away * across, memory.y + away * down)
        if end == 0 and place > 0 and line[place] < limits.level:
            end = place
    if end == 0 or not line[0] > limits.level:
        return -1.0
    high, low = -1, PLACES
    for place in range(PLACES):
        if place < end and line[place] > limits.high:
            high = place
        if place > end and line[place] < limits.low and place < low:
            low = place
    return (low - high) * spacing if high >= 0 and low < PLACES else 1.0


@kernel(refcount=False, entry=False)
def _measure_rim(image: Image, memory: Record) -> None:
    """Write the width of the rim where it is sharper, in half-widths; 0 where few lines show one."""
    lines, count = int(memory.limits.lines), 0
    for k in range(lines):
        width = _width_of_line(image, memory, 2.0 * math.pi * k / lines)
        if width >= 0.0:
            memory.widths[count] = width
            count += 1
    memory.rim = quantile(memory.widths[:count], memory.limits.sharper) if 2 * count >= lines else 0.0


@kernel(refcount=False)
def find_region(image: Image, block: Block) -> bool:
    """Find the region of the target around the disc of a `REGION_MEMORY`, and measure it; False where there is none.

    Parameters
    ----------
    image : (h, w, channels), uint8
    block : float64, written
    """
    memory = block.view(REGION_MEMORY)[0]
    channels, limits = image.shape[2], memory.limits
    for _ in range(int(limits.rounds)):
        if not _read_window(image, memory) or not _discriminate(memory, channels) or not _find_main(memory, channels):
            return False
        x, y, size = memory.x, memory.y, memory.half_width
        _take_disc(memory)
        moved = math.hypot(memory.x - x, memory.y - y)
        if math.hypot(moved, memory.half_width - size) < limits.still * memory.step:
            break
    _measure_swept(memory)
    _measure_rim(image, memory)
    return True
