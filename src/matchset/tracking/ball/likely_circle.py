"""Which of many fits is the ball that was clicked: `LikelyCircle`.

In a picture that is asked for, a small, blurred or compressed ball has no outline that passes the rules of a detection,
or a finger's passes before its own. But the picture that was clicked says how the ball looked: its color, how even it
is, how it differs from what is around it, and how large it was. So all fits at all candidates are compared by a sum of
log-likelihood ratios: of the outline (`fitting.evidence`), of the color in and around it, and of size and look. The one
with the largest sum is the ball, if it is there at all: if the sum is high, and clearly higher than anywhere else.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate
from matchset.image.circle_score import CircleTuple
from matchset.image.color import WHITE, ColorModel
from matchset.image.color_learning import chroma

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

# geometry: bounds of the middle, of both sides of the outline and of what is around, radii
CORE, INSIDE, OUTSIDE, AROUND, EVEN = (0.0, 0.6), (0.6, 0.93), (1.07, 1.35), (1.35, 1.7), (0.0, 0.75)
FEW = 6  # theorem: as many pixels as a quadratic surface has coefficients
DARK = 16.0  # format: gray levels that are added where brightness is divided by
NO_STEP = 0.02  # format: units of chroma that are added to a step that is divided by


class LikelyParameters(msgspec.Struct, frozen=True):
    """Weights of the figures of a fit in its log-likelihood ratio, and how much of it a ball needs.

    The weights come from conditional logistic regression: the fits of a picture are compared with each other, and with
    none of them being right where the ball is absent or other balls are shown. What is asked comes from another one,
    of the likeliest fits of pictures with and without the ball. Fitted to `tennis_throw`, `yellow_occlusion`,
    `green_hand_a` and `green_throw`, whole and shrunk, once, by hand (docs/log.md);
    `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    bias : float
        Of a fit of which nothing is known, against none being right.
    evidence, least_evidence, most_evidence : float
        Of the log-odds of the outline, and the bounds between which they are taken.
    msac, near : float
        Of the MSAC score, and of the step in color near the outline.
    core, around : float
        Of the mean whiteness in the middle, and around the outline.
    size, smaller, larger, most_size : float
        Of s^2, at most `most_size`, and of s below and above 0; s: ln(half-width / radius at the click).
    color, most_color : float
        Of the distance of the mean chroma in the middle from that at the click, in tenths, and the most that counts.
    step, least_step, most_step : float
        Of the step in chroma across the outline along that at the click, as a share of it, and its bounds.
    light, most_light : float
        Of the difference in lightness, octaves, and the most that counts.
    uneven, most_uneven : float
        Of how much rougher the middle is than at the click, as a share of its brightness, and the most that counts.
    outside : float
        Of the share of the radius that is outside the picture.
    lead, most_lead : float
        Of the lead before the likeliest fit elsewhere, and the most that counts.
    present : float
        Least sum of the log-likelihood ratio and that. Less finds more balls, and more in pictures without one.
    apart : float
        Distance from which a fit is elsewhere, in radii of the larger one.
    same, growth : float
        How far from a detection the likeliest fit may be that takes its place, in radii, and their ratio.
    temperature : float
        The answer is the mean of the fits there, weighted by exp(ratio / temperature): 0.3 to 1 are about as good; more
        takes in wrong ones, 0 is the likeliest alone.
    """

    bias: float = -5.47
    evidence: float = 0.38
    least_evidence: float = -6.0
    most_evidence: float = 7.0
    msac: float = 5.44
    near: float = 1.4
    core: float = 1.19
    around: float = -0.91
    size: float = -0.27
    smaller: float = 1.21
    larger: float = 0.86
    most_size: float = 4.0
    color: float = -2.0
    most_color: float = 4.0
    step: float = 0.95
    least_step: float = -0.5
    most_step: float = 1.5
    light: float = -1.92
    most_light: float = 2.0
    uneven: float = -4.05
    most_uneven: float = 0.6
    outside: float = -1.46
    lead: float = 0.12
    most_lead: float = 6.0
    present: float = 0.3
    apart: float = 1.0
    same: float = 0.6
    growth: float = 2.0
    temperature: float = 0.6


class Look(NamedTuple):
    """How a circle looks: whiteness and chroma of the middle and around it, chroma on both sides, and roughness."""

    core: float
    around: float
    color: Floats
    step: Floats
    uneven: float


def look_of(image: Image, color: ColorModel, circle: CircleTuple, cells: int = 40) -> Look | None:
    """Measure how a circle looks, on every second, third, ... pixel where it is large.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    circle : (x, y, radius)
        px.
    cells : int
        About how many pixels are looked at along a side.

    Returns
    -------
    Look or None
        None where it is outside the picture.
    """
    x, y, radius = circle
    reach = AROUND[1] * radius + 2.0
    left, top, every = max(math.floor(x - reach), 0), max(math.floor(y - reach), 0), max(int(2.0 * reach / cells), 1)
    near = image[top : max(math.ceil(y + reach) + 1, 0) : every, left : max(math.ceil(x + reach) + 1, 0) : every]
    if not near.size:
        return None
    rows, columns = np.arange(near.shape[0]) * every + top - y, np.arange(near.shape[1]) * every + left - x
    away = np.hypot(columns, rows[:, np.newaxis]) / radius
    core, inside, outside, around, even = (
        (away >= low) & (away < high) for low, high in (CORE, INSIDE, OUTSIDE, AROUND, EVEN)
    )
    white = color.scores(near if near.shape[2] == 3 else near[:, :, 0]) / float(WHITE)
    values = chroma(near if near.shape[2] == 3 else np.repeat(near, 3, axis=2))
    step = _mean(values, inside)[:2] - _mean(values, outside)[:2]
    places = np.nonzero(even)
    gray = near[places].mean(axis=-1)
    uneven = _roughness(columns[places[1]] / radius, rows[places[0]] / radius, gray)
    return Look(float(_mean(white, core)), float(_mean(white, around)), _mean(values, core), step, uneven)


def _mean(values: npt.NDArray[np.floating], where: npt.NDArray[np.bool_]) -> Floats:
    """Mean over some pixels, 0 without any."""
    return np.asarray(values[where].mean(axis=0) if where.any() else np.zeros(values.shape[2:]), np.float64)


def _roughness(x: npt.NDArray[Any], y: npt.NDArray[Any], gray: npt.NDArray[Any]) -> float:
    """Measure the standard deviation from a quadratic surface, which shading is, as a share of the brightness."""
    if len(gray) < FEW:
        return 0.0
    terms = np.column_stack((np.ones(len(x)), x, y, x * x, y * y, x * y))
    rest = gray - terms @ np.linalg.lstsq(terms, gray, rcond=None)[0]
    return float(rest.std() / (gray.mean() + DARK))


class LikelyCircle:
    """Compares the fits of a picture by how likely they are the ball that was clicked.

    Parameters
    ----------
    color : ColorModel
        With what was around the circle at the click.
    limits : LikelyParameters
    """

    def __init__(self, color: ColorModel, limits: LikelyParameters) -> None:
        assert color.sample is not None
        self._color, self._limits, self._radius = color, limits, color.sample.radius
        self._home = look_of(color.sample.image, color, color.sample.circle)

    def figures(self, image: Image, estimate: Estimate, near_step: float) -> Floats | None:
        """Figures of a fit, in the order of `weights`.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        estimate : Estimate
            Weighed.
        near_step : float
            See `Fitter.near_step`.

        Returns
        -------
        ndarray of shape (13,) or None
            None where there is nothing to measure.
        """
        limits, home = self._limits, self._home
        x, y, radius = circle = circle_of(estimate.state)
        look = look_of(image, self._color, circle)
        if look is None or home is None or estimate.evidence is None:
            return None
        size, outside = (
            math.log(radius / self._radius),
            radius - min(x, y, image.shape[1] - 1 - x, image.shape[0] - 1 - y),
        )
        along = float(look.step @ home.step) / (math.hypot(*home.step) + NO_STEP) ** 2
        apart = math.dist(look.color[:2], home.color[:2])
        return np.array((
            min(max(estimate.evidence, limits.least_evidence), limits.most_evidence),
            estimate.fit.msac_score,
            near_step,
            look.core,
            look.around,
            min(size * size, limits.most_size),
            min(size, 0.0),
            max(size, 0.0),
            min(10.0 * apart, limits.most_color),
            min(max(along, limits.least_step), limits.most_step),
            min(abs(float(look.color[2] - home.color[2])), limits.most_light),
            min(max(look.uneven - home.uneven, 0.0), limits.most_uneven),
            min(max(outside / radius, 0.0), 1.0),
        ))  # fmt: skip

    @property
    def weights(self) -> Floats:
        """Weights of the figures."""
        w = self._limits
        return np.array((
            w.evidence, w.msac, w.near, w.core, w.around, w.size, w.smaller, w.larger, w.color, w.step, w.light,
            w.uneven, w.outside,
        ))  # fmt: skip

    def ratio(self, figures: Floats) -> float:
        """Log-likelihood ratio of a fit being the ball, against none being it."""
        return float(self.weights @ figures) + self._limits.bias

    def is_there(self, found: Sequence[tuple[float, CircleTuple]]) -> bool:
        """Say whether the likeliest of some fits is the ball: its log-likelihood ratio, and its lead, are high.

        Parameters
        ----------
        found : sequence of (float, (x, y, radius))
            Log-likelihood ratio and place of each, at least one.
        """
        limits = self._limits
        most, (x, y, radius) = max(found)
        elsewhere = [
            ratio for ratio, each in found if math.hypot(each[0] - x, each[1] - y) > limits.apart * max(each[2], radius)
        ]
        lead = min(most - max(elsewhere, default=-math.inf), limits.most_lead)
        return most + limits.lead * lead > limits.present

    def mean(self, found: Sequence[tuple[float, CircleTuple]]) -> tuple[Floats, Floats]:
        """Mean and covariance of the likeliest fit and those that may take its place, by their likelihood.

        Parameters
        ----------
        found : sequence of (float, (x, y, radius))
            Log-likelihood ratio and place of each, at least one.

        Returns
        -------
        mean : ndarray of shape (3,)
            px.
        covariance : ndarray of shape (3, 3)
            px^2.
        """
        most, best = max(found)
        at_it = [(ratio, each) for ratio, each in found if self.is_same(each, best)]
        circles = np.array([each for _, each in at_it])
        weights = np.exp((np.array([ratio for ratio, _ in at_it]) - most) / self._limits.temperature)
        weights /= weights.sum()
        mean = weights @ circles
        return mean, np.asarray((weights[:, np.newaxis] * (circles - mean)).T @ (circles - mean))

    def is_same(self, circle: CircleTuple, other: CircleTuple) -> bool:
        """Say whether a fit may take the place of another one.

        Parameters
        ----------
        circle, other : (x, y, radius)
            px.
        """
        limits = self._limits
        near = math.dist(circle[:2], other[:2]) < limits.same * max(circle[2], other[2])
        return near and 1.0 / limits.growth < circle[2] / other[2] < limits.growth

    def is_near(self, start: CircleTuple, other: CircleTuple) -> bool:
        """Say whether a fit that begins somewhere may end at another one.

        Parameters
        ----------
        start, other : (x, y, radius)
            px.
        """
        return math.dist(start[:2], other[:2]) < max(start[2], other[2])


def circle_of(state: Floats) -> CircleTuple:
    """Center and radius of a circle's state, px."""
    return float(state[0]), float(state[1]), float(state[2])
