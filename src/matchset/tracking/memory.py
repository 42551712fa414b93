"""The working memory of a tracker: one block of numbers that its compiled steps and Python look into.

A compiled call costs by the array it is handed, and most when the caches are cold. So all that a step reads and
writes lies in one block, and `views` cuts it into the same named arrays here and there.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel
from matchset.tracking.match_set import CANDIDATES, LONGEST, SUMS

Floats = npt.NDArray[np.float64]

FITS, CLOCKS, LIMITS = 16, 8, 32  # numbers kept of a fit, of the motion, and of each kind of parameters

# places in `Views.fit`: what the last look at the shape found
NOISE, GRAIN, SEEN, CONFIRMED, AGREEMENT, EVIDENCE, WAVE, CORNERS, INSIDE, CORE, HOLLOW, SIZE, BENT = range(13)

# places in `Views.clock`: when the shape was last seen, s; its speed, px/s; by how much predictions lately missed, px;
# and its half-width over the last well-confirmed frames, px
TIME, SPEED, SURPRISE, USUAL = range(4)


class Views(NamedTuple):
    """The parts of a block, for n lines, a state of s numbers and p parameters.

    Attributes
    ----------
    outline : (n, 4 + s + 2)
        Where each line crosses the outline: x, y, px, the outward unit normal, and by how much the outline moves along
        it per unit of each number of the state, and of the distance between the fields.
    edges : (n, 3, 3)
        Edge points of each line, strongest first: offset along the outward normal, px; strength, 0 where there is
        none; step in color, as a share of a full one.
    starts : (n, 2)
        Offset of the first pixel of each line, and offset per pixel, px.
    found : (n, 3)
        What the fit took on each line, see `fit_lines`.
    rays : (n, 3)
        Cosine and sine of the angle of each line around the shape, and a share of the way from the center to the
        outline where the inside is looked at.
    covariance : (p, s + 2)
    state, begin : (s,)
        Where the fit is, and where it began.
    seen, velocity, expected : (s,)
        Motion: the state last seen, its change per second, and the prediction.
    spread, room, free : (p,)
        By how much predictions have lately missed, how far from them each parameter may be, and zeros.
    fit, clock : (FITS,), (CLOCKS,)
        See the names of their places above.
    match, judge, track : (LIMITS,)
        `MatchParameters`, `JudgeParameters` and `TrackerParameters`, in the order of their fields.
    """

    outline: Floats
    edges: Floats
    starts: Floats
    found: Floats
    rays: Floats
    covariance: Floats
    state: Floats
    begin: Floats
    seen: Floats
    velocity: Floats
    expected: Floats
    spread: Floats
    room: Floats
    free: Floats
    fit: Floats
    clock: Floats
    match: Floats
    judge: Floats
    track: Floats


@kernel
def views(block: Floats, n: int, s: int, p: int) -> Views:
    """Cut a block into its parts."""
    wide = s + 6
    a = n * wide
    b = a + 3 * CANDIDATES * n
    c = b + 2 * n
    d = c + 3 * n
    e = d + 3 * n
    f = e + p * (s + 2)
    g = f + 5 * s
    h = g + 3 * p
    k = h + FITS + CLOCKS
    return Views(
        block[:a].reshape((n, wide)),
        block[a:b].reshape((n, CANDIDATES, 3)),
        block[b:c].reshape((n, 2)),
        block[c:d].reshape((n, 3)),
        block[d:e].reshape((n, 3)),
        block[e:f].reshape((p, s + 2)),
        block[f : f + s],
        block[f + s : f + 2 * s],
        block[f + 2 * s : f + 3 * s],
        block[f + 3 * s : f + 4 * s],
        block[f + 4 * s : g],
        block[g : g + p],
        block[g + p : g + 2 * p],
        block[g + 2 * p : h],
        block[h : h + FITS],
        block[h + FITS : k],
        block[k : k + LIMITS],
        block[k + LIMITS : k + 2 * LIMITS],
        block[k + 2 * LIMITS : k + 3 * LIMITS],
    )


class Memory:
    """Working memory for n lines, made once per tracker.

    Parameters
    ----------
    n : int
        Number of lines.
    states, count : int
        How many numbers the state of the shape has, and how many of them are its parameters.

    Attributes
    ----------
    block : ndarray, float64
    parts : Views
        Of the block.
    runs : ndarray of shape (n, 5), int64
        Where each line runs: 1 along a row or 0 along a column, which one, first pixel, step, number of pixels; the
        last is 0 where the picture does not reach `margin` pixels beyond the outline on both sides.
    pixels : ndarray of shape (n, LONGEST, 3), uint8
    sums : ndarray of shape (SUMS,), float32
        What `match_lines` reads and adds up.
    """

    def __init__(self, n: int, states: int, count: int) -> None:
        lines = n * (states + 6 + 3 * CANDIDATES + 2 + 3 + 3)
        rest = count * (states + 2) + 5 * states + 3 * count + FITS + CLOCKS + 3 * LIMITS
        self.block = np.zeros(lines + rest)
        cut = getattr(views, "py_func", views)
        self.parts: Views = cut(self.block, n, states, count)
        self.runs = np.zeros((n, 5), np.int64)
        self.pixels = np.zeros((n, LONGEST, 3), np.uint8)
        self.sums = np.zeros(SUMS, np.float32)
