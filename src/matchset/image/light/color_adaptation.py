"""How a color follows the light: a little learning on every well-fitted frame.

The log-odds L of the color cell of a pixel inside the outline moves up by ``rate * (1 - s(L))``, of one outside down by
``rate * s(L)``, with the softsign ``s(L) = 1/2 + L / (2 (1 + |L|))`` in place of the logistic function: online
regression that moves a cell less the better it already tells target from background. Cells next to it in color move by
half as much. No cell may leave its first value by more than `AdaptationParameters.max_drift`, and a pixel inside that
looks clearly foreign teaches nothing: it is a finger, a stick or a marker. What is not seen again is forgotten: each
cell goes back toward its first value by a little, all of them once in `AdaptationParameters.sweep` looks. So a color
hangs on the last looks alone, 120 of them by default, and a tracker that began later comes to the same one.
"""

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image import color
from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, Record, fields, new_block, record_dtype, store

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]
Table = npt.NDArray[np.int8]

SHIFT = (
    1 << 24
)  # geometry: px, more than any picture has, so that a place before its border is positive when it is rounded
ROUND = SHIFT + 0.5  # theorem: floor(x + 1/2) by cutting off the decimals of a positive number
LIMIT, WHITE = np.float32(color.LIMIT), np.float32(color.WHITE)


class AdaptationParameters(msgspec.Struct, frozen=True):
    """How the color of a tracker follows the light.

    All numbers chosen by hand; `tests/tracking/test_tracker.py` (a fading ball, a stick before it) and `python -m
    benchmarks --only accuracy` would show a change.

    Parameters
    ----------
    rate : float
        Speed at which the color follows the light, log-odds per look: 0 keeps the color as it was learned.
    min_support, min_interior : float
        Least share of the outline that must be inliers, and of the inside that must have the target's color, before a
        frame may change the color; the whole outline must be in the picture.
    period : int
        Every so many frames the color may change: light changes slowly.
    max_drift : float
        Largest change of a cell's log-odds from what was learned at first. More follows larger changes of the light,
        and lets a wrong shape teach a wrong color.
    foreign_below : float
        Log-odds below which a pixel inside is something in front of the target, and teaches nothing: higher keeps more
        of what is in front out, and follows sudden changes of the light less.
    sure_beyond : float
        Log-odds beyond which a cell is not moved further: more makes the color surer, and slower to turn.
    looks : int
        Outline points that a frame teaches from, at most, but for what division leaves: with many lines across the
        outline the color would follow them faster than the light changes. A quarter of the default of `Tracker`.
    outside_px : float
        Distance from the outline at which the background is read, px: beyond the blur of an edge, and near enough to be
        what the edge is seen against.
    forget : float
        Log-odds by which a cell goes back toward its first value in a sweep. More: what was taught wrongly is gone
        earlier, and a tracker that began later has the same color earlier; colors of a light that comes and goes are
        learned more often. 0: nothing is forgotten.
    sweep : int
        Looks in which each cell has gone back once. More: forgets more slowly, at less cost for a look.
    """

    rate: float = 0.8
    min_support: float = 0.8
    min_interior: float = 0.6
    period: int = 3
    max_drift: float = 3.0
    foreign_below: float = -0.5
    sure_beyond: float = 2.5
    looks: int = 16
    outside_px: float = 6.0
    forget: float = 0.5
    sweep: int = 20


_LIMITS = record_dtype(AdaptationParameters)


def adaptation_block(parameters: AdaptationParameters) -> Block:
    """Write parameters to a block of floats, as `adapt_table` reads them."""
    block = new_block(_LIMITS)
    store(fields(block, _LIMITS), parameters)
    return block


@kernel(refcount=False, entry=False)
def cell_at(image: Bytes, x: float, y: float) -> np.int64 | int:
    """Color cell of the pixel at (x, y), or -1 outside the picture."""
    column, row = int(x + ROUND) - SHIFT, int(y + ROUND) - SHIFT
    if row < 0 or column < 0 or row >= image.shape[0] or column >= image.shape[1]:
        return -1
    if image.shape[2] == 1:
        return np.int64(image[row, column, 0])
    b, g, r = (
        np.int64(image[row, column, 0]),
        np.int64(image[row, column, 1]),
        np.int64(image[row, column, 2]),
    )
    return (b >> 3) << 10 | (g >> 3) << 5 | r >> 3


@kernel(refcount=False, entry=False)
def _nudge(
    cell: np.int64 | int, amount: np.float32, log_odds: Singles, first: Singles, table: Table, drift: np.float32
) -> None:
    """Move one cell, toward target for a positive amount, toward background for a negative one, but not too far."""
    old = log_odds[cell]
    belief = np.float32(0.5) + np.float32(0.5) * old / (np.float32(1.0) + abs(old))
    new = old + amount * (np.float32(1.0) - belief if amount > 0 else belief)
    new = min(max(new, first[cell] - drift, -LIMIT), first[cell] + drift, LIMIT)
    _write(cell, new, log_odds, table)


@kernel(refcount=False, entry=False)
def _write(cell: np.int64 | int, value: np.float32, log_odds: Singles, table: Table) -> None:
    """Give a cell other log-odds."""
    log_odds[cell] = value
    half = np.float32(0.5) * value
    table[cell] = np.int8(np.rint(WHITE * np.tanh(half)))


@kernel(refcount=False, entry=False)
def _forget(log_odds: Singles, first: Singles, table: Table, look: int, limits: Record) -> None:
    """Let the cells whose turn it is go back toward what was learned first."""
    step, sweep = np.float32(limits.forget), max(int(limits.sweep), 1)
    size = (log_odds.size + sweep - 1) // sweep
    begin = look % sweep * size
    for cell in range(begin, min(begin + size, log_odds.size)):
        apart = log_odds[cell] - first[cell]
        if apart != np.float32(0.0):
            _write(cell, first[cell] + max(abs(apart) - step, np.float32(0.0)) * np.sign(apart), log_odds, table)


@kernel(refcount=False, entry=False)
def _teach(
    cell: np.int64 | int, amount: np.float32, log_odds: Singles, first: Singles, table: Table, limits: Record
) -> None:
    """Move a cell that is not sure yet and, half as much, its neighbors in color."""
    if log_odds[cell] * (1.0 if amount > 0.0 else -1.0) > limits.sure_beyond:
        return
    drift = np.float32(limits.max_drift)
    _nudge(cell, amount, log_odds, first, table, drift)
    half = np.float32(0.5) * amount
    shift = 1
    while shift < log_odds.size:
        place = (cell // shift) & 31 if log_odds.size > 256 else cell
        if place > 0:
            _nudge(cell - shift, half, log_odds, first, table, drift)
        if place < (31 if log_odds.size > 256 else 255):
            _nudge(cell + shift, half, log_odds, first, table, drift)
        shift = shift * 32 if log_odds.size > 256 else log_odds.size


@kernel(refcount=False)
def adapt_table(
    image: Bytes,
    log_odds: Singles,
    first: Singles,
    table: Table,
    points: Floats,
    shares: Floats,
    x: float,
    y: float,
    look: int,
    parameters: Block,
) -> None:
    """Learn from a few outline points, with few lines from every fourth: one pixel inside, one outside.

    Ten parameters, because a tuple or record of arrays that comes from Python costs several microseconds a call
    (decision 013), and this is called while a frame is answered.

    Parameters
    ----------
    image, points, shares, x, y
        The picture; outline points, (n, >= 2), px; for each a share of the way from the center (x, y) to it.
    log_odds, first : (32768,) or (256,) float32
        The log-odds, written, and what they were at first.
    table : the same shape, int8, written
    look : int
        Number of this look: which quarter of the points takes part, and which cells forget.
    parameters : (n,) float64
        `adaptation_block`; `rate` and what follows `period` are read.
    """
    limits = parameters.view(_LIMITS)[0]
    rate = np.float32(limits.rate)
    if limits.forget > 0.0:
        _forget(log_odds, first, table, look, limits)
    step = max(points.shape[0] // limits.looks, 4)
    for i in range(look % 4 * step // 4, points.shape[0], step):
        dx, dy = points[i, 0] - x, points[i, 1] - y
        cell = cell_at(image, x + shares[i] * dx, y + shares[i] * dy)
        if cell >= 0 and log_odds[cell] > limits.foreign_below:
            _teach(cell, rate, log_odds, first, table, limits)
        beyond = 1.0 + limits.outside_px / max(np.sqrt(dx * dx + dy * dy), 1.0)
        cell = cell_at(image, x + beyond * dx, y + beyond * dy)
        if cell >= 0:
            _teach(cell, -rate, log_odds, first, table, limits)
