"""The compiled step of a tracker, made for each family of shapes.

A frame in which all goes well takes one compiled call: predict, trace the outline, match, fit, judge,
correct. Where anything is in doubt it hands over what it has, and Python goes on with the same pieces.
"""

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import inlined, kernel
from matchset.tracking import motion
from matchset.tracking.memory import (
    BLIND,
    LEAST,
    RATE,
    REACH,
    SEEN,
    SIGMA,
    SIZE,
    SPEED,
    START,
    SURPRISE,
    TIME,
    Views,
    views,
)
from matchset.tracking.palette import teach
from matchset.tracking.parameters import LEAST_REACH, MOST_REACH, TRUST
from matchset.tracking.settle import make_settle
from matchset.tracking.verdict import DOUBTFUL, SURE, answer, following, is_doubtful, is_near, missing, take_in

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]
Singles = npt.NDArray[np.float32]
Answer = tuple[int, float, int]

# what a step does: follow into a frame; fit near a state; the same with the priors of the motion; take in what was
# fitted; tell it; learn the color from it
WAYS = FOLLOW, FREE, HELD, TAKE_IN, TELL, LEARN = range(6)
NEVER = -1  # turn in which no color is learned


@functools.cache
def make_step(trace: Callable[..., Any], half_width: Callable[..., Any]) -> Callable[..., Answer]:
    """Make the step of a family.

    Parameters
    ----------
    trace, half_width : callable
        Compiled, see `Shape`.

    Returns
    -------
    callable
        ``step(image, table, log_odds, first, points, wide, block, way, time, passed, turn)``, with the block of a
        `Memory`: goes one of the `WAYS`, and returns the verdict and, where a shape is taken in or told, its support
        and the size of its match-set, which is in ``points`` then, and the covariance in ``wide``. A shape that is
        followed teaches the color, see `teach`.
    """
    follow = _make_follow(make_settle(trace, half_width), half_width)

    @kernel(refcount=False)
    def step(
        image: Bytes,
        table: Scores,
        log_odds: Singles,
        first: Singles,
        points: Floats,
        wide: Floats,
        block: Floats,
        way: int,
        time: float,
        passed: float,
        turn: int,
    ) -> Answer:
        parts = views(block)
        verdict, support, count = SURE, 0.0, 0
        if way <= HELD:
            verdict = follow(image, table, parts, way, time, passed)
        if verdict != SURE or way in (FREE, HELD):
            return verdict, support, count
        if way in (FOLLOW, TAKE_IN):
            take_in(parts, time)
        if way != LEARN:
            support, count = answer(parts, points, wide)
        if turn != NEVER:
            teach(image, table, log_odds, first, parts, turn)
        return verdict, support, count

    return step


def _make_follow(settle: Callable[..., bool], half_width: Callable[..., Any]) -> Callable[..., int]:
    """Compile one look at a frame, for a family of shapes."""

    @inlined
    def follow(
        image: Bytes,
        table: Scores,
        parts: Views,
        way: int,
        time: float,
        passed: float,
    ) -> int:
        n, clock, limits, ask = parts.runs.shape[0], parts.clock, parts.track, parts.look
        spread = parts.free if way == FREE else parts.room
        if way == FOLLOW:
            if clock[TIME] == -math.inf:
                clock[TIME] = time - passed
            missed = max((time - clock[TIME]) / passed, 1.0)
            motion.predict(parts, time, missed, limits[TRUST])
            surprise = clock[SURPRISE] * missed
            ask[REACH] = min(limits[LEAST_REACH] + 2.0 * surprise, limits[MOST_REACH])
            ask[RATE], ask[SIGMA], ask[LEAST] = passed * clock[SPEED], max(surprise, parts.match[START]), 0.0
            ask[BLIND] = 0.0
            for k in range(parts.state.shape[0]):  # a loop compiles in a tenth of the time of `[:] =`
                parts.state[k] = parts.expected[k]
        if not settle(image, table, parts, spread):
            return missing(parts.fit[SEEN], n)
        if way != FOLLOW:
            return SURE
        verdict = following(parts.fit, parts.judge, n)
        if verdict == SURE:
            size = parts.fit[SIZE]
            near = is_near(parts.state, size, parts.expected, half_width(parts.expected), clock[SURPRISE])
            if is_doubtful(parts.fit, parts.judge, n) or not near:
                verdict = DOUBTFUL
        return verdict

    return follow
