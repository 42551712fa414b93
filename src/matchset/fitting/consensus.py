"""Consensus of edge points: outlines that a few edge points ask for and many others agree with.

A robust fit follows the mean of what lies near. Where a hand, a tube or a shaded side cuts the target, that mean is a
compromise between the outline and the cut. Random sample consensus (Fischler & Bolles, 1981) has no mean: as many edge
points as the outline has parameters are drawn, on lines that lie apart, and give an outline; the other lines say
whether they have an edge point on it. The best of those are fitted to what agrees with them.

An outline's score is the share of the lines that agree, less the target's color seen beyond it: something may hide a
part of the target, but the target is never where it is not. The color is half that of the model, half what tells the
inside of the fit from what is around it in this picture (`regions/local_color.py`).
"""

from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.regions.local_color import LocalColorParameters, learn_local_color
from matchset.image.color import ColorModel

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Integers = npt.NDArray[np.intp]

TINY = 1e-9
NO_PLACE = 1e6  # format: place of an edge point that is not there, px
NO_SCORE = -1.0  # format: score of an outline that crosses too few of the lines


class ConsensusParameters(msgspec.Struct, frozen=True):
    """How outlines are drawn from edge points and scored.

    Chosen on real clips, three starts of three clicks each; half and twice the value of `plain`, `outside`, `inside`,
    `slope` and `tolerance` made no more than 2 % of the rows worse (docs/log.md).
    `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    reach, min_reach_px, max_reach_px : float
        How far on both sides of an outline edge points are looked for: in half-widths, and at least and at most px.
    edge_points : int
        Most of them on a line. More finds weaker ones and takes longer.
    slope, min_slope_px : float
        On how much of both sides the contrast of an edge point is taken, in half-widths and at least px: more is
        steadier in noise and blur.
    smoothing_px : float
        Standard deviation of a Gauss filter before, px.
    lever, min_lever_px : float
        On how much of both sides the step in color of an edge point is read, in half-widths and at least px: a coded
        picture keeps one color for blocks of several pixels.
    full_step, min_step : float
        Step in whiteness, -1 ... 1, from which a larger one is no better, and below which there is no edge point.
    least_strength : float
        Strength of an edge point without a step in color, as a share of that with a full one: which are kept.
    plain : float
        Weight of an edge point without a step in color, as a share of that with a full one: what it counts.
    most_parameters : int
        Families with more are not drawn: the share of samples that are all right falls as the share of right edge
        points to the power of their number, about 0.3^3 = 3 % and 0.3^5 = 0.2 %.
    max_field_offset_px : float
        Field offset of an interlaced picture from which no outlines are drawn, px: edge points of both fields would be
        mixed.
    draws : int
        How many samples are drawn. More finds an outline of which less is seen, and takes longer.
    apart : float
        How far the lines of a sample lie apart, as a share of the outline.
    smallest, largest, farthest : float
        Half-width of an outline that counts, as a factor on the first one's, and how far off it may lie, in these.
    tolerance, min_tolerance_px : float
        How near an edge point must be to agree, in half-widths and at least px.
    refined, kept : int
        How many of the best samples are fitted to what agrees with them, and how many different ones are kept.
    rounds : int
        Rounds of that fit.
    different_px : float
        Largest distance of two outlines that are the same, px.
    band, min_band_px : float
        How far beyond and within an outline its color is looked at, in half-widths and at least px.
    beyond, within : float
        Where that begins, in tolerances.
    outside, inside : float
        What the target's color beyond an outline costs, and what it is worth within.
    seen : float
        Least share of the lines that an outline must cross where they were read.
    local_color : LocalColorParameters
        How the colors inside and around are learned in the picture at hand.
    """

    reach: float = 0.4
    min_reach_px: float = 6.0
    max_reach_px: float = 70.0
    edge_points: int = 4
    slope: float = 0.1
    min_slope_px: float = 2.0
    smoothing_px: float = 0.6
    lever: float = 0.06
    min_lever_px: float = 2.0
    full_step: float = 0.6
    min_step: float = -0.05
    least_strength: float = 0.15
    plain: float = 0.2
    most_parameters: int = 3
    max_field_offset_px: float = 1.0
    draws: int = 256
    apart: float = 0.08
    smallest: float = 0.65
    largest: float = 1.45
    farthest: float = 0.4
    tolerance: float = 0.03
    min_tolerance_px: float = 1.5
    refined: int = 32
    kept: int = 12
    rounds: int = 3
    different_px: float = 0.7
    band: float = 0.12
    min_band_px: float = 3.0
    beyond: float = 0.7
    within: float = 1.4
    outside: float = 0.5
    inside: float = 0.1
    seen: float = 0.5
    local_color: LocalColorParameters = LocalColorParameters()


class Proposals(NamedTuple):
    """Outlines that edge points ask for, those that were given first.

    Attributes
    ----------
    steps : ndarray of shape (k, p), float64
        What to add to the parameters.
    half_widths : ndarray of shape (k,), float64
        Of the outlines, px.
    scores : ndarray of shape (k,), float64
        1 at most; about 0 and less where nothing speaks for an outline.
    """

    steps: Floats
    half_widths: Floats
    scores: Floats


class Profiles(NamedTuple):
    """What lies along the normals of an outline.

    Attributes
    ----------
    span : int
        Places on both sides of the outline, 1 px apart.
    places : ndarray of shape (k, n), float64
        Edge points of each line, px outward from the outline; `NO_PLACE` where there is none.
    weights : ndarray of shape (k, n), float64
        Of the edge points, 0 ... 1.
    whiteness : ndarray of shape (2 span + 2, n), float64
        Running sums of the target's color along the lines, inside first.
    """

    span: int
    places: Floats
    weights: Floats
    whiteness: Floats


class Consensus:
    """Draws outlines of one family from the edge points of a picture.

    Parameters
    ----------
    count : int
        Parameters of the family.
    limits : ConsensusParameters, optional
    """

    def __init__(self, count: int, limits: ConsensusParameters | None = None) -> None:
        self.limits, self.count = limits or ConsensusParameters(), count
        self._uniform = np.random.default_rng(0).random((self.limits.draws, count))

    def propose(self, image: Image, color: ColorModel, outline: Floats, half_width: float, given: Floats) -> Proposals:
        """Propose outlines near one, by consensus, and score them and those that are given.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        outline : ndarray of shape (n, >= 4 + p), float64
            Points, outward normals and how the outline moves along them with each parameter.
        half_width : float
            Of the shape, px.
        given : ndarray of shape (g, p), float64
            Steps from the outline to others that shall be scored too.
        """
        limits = self.limits
        lines = _Lines(
            outline, half_width, self.count, _read_profiles(image, color, outline, half_width, limits), limits
        )
        steps = self._draw(lines)
        best = np.argsort(-lines.agreement(lines.offsets(steps)).mean(axis=1), kind="stable")[: limits.refined]
        steps = np.vstack((lines.refine(steps[best]), steps[best]))
        steps = np.vstack((given, steps[lines.counts(steps)]))
        offsets = lines.offsets(steps)
        scores = lines.scores(offsets)
        kept = _different(offsets, scores, len(given), limits)
        return Proposals(steps[kept], half_width + offsets[kept].mean(axis=1), scores[kept])

    def _draw(self, lines: "_Lines") -> Floats:
        """Draw samples of edge points on lines that lie apart; steps to the outlines through them."""
        profiles, limits, p = lines.profiles, self.limits, self.count
        which, line = np.nonzero(profiles.weights > 0.0)
        if len(line) < p:
            return np.zeros((0, p))
        chances, n = np.cumsum(profiles.weights[which, line]), profiles.places.shape[1]
        chosen = np.searchsorted(chances, self._uniform * chances[-1], side="right")
        ordered = np.sort(line[chosen], axis=1)
        gaps = np.diff(ordered, axis=1, append=ordered[:, :1] + n)
        chosen = chosen[gaps.min(axis=1) >= limits.apart * n]
        moves, places = lines.moves[line[chosen]], profiles.places[which[chosen], line[chosen]]
        regular = np.abs(np.linalg.det(moves)) > TINY
        steps = np.asarray(np.linalg.solve(moves[regular], places[regular][:, :, np.newaxis])[:, :, 0])
        return steps[lines.counts(steps)]


class _Lines:
    """Lines across an outline, against which others are measured."""

    def __init__(
        self, outline: Floats, half_width: float, count: int, profiles: Profiles, limits: ConsensusParameters
    ) -> None:
        self.profiles, self.limits, self.half_width = profiles, limits, half_width
        self.moves = outline[:, 4 : 4 + count]
        self._normals = outline[:, 2:4]
        self._tolerance = max(limits.tolerance * half_width, limits.min_tolerance_px)

    def offsets(self, steps: Floats) -> Floats:
        """Where the outlines that steps lead to cross each line, px outward; (k, n).

        To second order: a round outline that moves along itself bends away by lateral^2 / (2 half-width).
        """
        lateral = steps[:, :1] * -self._normals[:, 1] + steps[:, 1:2] * self._normals[:, 0]
        return np.asarray(steps @ self.moves.T - lateral**2 / (2.0 * self.half_width))

    def counts(self, steps: Floats) -> npt.NDArray[np.bool_]:
        """Whether steps lead to outlines of about the same size and place."""
        limits = self.limits
        size = 1.0 + self.offsets(steps).mean(axis=1) / self.half_width
        far = np.hypot(steps[:, 0], steps[:, 1]) / self.half_width
        return np.asarray((size > limits.smallest) & (size < limits.largest) & (far < limits.farthest))

    def agreement(self, offsets: Floats) -> Floats:
        """How well each line agrees with each outline, 0 ... 1; (k, n)."""
        return np.asarray(self._nearest(offsets)[0])

    def _nearest(self, offsets: Floats) -> tuple[Floats, Integers]:
        """How well the edge point that agrees best does, and which that is."""
        best, which = np.zeros(offsets.shape), np.zeros(offsets.shape, np.intp)
        for k, (places, weights) in enumerate(zip(self.profiles.places, self.profiles.weights, strict=True)):
            agreement = np.maximum(1.0 - ((places - offsets) / self._tolerance) ** 2, 0.0) * weights
            better = agreement > best
            best[better], which[better] = agreement[better], k
        return best, which

    def refine(self, steps: Floats) -> Floats:
        """Fit steps to the edge points that agree with them, by weighted least squares."""
        p, n = self.moves.shape[1], np.arange(len(self.moves))
        for _ in range(self.limits.rounds):
            offsets = self.offsets(steps)
            weights, which = self._nearest(offsets)
            residuals = self.profiles.places[which, n] - offsets
            normal = np.einsum("kn,np,nq->kpq", weights, self.moves, self.moves) + TINY * np.eye(p)
            right = (weights * np.where(weights > 0.0, residuals, 0.0)) @ self.moves
            steps = steps + np.linalg.solve(normal, right[:, :, np.newaxis])[:, :, 0]
        return steps

    def scores(self, offsets: Floats) -> Floats:
        """Score outlines: lines that agree, less color beyond, and color within."""
        limits, span = self.limits, self.profiles.span
        crossed = np.abs(offsets) < span - 1.0
        count = np.maximum(crossed.sum(axis=1), 1)
        band = round(max(limits.band * self.half_width, limits.min_band_px))
        beyond = np.rint(offsets + span + limits.beyond * self._tolerance).astype(np.intp)
        within = beyond - 1 - round(limits.within * self._tolerance) - band
        agreement = (self.agreement(offsets) * crossed).sum(axis=1)
        outside, inside = ((self._color(start, band) * crossed).sum(axis=1) for start in (beyond, within))
        scores = (agreement - limits.outside * outside + limits.inside * inside) / count
        return np.where(crossed.mean(axis=1) > limits.seen, scores, NO_SCORE)

    def _color(self, start: Integers, band: int) -> Floats:
        """Mean whiteness of a band of each line, from a place on."""
        sums, n = self.profiles.whiteness, np.arange(start.shape[1])
        low, high = (np.clip(at, 0, len(sums) - 1) for at in (start, start + band))
        return np.asarray((sums[high, n] - sums[low, n]) / np.maximum(high - low, 1))


def _read_profiles(
    image: Image, color: ColorModel, outline: Floats, half_width: float, limits: ConsensusParameters
) -> Profiles:
    """Read a picture along the normals of an outline, and find the edge points."""
    span = round(min(max(limits.reach * half_width, limits.min_reach_px), limits.max_reach_px))
    offsets = np.arange(-span, span + 1.0)
    places = outline[:, :2] + offsets[:, np.newaxis, np.newaxis] * outline[:, 2:4]
    columns, rows = places.astype(np.float32).transpose(2, 0, 1)
    read = cv2.remap(image, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    pixels = np.asarray(read, np.uint8).reshape(*columns.shape, -1)
    seen = (columns >= 0) & (columns <= image.shape[1] - 1) & (rows >= 0) & (rows <= image.shape[0] - 1)
    white = color.scores(pixels).reshape(columns.shape) / 127.0
    x, y = outline[:, :2].mean(axis=0).tolist()
    local = learn_local_color(image, (x, y), half_width, limits.local_color)
    if local:
        white = white + limits.local_color.weight * (local.scores(pixels) - white)
    white = np.where(seen, white, 0.0)
    contrast = np.where(seen, _contrast(pixels, half_width, limits), 0.0)
    lever = round(max(limits.lever * half_width, limits.min_lever_px))
    found, weights = _edge_points(contrast, 0.5 * _difference(white, lever), limits)
    whiteness = np.zeros((len(offsets) + 1, len(outline)))
    np.cumsum(np.clip(white, 0.0, 1.0), axis=0, out=whiteness[1:])
    return Profiles(span, found - span, weights, whiteness)


def _contrast(pixels: Image, half_width: float, limits: ConsensusParameters) -> Floats:
    """Length of the difference of the mean colors before and behind each place along the lines."""
    lever = round(max(limits.slope * half_width, limits.min_slope_px))
    flat = pixels.reshape(len(pixels), -1).astype(np.float32)
    smooth = cv2.GaussianBlur(flat, (1, 0), limits.smoothing_px, sigmaY=limits.smoothing_px)
    steps = _difference(smooth.astype(np.float64), lever).reshape(pixels.shape)
    return np.asarray(np.linalg.norm(steps, axis=2))


def _difference(values: Floats, lever: int) -> Floats:
    """Mean of the values before each row less that of those behind it; 0 near both ends."""
    sums = np.zeros((len(values) + 1, values.shape[1]))
    np.cumsum(values, axis=0, out=sums[1:])
    means, count = (sums[lever:] - sums[:-lever]) / lever, len(values) - 2 * lever
    steps = np.zeros(values.shape)
    if count > 0:
        steps[lever : lever + count] = means[:count] - means[lever + 1 : lever + 1 + count]
    return steps


def _edge_points(contrast: Floats, steps: Floats, limits: ConsensusParameters) -> tuple[Floats, Floats]:
    """Strongest peaks of the contrast along each line, to a fraction of a place, and their weights."""
    strength = contrast * np.clip(steps / limits.full_step, limits.least_strength, 1.0)
    peak = np.zeros(contrast.shape, np.bool_)
    peak[1:-1] = (contrast[1:-1] >= contrast[:-2]) & (contrast[1:-1] > contrast[2:])
    strength[~peak | (steps < limits.min_step)] = 0.0
    which = np.argsort(-strength, axis=0, kind="stable")[: limits.edge_points]
    n = np.arange(contrast.shape[1])
    there = strength[which, n] > 0.0
    middle = np.clip(which, 1, len(contrast) - 2)
    before, at, after = contrast[middle - 1, n], contrast[middle, n], contrast[middle + 1, n]
    places = middle + 0.5 * (after - before) / np.maximum(2.0 * at - before - after, TINY)
    weights = limits.plain + (1.0 - limits.plain) * np.clip(steps[which, n] / limits.full_step, 0.0, 1.0)
    return np.where(there, places, NO_PLACE), np.where(there, weights, 0.0)


def _different(offsets: Floats, scores: Floats, given: int, limits: ConsensusParameters) -> list[int]:
    """Which outlines are kept: those that were given, and the best that differ from each other."""
    chosen = [*range(given)]
    for k in np.argsort(-scores, kind="stable").tolist():
        if len(chosen) >= given + limits.kept or scores[k] == NO_SCORE:
            break
        if all(np.abs(offsets[k] - offsets[other]).max() > limits.different_px for other in chosen):
            chosen.append(k)
    return chosen
