"""Other hypotheses where a fit is ambiguous: the shapes around it, or its outline with larger modes.

A hand, a stripe or a dark background can pull a fit to a wrong shape that touches the right one on one side. So shapes
a little larger and a little smaller, moved to each of eight sides, are fitted too, and the one with the best score
stays. A shape with sides may have lost one of them, so its sides are moved one by one.
"""

import math
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.evidence import find_color_boundary, pixels_along
from matchset.fitting.fitter import Estimate, Fitter
from matchset.image.color import ColorModel

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Lines = npt.NDArray[np.bool_]
Ends = tuple[tuple[float, float], ...]

MAX_SIDES = 8  # format: most sides that are moved one by one
SAME_NORMAL = 1e-6  # theorem: squared difference of unit normals; of those of one straight side it is rounding alone


class HypothesisParameters(msgspec.Struct, frozen=True):
    """Which other hypotheses are tested, and how they are scored.

    `larger`, `smaller`, `better`, `mode_gain`, `mode_score`, `interior_weight`, `change_weight` and `prediction_px`:
    fitted again by `make hypotheses`; no other value was better by 1 % on both sets of seeds
    (docs/log/fitting.md#hypothesis-weights). Where nothing
    else is said, the others were chosen by hand; `python -m benchmarks --only false_locks` would show a change.

    Parameters
    ----------
    period : int
        Every so many frames a shape that is confirmed and ambiguous is tested, where the family begins at regions;
        circles always are. More frequent costs time.
    larger, smaller : float
        Changes of size that are tried, in half-widths.
    directions : int
        In how many directions outlines that keep the other side are tried, of each of these sizes.
    side_inward, side_outward : tuple of pairs
        By how far both ends of a side are moved, in half-widths. See docs/decisions/073-sides-that-move-alone.md.
    sides : int
        How many sides are moved: those with the least scores.
    side_tolerance : float
        Distance from the outline from which an edge point does not speak for its side, px.
    beyond, beyond_px : float
        How far beyond the outline the target must not be, in half-widths, and at least so many px.
    alike : float
        Difference of a pixel beyond from one within up to which it may be the target, as a share of the brighter one's
        distance from black. Chosen on rectangles and quadrilaterals with a third hidden, seeds 201-204
        (docs/log/fitting.md#sides-under-fingers).
    outside_penalty : float
        Score that is lost per share of the lines where the target is beyond the outline.
    better : float
        By how much another hypothesis must score better.
    mode_gain, mode_score : float
        By how much more color score larger modes must have, and at least how much.
    mode_stretch : float
        By how much the modes must grow to be tried, in half-widths.
    mode_rounds : int
        Rounds of reweighting in which they are estimated.
    mode_range, mode_lines : float
        Half-widths up to which residuals count for that, and the share of the lines that must have one.
    interior_weight : float
        Weight of the share of the inside, ...
    change_weight : float
        ... and of the change of size and place against what is usual and expected.
    prediction_px : float
        As exact a prediction may be, px.
    range_px, initial_sigma : float
        Search range of a hypothesis and how far edge points are expected, px.
    final_range, final_sigma : float
        The same of the last fit, of the best one.
    """

    period: int = 3
    larger: float = 0.15
    smaller: float = -0.13
    directions: int = 8
    side_inward: Ends = ((-0.2, -0.2), (-0.2, 0.0), (0.0, -0.2), (-0.4, -0.4))
    side_outward: Ends = ((0.2, 0.2), (0.2, 0.0), (0.0, 0.2), (0.4, 0.4))
    sides: int = 2
    side_tolerance: float = 3.0
    beyond: float = 0.1
    beyond_px: float = 4.0
    alike: float = 0.5
    outside_penalty: float = 2.0
    better: float = 0.03
    mode_gain: float = 0.15
    mode_score: float = 0.75
    mode_stretch: float = 0.01
    mode_rounds: int = 4
    mode_range: float = 0.4
    mode_lines: float = 0.7
    interior_weight: float = 0.3
    change_weight: float = 0.5
    prediction_px: float = 1.0
    range_px: float = 5.0
    initial_sigma: float = 2.0
    final_range: float = 3.0
    final_sigma: float = 1.0


class Hypotheses:
    """Makes and scores the hypotheses around the last fit of a fitter.

    Parameters
    ----------
    fitter : Fitter
    limits : HypothesisParameters
    """

    def __init__(self, fitter: Fitter[Any], limits: HypothesisParameters) -> None:
        self.fitter, self.limits = fitter, limits

    def around(self, estimate: Estimate, image: Image, color: ColorModel) -> Iterator[Floats]:
        """States around the last fit, each to be fitted: larger and smaller on several sides, or a side moved alone."""
        sides = self._sides()
        if sides:
            yield from self._moved_sides(estimate, sides, self._target_outside(estimate, image, color))
            return
        x, y = float(estimate.state[0]), float(estimate.state[1])
        size = estimate.fit.half_width
        for change in (self.limits.larger, self.limits.smaller):
            for side in range(self.limits.directions):
                away = change * size
                turn = 2.0 * math.pi * side / self.limits.directions
                place = x + away * math.cos(turn), y + away * math.sin(turn)
                yield self.fitter.family.from_coarse(*place, size + away, estimate.state).state

    def _sides(self) -> list[Lines]:
        """Which lines cross which side of the outline; none where it has no sides, or they cannot move alone."""
        if not self.fitter.sides_move:
            return []
        normals = self.fitter.work.outline[: self.fitter.points, 2:4]
        first = np.flatnonzero(((normals - np.roll(normals, 1, axis=0)) ** 2).sum(axis=1) > SAME_NORMAL)
        if not 3 <= len(first) <= MAX_SIDES:
            return []
        which = (np.searchsorted(first, np.arange(len(normals)), side="right") - 1) % len(first)
        return [which == k for k in range(len(first))]

    def _moved_sides(self, estimate: Estimate, sides: list[Lines], outside: Lines) -> Iterator[Floats]:
        """States in which one of the sides with the least scores is moved alone, at one end or both.

        Outward only where the target is seen beyond it.
        """
        fitter, limits, state, size = self.fitter, self.limits, estimate.state, estimate.fit.half_width
        moves = fitter.work.outline[: fitter.points, 4 : 4 + len(state)].copy()
        scores = self._line_scores()
        for side in sorted(sides, key=lambda each: float(scores[each].mean()))[: limits.sides]:
            toward = np.linspace(0.0, 1.0, np.count_nonzero(side))
            ends = np.zeros((len(side), 2))
            ends[side] = np.column_stack((1.0 - toward, toward))
            steps = np.linalg.lstsq(moves, ends, rcond=None)[0]
            outward = limits.side_outward if outside[side].any() or not fitter.uses_color else ()
            for change in limits.side_inward + outward:
                yield state + size * steps @ np.array(change)

    def _line_scores(self) -> Floats:
        """How much each line speaks for the outline: near to it, and with a step in color, if there is a color."""
        work, n = self.fitter.work, self.fitter.points
        off = work.chosen[:n, 0] / self.limits.side_tolerance
        near = np.maximum(1.0 - off * off, 0.0)
        if self.fitter.uses_color:
            near *= work.edges[np.arange(n), work.chosen[:n, 2].astype(np.intp), 2]
        return np.asarray(near)

    def _target_outside(self, estimate: Estimate, image: Image, color: ColorModel) -> Lines:
        """Which lines show the target beyond the outline: what stands before it hides it, and never adds to it.

        What differs from the target inside on the same line is something else: dark pixels have any hue.
        """
        limits, outline = self.limits, self.fitter.work.outline[: self.fitter.points]
        beyond = max(limits.beyond * estimate.fit.half_width, limits.beyond_px)
        rows, columns, seen = pixels_along(image, outline, np.array([-beyond, beyond]))
        pixels = image[rows, columns]
        inside, outside = color.scores(pixels).reshape(2, -1) > 0
        difference = np.linalg.norm(pixels[1].astype(np.float64) - pixels[0], axis=1)
        brighter = np.linalg.norm(pixels.astype(np.float64), axis=2).max(axis=0)
        seen[seen] = outside & (~inside | (difference < limits.alike * brighter))
        return seen

    def score(self, estimate: Estimate, image: Image, color: ColorModel) -> float:
        """Score the last fit beside others: color score, inside of the right color, usual size, expected place.

        Where sides move alone, only edge points with a step in color count, and what the outline leaves out counts
        against it: any straight edge of the background may pass for a side.
        """
        fitter, limits, fit, motion = self.fitter, self.limits, estimate.fit, self.fitter.work.motion
        size, usual = fit.half_width, float(motion.typical_half_width)
        change = abs(math.log(size / usual)) if usual > 0.0 else 0.0
        x, y = estimate.state.item(0), estimate.state.item(1)
        far = math.hypot(x - motion.predicted.item(0), y - motion.predicted.item(1))
        change += max(far - 2.0 * float(motion.innovation) - limits.prediction_px, 0.0) / size
        score = fit.color_score if fitter.uses_color else fit.msac_score
        if fitter.sides_move and fitter.uses_color:
            outside = float(self._target_outside(estimate, image, color).mean())
            score += score - fit.msac_score - limits.outside_penalty * outside
        return score + limits.interior_weight * fit.interior_share - limits.change_weight * change

    def at_color_boundary(self, estimate: Estimate, image: Image, color: ColorModel) -> Floats | None:
        """State whose outline lies where the target's color ends, by least absolute residuals; None where it is lost.

        Contrast misleads a fit where the background has stronger edges than a blurred target.
        """
        fitter, limits, count = self.fitter, self.limits, len(self.fitter.family.parameters)
        evidence = fitter.parameters.evidence
        residuals, seen = find_color_boundary(image, color, fitter.outline, estimate.fit.half_width, evidence)
        if np.count_nonzero(seen) <= count:
            return None
        moves, residuals, step = fitter.outline[seen, 4 : 4 + count], residuals[seen], np.zeros(count)
        for _ in range(limits.mode_rounds):
            weights = 1.0 / np.sqrt(np.maximum(np.abs(residuals - moves @ step), 1.0))
            step[:] = np.linalg.lstsq(moves * weights[:, np.newaxis], residuals * weights, rcond=None)[0]
        state = estimate.state.copy()
        state[:count] += step
        return state if fitter.family.half_width(state) > 1.0 else None

    def with_modes(self, estimate: Estimate) -> Floats | None:
        """State with the modes that the residuals of the last fit ask for; None where they ask for little.

        A fit from afar keeps the modes still, and may stay so on an outline that a lens draws far out of shape.
        """
        work, limits, n, p = self.fitter.work, self.limits, self.fitter.points, len(self.fitter.family.parameters)
        size, state, residuals = estimate.fit.half_width, estimate.state.copy(), work.chosen[:n, 0]
        near = np.abs(residuals) < limits.mode_range * size
        if len(state) == p or np.count_nonzero(near) < limits.mode_lines * n:
            return None
        moves, residuals = work.outline[:n][near, 4 : 4 + len(state)], residuals[near]
        step: Floats = np.zeros(len(state))
        for _ in range(limits.mode_rounds):
            weights = 1.0 / np.sqrt(np.maximum(np.abs(residuals - moves @ step), 1.0))  # of the absolute residual
            step[:] = np.linalg.lstsq(moves * weights[:, np.newaxis], residuals * weights, rcond=None)[0]
        state += step
        wanted, given = (float(np.hypot.reduce(each)) for each in (state[p:], estimate.state[p:]))
        return state if wanted > given + limits.mode_stretch * size else None
