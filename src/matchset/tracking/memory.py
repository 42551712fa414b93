"""The working memory of a tracker: what its compiled steps and Python look into.

A compiled call costs by the array it is handed, and most when the caches are cold. So all lies in one block, and
`views` cuts it into the same named arrays here and there.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import cut, inlined, plain
from matchset.tracking.fit import scratch_size
from matchset.tracking.match_set import CANDIDATES, LONGEST, SUMS

Floats = npt.NDArray[np.float64]

# numbers of the sizes, a fit, the motion, a look, and each kind of parameters
HEAD, FITS, CLOCKS, LOOKS, LIMITS = 4, 18, 6, 5, 32

# places in `Views.fit`: what the last look at the shape found
NOISE, GRAIN, SEEN, CONFIRMED, AGREEMENT, EVIDENCE, WAVE, CORNERS, INSIDE, CORE, HOLLOW, SIZE, BENT = range(13)
# and after them how far the even rows' field lies from the odd rows', x, y, px; how far it is expected to, and what the
# standard deviation of that is for a noise of 1 px
FIELDS, EXPECTED, APART = 13, 15, 17

# places in `Views.clock`: when the shape was last seen, s; its speed, px/s; by how much predictions lately missed, px;
# its half-width over the last well-confirmed frames, px; and over the last frames the sums of the speed times the
# distance between the fields along it, px^2/s, and of the speed squared
TIME, SPEED, SURPRISE, USUAL, SHEARED, MOVED = range(6)

STEADY = LIMITS - 1  # place in `Views.track`: from which number on a state changes slowly, see `shapes.shape.steady`
START = 7  # place in `Views.match`: noise with which a fit begins at least, px

# places in `Views.look`: how far to look for a shape, see `Look`
REACH, RATE, SIGMA, LEAST, BLIND = range(5)


class Views(NamedTuple):
    """The parts of a memory, for n lines, a state of s numbers and p parameters.

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
    rays : (n, >= 3)
        The place of each line on the outline, see `shapes.shape.places`: cosine and sine of its angle first; in the
        last column a share of the way from the center to the outline where the inside is looked at.
    covariance : (p, s + 2)
    state, begin : (s,)
        Where the fit is, and where it began.
    seen, velocity, expected : (s,)
        Motion: the state last seen, its change per second, and the prediction.
    spread, room, free : (p,)
        By how much predictions have lately missed, how far from them each parameter may be, and zeros.
    fit, clock, look : (FITS,), (CLOCKS,), (LOOKS,)
        See the names of their places above.
    match, judge, track : (LIMITS,)
        `MatchParameters`, `ValidationParameters` and `TrackerParameters`, in the order of their fields.
    runs : (n, 5) int64
        Where each line runs: 1 along a row or 0 along a column, which one, first pixel, step, number of pixels; the
        last is 0 where the picture does not reach `margin` pixels beyond the outline on both sides.
    sums, pixels : (SUMS,) float32, (n * LONGEST * 3,) uint8
        What `match_lines` adds up and reads, one line's pixels behind the other's.
    scratch : (scratch_size(n, s),)
        Working memory of a fit.
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
    look: Floats
    match: Floats
    judge: Floats
    track: Floats
    runs: npt.NDArray[np.int64]
    sums: npt.NDArray[np.float32]
    pixels: npt.NDArray[np.uint8]
    scratch: Floats


@inlined
def views(block: Floats) -> Views:
    """Cut a block into its parts."""
    n, s, p, width = int(block[0]), int(block[1]), int(block[2]), int(block[3])
    a = HEAD + 5 * s
    b = a + 3 * p
    c = b + FITS
    e = c + CLOCKS
    d = e + LOOKS
    tables = d + 3 * LIMITS
    edges = tables + n * (s + 6)
    starts = edges + n * CANDIDATES * 3
    rays = starts + n * 5
    covariance = rays + n * width
    runs = covariance + p * (s + 2)
    sums = runs + n * 5
    pixels = sums + SUMS // 2
    scratch = pixels + n * LONGEST * 3 // 8
    return Views(
        cut(block, tables, (n, s + 6)),
        cut(block, edges, (n, CANDIDATES, 3)),
        cut(block, starts, (n, 2)),
        cut(block, starts + 2 * n, (n, 3)),
        cut(block, rays, (n, width)),
        cut(block, covariance, (p, s + 2)),
        block[HEAD : HEAD + s],
        block[HEAD + s : HEAD + 2 * s],
        block[HEAD + 2 * s : HEAD + 3 * s],
        block[HEAD + 3 * s : HEAD + 4 * s],
        block[HEAD + 4 * s : a],
        block[a : a + p],
        block[a + p : a + 2 * p],
        block[a + 2 * p : b],
        block[b:c],
        block[c:e],
        block[e:d],
        block[d : d + LIMITS],
        block[d + LIMITS : d + 2 * LIMITS],
        block[d + 2 * LIMITS : tables],
        cut(block[runs:sums].view(np.int64), 0, (n, 5)),
        block[sums:pixels].view(np.float32),
        block[pixels:scratch].view(np.uint8),
        block[scratch:],
    )


class Memory:
    """Working memory for n lines, made once per tracker.

    Parameters
    ----------
    n : int
        Number of lines.
    states, count : int
        How many numbers the state of the shape has, and how many of them are its parameters.
    width : int
        How many numbers tell of a line's place.

    Attributes
    ----------
    block : ndarray, float64
        All of it, and first how many lines, numbers of the state, parameters and numbers of a line's place there are.
    parts : Views
        What lies where.
    """

    def __init__(self, n: int, states: int, count: int, width: int = 2) -> None:
        named = HEAD + 5 * states + 3 * count + FITS + CLOCKS + LOOKS + 3 * LIMITS
        tables = n * (states + 6 + CANDIDATES * 3 + 5 + width + 1 + 5) + count * (states + 2)
        pixels = n * LONGEST * 3 // 8
        self.block = np.zeros(named + tables + scratch_size(n, states) + SUMS // 2 + pixels)
        self.block[:HEAD] = n, states, count, width + 1
        self.parts = plain(views)(self.block)
