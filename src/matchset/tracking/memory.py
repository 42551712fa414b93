"""The working memory of a tracker: what its compiled steps and Python look into.

A compiled call costs by the array it is handed, and most when the caches are cold. So all short vectors lie in one
block, and `views` cuts it into the same named arrays here and there.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import inlined, plain
from matchset.tracking.fit import scratch_size
from matchset.tracking.match_set import CANDIDATES, LONGEST, SUMS

Floats = npt.NDArray[np.float64]

FITS, CLOCKS, LOOKS, LIMITS = 16, 6, 4, 32  # numbers of a fit, the motion, a look, and each kind of parameters

# places in `Views.fit`: what the last look at the shape found
NOISE, GRAIN, SEEN, CONFIRMED, AGREEMENT, EVIDENCE, WAVE, CORNERS, INSIDE, CORE, HOLLOW, SIZE, BENT = range(13)
# and after them how far the odd rows' field lies from the even rows': x, y, px
FIELDS = 13

# places in `Views.clock`: when the shape was last seen, s; its speed, px/s; by how much predictions lately missed, px;
# its half-width over the last well-confirmed frames, px; and over the last frames the sums of the way from frame to
# frame times the distance between the fields along it, and of that way squared, px^2
TIME, SPEED, SURPRISE, USUAL, SHEARED, MOVED = range(6)

STEADY = LIMITS - 1  # place in `Views.track`: from which number on a state changes slowly, see `shapes.shape.steady`
START = 7  # place in `Views.match`: noise with which a fit begins at least, px

# places in `Views.look`: how far to look for a shape, see `Look`
REACH, RATE, SIGMA, LEAST = range(4)


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
        `MatchParameters`, `JudgeParameters` and `TrackerParameters`, in the order of their fields.
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
    scratch: Floats


@inlined
def views(
    block: Floats, outline: Floats, edges: Floats, starts: Floats, found: Floats, rays: Floats, covariance: Floats
) -> Views:
    """Cut a block into its parts, and join them with the tables of the lines."""
    p = covariance.shape[0]
    s = outline.shape[1] - 6
    a, b = 5 * s, 5 * s + 3 * p
    c = b + FITS
    e = c + CLOCKS
    d = e + LOOKS
    return Views(
        outline,
        edges,
        starts,
        found,
        rays,
        covariance,
        block[:s],
        block[s : 2 * s],
        block[2 * s : 3 * s],
        block[3 * s : 4 * s],
        block[4 * s : a],
        block[a : a + p],
        block[a + p : a + 2 * p],
        block[a + 2 * p : b],
        block[b:c],
        block[c:e],
        block[e:d],
        block[d : d + LIMITS],
        block[d + LIMITS : d + 2 * LIMITS],
        block[d + 2 * LIMITS : d + 3 * LIMITS],
        block[d + 3 * LIMITS :],
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
    tables : tuple of ndarrays
        Outline, edges, starts, found, rays and covariance of `Views`.
    parts : Views
        Of both.
    runs : ndarray of shape (n, 5), int64
        Where each line runs: 1 along a row or 0 along a column, which one, first pixel, step, number of pixels; the
        last is 0 where the picture does not reach `margin` pixels beyond the outline on both sides.
    pixels : ndarray of shape (n, LONGEST, 3), uint8
    sums : ndarray of shape (SUMS,), float32
        What `match_lines` reads and adds up.
    """

    def __init__(self, n: int, states: int, count: int, width: int = 2) -> None:
        named = 5 * states + 3 * count + FITS + CLOCKS + LOOKS + 3 * LIMITS
        self.block = np.zeros(named + scratch_size(n, states))
        self.tables = (
            np.zeros((n, states + 6)),
            np.zeros((n, CANDIDATES, 3)),
            np.zeros((n, 2)),
            np.zeros((n, 3)),
            np.zeros((n, width + 1)),
            np.zeros((count, states + 2)),
        )
        self.parts = plain(views)(self.block, *self.tables)
        self.runs = np.zeros((n, 5), np.int64)
        self.pixels = np.zeros((n, LONGEST, 3), np.uint8)
        self.sums = np.zeros(SUMS, np.float32)
