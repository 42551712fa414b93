"""A second look: when the edge points of a fit hardly agree, try the shapes around it, or one drawn out.

A hand, a stripe or a dark background can pull a fit to a wrong shape that touches the right one on one side. So shapes
a little larger and a little smaller, moved to each of eight sides, are fitted too, and the one with the best evidence
stays. A shape with sides may have lost one of them, so its sides are moved one by one.
"""

import math
from collections.abc import Iterator
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.shapes.shape import Shape
from matchset.tracking.matcher import Matcher
from matchset.tracking.memory import AGREEMENT, EVIDENCE, INSIDE, SURPRISE, USUAL

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Lines = npt.NDArray[np.bool_]

LARGER, SMALLER = 0.15, -0.13  # changes of size that are tried, in half-widths
AIM = 1.0  # px: as exact a prediction may be
# by how far both ends of a side are moved, in half-widths
SIDE_INWARD = (-0.2, -0.2), (-0.2, 0.0), (0.0, -0.2), (-0.4, -0.4)
SIDE_OUTWARD = (0.2, 0.2), (0.2, 0.0), (0.0, 0.2), (0.4, 0.4)
WORST = 2  # sides that are moved: those that least speaks for
BEYOND, LEAST_BEYOND = 0.1, 4.0  # half-widths, and px, beyond the outline where the target must not be
SPILL = 2.0  # evidence that is worth the share of the lines where it is
OFF = 3.0  # px from the outline from which an edge point does not speak for its side
APART, MOST_SIDES = 1e-6, 8  # squared difference of normals that parts two sides; most sides that are moved
BETTER = 0.03  # by how much another shape must be better
DRAWN, SURELY = 0.15, 0.75  # by how much more evidence must speak for an outline drawn out, and at least how much
STRETCH = 0.01  # half-widths by which the modes must grow to be worth a look
ROUNDS = 4  # of reweighting
FARTHEST, ENOUGH = 0.4, 0.7  # half-widths up to which residuals count, and the share of the lines that must have one


def alternatives(matcher: Matcher[S], image: Image, color: ColorModel) -> Iterator[Floats]:
    """States around the matcher's, each to be fitted: larger and smaller on each of eight sides, or of its own."""
    sides = _sides(matcher)
    if sides:
        yield from _moved_sides(matcher, sides, spilled(matcher, image, color))
        return
    x, y = float(matcher.state[0]), float(matcher.state[1])
    size, like = matcher.size, matcher.state.copy()
    for change in (LARGER, SMALLER):
        for side in range(8):
            away = change * size
            turn = 0.25 * math.pi * side
            place = x + away * math.cos(turn), y + away * math.sin(turn)
            yield matcher.family.from_coarse(*place, size + away, like).state


def _sides(matcher: Matcher[S]) -> list[Lines]:
    """Which lines cross which side of the outline; none where it has no sides, or they cannot move by themselves."""
    if not matcher.sides_move:
        return []
    normals = matcher.parts.outline[:, 2:4]
    first = np.flatnonzero(((normals - np.roll(normals, 1, axis=0)) ** 2).sum(axis=1) > APART)
    if not 3 <= len(first) <= MOST_SIDES:
        return []
    which = (np.searchsorted(first, np.arange(len(normals)), side="right") - 1) % len(first)
    return [which == k for k in range(len(first))]


def _moved_sides(matcher: Matcher[S], sides: list[Lines], spills: Lines) -> Iterator[Floats]:
    """States in which one of the sides that least speaks for is moved alone, at one end or both.

    Outward only where the target is seen beyond it.
    """
    parts, s = matcher.parts, len(matcher.state)
    moves, state, size = parts.outline[:, 4 : 4 + s].copy(), matcher.state.copy(), matcher.size
    speaks = _speaks(matcher)
    for side in sorted(sides, key=lambda each: float(speaks[each].mean()))[:WORST]:
        toward = np.linspace(0.0, 1.0, np.count_nonzero(side))
        ends = np.zeros((len(side), 2))
        ends[side] = np.column_stack((1.0 - toward, toward))
        steps = np.linalg.lstsq(moves, ends, rcond=None)[0]
        for change in SIDE_INWARD + (SIDE_OUTWARD if spills[side].any() or not matcher.knows_color else ()):
            yield state + size * steps @ np.array(change)


def _speaks(matcher: Matcher[S]) -> Floats:
    """How much each line speaks for the outline: near to it, and with a step in color, if there is a color."""
    parts = matcher.parts
    off = parts.found[:, 0] / OFF
    near = np.maximum(1.0 - off * off, 0.0)
    if matcher.knows_color:
        near *= parts.edges[np.arange(matcher.points), parts.found[:, 2].astype(np.intp), 2]
    return np.asarray(near)


def spilled(matcher: Matcher[S], image: Image, color: ColorModel) -> Lines:
    """Which lines show the target beyond the outline: what stands before it hides it, and never adds to it."""
    outline = matcher.parts.outline
    beyond = max(BEYOND * matcher.size, LEAST_BEYOND)
    columns, rows = np.rint(outline[:, :2] + beyond * outline[:, 2:4]).astype(np.intp).T
    seen = (columns >= 0) & (columns < image.shape[1]) & (rows >= 0) & (rows < image.shape[0])
    seen[seen] = color.scores(image[rows[seen], columns[seen]]).ravel() > 0
    return np.asarray(seen)


def worth(matcher: Matcher[S], image: Image, color: ColorModel) -> float:
    """How good a fit is beside others: evidence, inside of the right color, usual size, expected place.

    Where sides move alone, only edge points with a step in color count, and what the outline leaves out counts against
    it: any straight edge of the background may pass for a side.
    """
    usual = matcher.clock(USUAL)
    change = abs(math.log(matcher.size / usual)) if usual > 0.0 else 0.0
    x, y = matcher.state.item(0), matcher.state.item(1)
    far = math.hypot(x - matcher.parts.expected.item(0), y - matcher.parts.expected.item(1))
    change += max(far - 2.0 * matcher.clock(SURPRISE) - AIM, 0.0) / matcher.size
    evidence = matcher.fit(EVIDENCE) if matcher.knows_color else matcher.fit(AGREEMENT)
    if matcher.sides_move and matcher.knows_color:
        evidence += evidence - matcher.fit(AGREEMENT) - SPILL * float(spilled(matcher, image, color).mean())
    return evidence + 0.3 * matcher.fit(INSIDE) - 0.5 * change


def drawn_out(matcher: Matcher[S]) -> Floats | None:
    """State with the modes that the residuals of a fit ask for; None where they ask for little.

    A fit from afar keeps the modes still, and may stay so on an outline that a lens draws far out of shape.
    """
    parts, p = matcher.parts, len(matcher.family.parameters)
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
