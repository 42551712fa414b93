"""The compiled steps of a tracker, made for each family of shapes: `Steps`.

A frame in which all goes well takes one compiled call, `advance`: predict, trace the outline, match, fit, judge,
correct. Where anything is in doubt it hands over what it has, and Python goes on with the same pieces.
"""

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel
from matchset.tracking import motion
from matchset.tracking.memory import SEEN, SIZE, SPEED, SURPRISE, TIME, views
from matchset.tracking.parameters import LEAST_REACH, MOST_REACH, TRUST
from matchset.tracking.settle import make_settle
from matchset.tracking.verdict import DOUBTFUL, SURE, answer, following, is_doubtful, is_near, missing, take_in

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]
Answer = tuple[float, Floats, Floats]


class Steps(NamedTuple):
    """The compiled steps for one family; a block and n lines are the working memory, see `Views`.

    Attributes
    ----------
    settle : callable
        ``settle(image, table, block, runs, pixels, sums, free, reach, speed, sigma, least)``: fit near the state in
        the block, with the priors of the motion unless `free`; whether there are edge points to judge.
    advance : callable
        ``advance(image, table, block, runs, pixels, sums, time, interval)``: a whole frame; the verdict, and the
        answer where it is `SURE`.
    predict : callable
        ``predict(block, n, time, missed)``: see `motion.predict`.
    take_in, answer : callable
        ``take_in(block, n, time)`` and ``answer(block, n)``: see `verdict`.
    """

    settle: Callable[..., bool]
    advance: Callable[..., tuple[int, Answer]]
    predict: Callable[[Floats, int, float, float], None]
    take_in: Callable[[Floats, int, float], Answer]
    answer: Callable[[Floats, int], Answer]


@functools.cache
def steps(trace: Callable[..., Any], half_width: Callable[..., Any], s: int, p: int) -> Steps:
    """Make the steps of a family.

    Parameters
    ----------
    trace, half_width : callable
        Compiled, see `Shape`.
    s, p : int
        How many numbers its state has, and how many of them are its parameters.
    """
    settle = make_settle(trace, half_width, p)

    @kernel
    def predict(block: Floats, n: int, time: float, missed: float) -> None:
        parts = views(block, n, s, p)
        motion.predict(parts, time, missed, parts.track[TRUST])

    @kernel
    def take(block: Floats, n: int, time: float) -> Answer:
        return take_in(views(block, n, s, p), time)

    @kernel
    def tell(block: Floats, n: int) -> Answer:
        return answer(views(block, n, s, p))

    return Steps(_settle_block(settle, s, p), _advance(settle, half_width, s, p), predict, take, tell)


def _settle_block(settle: Callable[..., bool], s: int, p: int) -> Callable[..., bool]:
    """Make `Steps.settle`."""

    @kernel
    def settle_block(
        image: Bytes,
        table: Scores,
        block: Floats,
        runs: Ints,
        pixels: Bytes,
        sums: Singles,
        free: bool,
        reach: float,
        speed: float,
        sigma: float,
        least: float,
    ) -> bool:
        parts = views(block, runs.shape[0], s, p)
        spread = parts.free if free else parts.room
        return settle(image, table, parts, runs, pixels, sums, spread, reach, speed, sigma, least)

    return settle_block


def _advance(
    settle: Callable[..., bool], half_width: Callable[..., Any], s: int, p: int
) -> Callable[..., tuple[int, Answer]]:
    """Make `Steps.advance`."""

    @kernel
    def advance(
        image: Bytes, table: Scores, block: Floats, runs: Ints, pixels: Bytes, sums: Singles, time: float, passed: float
    ) -> tuple[int, Answer]:
        n = runs.shape[0]
        parts = views(block, n, s, p)
        clock, limits = parts.clock, parts.track
        if clock[TIME] == -math.inf:
            clock[TIME] = time - passed
        missed = max((time - clock[TIME]) / passed, 1.0)
        motion.predict(parts, time, missed, limits[TRUST])
        speed, surprise = passed * clock[SPEED], clock[SURPRISE] * missed
        reach = min(limits[LEAST_REACH] + 2.0 * surprise, limits[MOST_REACH])
        parts.state[:] = parts.expected
        if settle(image, table, parts, runs, pixels, sums, parts.room, reach, speed, max(surprise, 1.0), 0.0):
            verdict = following(parts.fit, parts.judge, n)
        else:
            verdict = missing(parts.fit[SEEN], n)
        if verdict == SURE:
            size = parts.fit[SIZE]
            near = is_near(parts.state, size, parts.expected, half_width(parts.expected), clock[SURPRISE])
            if is_doubtful(parts.fit, n) or not near:
                verdict = DOUBTFUL
        if verdict == SURE:
            return verdict, take_in(parts, time)
        return verdict, (0.0, np.empty((0, 2)), np.empty((0, 0)))

    return advance
