"""A second look: when the edge points of a fit hardly agree, try the shapes around it, or one drawn out.

A hand, a stripe or a dark background can pull a fit to a wrong shape that touches the right one on one side. So shapes
a little larger and a little smaller, moved to each of eight sides, are fitted too, and the one with the best evidence
stays.
"""

import math
from collections.abc import Iterator
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from matchset.shapes.shape import Shape
from matchset.tracking.matcher import Matcher
from matchset.tracking.memory import EVIDENCE, INSIDE, SURPRISE, USUAL

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]

LARGER, SMALLER = 0.15, -0.13  # changes of size that are tried, in half-widths
AIM = 1.0  # px: as exact a prediction may be
BETTER = 0.03  # by how much another shape must be better
DRAWN, SURELY = 0.15, 0.75  # by how much more evidence must speak for an outline drawn out, and at least how much
STRETCH = 0.01  # half-widths by which the modes must grow to be worth a look
ROUNDS = 4  # of reweighting
FARTHEST, ENOUGH = 0.4, 0.7  # half-widths up to which residuals count, and the share of the lines that must have one


def alternatives(matcher: Matcher[S]) -> Iterator[Floats]:
    """States around the matcher's, each to be fitted: larger and smaller on each of eight sides."""
    x, y = float(matcher.state[0]), float(matcher.state[1])
    size = matcher.size
    for change in (LARGER, SMALLER):
        for side in range(8):
            away = change * size
            turn = 0.25 * math.pi * side
            yield matcher.family.from_coarse(x + away * math.cos(turn), y + away * math.sin(turn), size + away).state


def worth(matcher: Matcher[S]) -> float:
    """How good a fit is beside others: evidence, inside of the right color, usual size, expected place."""
    usual = matcher.clock(USUAL)
    change = abs(math.log(matcher.size / usual)) if usual > 0.0 else 0.0
    x, y = matcher.state.item(0), matcher.state.item(1)
    far = math.hypot(x - matcher.parts.expected.item(0), y - matcher.parts.expected.item(1))
    change += max(far - 2.0 * matcher.clock(SURPRISE) - AIM, 0.0) / matcher.size
    return matcher.fit(EVIDENCE) + 0.3 * matcher.fit(INSIDE) - 0.5 * change


def drawn_out(matcher: Matcher[S]) -> Floats | None:
    """State with the modes that the residuals of a fit ask for; None where they ask for little.

    A fit from afar keeps the modes still, and may stay so on an outline that a lens draws far out of shape.
    """
    parts, p = matcher.parts, len(matcher.family.__struct_fields__)
    residuals, state = parts.found[:, 0], matcher.state.copy()
    near = np.abs(residuals) < FARTHEST * matcher.size
    if len(state) == p or np.count_nonzero(near) < ENOUGH * matcher.points:
        return None
    moves, residuals = parts.outline[near, 4 : 4 + len(state)], residuals[near]
    step: Floats = np.zeros(len(state))
    for _ in range(ROUNDS):
        weights = 1.0 / np.sqrt(np.maximum(np.abs(residuals - moves @ step), 1.0))  # of the absolute residual
        step[:] = np.linalg.lstsq(moves * weights[:, np.newaxis], residuals * weights, rcond=None)[0]
    state += step
    wanted, given = (float(np.hypot.reduce(each)) for each in (state[p:], matcher.state[p:]))
    return state if wanted > given + STRETCH * matcher.size else None
