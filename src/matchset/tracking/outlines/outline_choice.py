"""Chooses an outline where a fit alone does not say which is the target's: `OutlineChoice`.

Where a fit is ambiguous the network of discs is asked: where it sees a ball, its disc is the prior of the fit to the
edge points, weighed with the region if the rim is a ramp. Otherwise the outlines that edge points ask for, the region
of a blurred target and what the network sees are weighed together, and against the frames before.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.prior import time_between_fields
from matchset.fitting.soft_region import SoftRegion, find_soft_region
from matchset.fitting.validation import Prior, Rejection
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.disc_network.network import Disc
from matchset.numeric.jit import interpreted
from matchset.shapes.shape import outline
from matchset.tracking.ball.judge import DISC, Judge, covariance_of, likeliest, squared_distances
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.motion import gate_of, usual_size

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

TINY = 1e-9
SAME_AWAY = 1e-3  # theorem: points of a circle of 20 px are equally far from its center, but for rounding, px
HALF_WIDTH = 20.0  # geometry: of the shape that is looked at for that, px


class OutlineChoice:
    """Chooses outlines of one family.

    Attributes
    ----------
    is_disc : bool
        Whether the shapes are discs, which have a region and a network.
    network : Judge
    spread : ndarray of shape (p, p), float64, or None
        Covariance of the outlines that were weighed last; None where there was no choice.
    """

    def __init__(self, fitter: Fitter[Any], parameters: TrackerConstants) -> None:
        self._fitter, self._parameters = fitter, parameters
        self.network = Judge(parameters.network)
        self.spread: Floats | None = None
        away = np.hypot(*outline(fitter.family.from_coarse(0.0, 0.0, HALF_WIDTH)).T)
        self.is_disc = len(fitter.family.parameters) <= DISC and bool(np.ptp(away) < SAME_AWAY)

    def judges(self, color: ColorModel) -> bool:
        """Whether the network of discs judges what is the target: a ball of a color."""
        return self.is_disc and self.network.limits.used and self._fitter.weighs(color)

    def choose(
        self, image: Image, color: ColorModel, estimate: Estimate, frame: tuple[float, float], speed: float
    ) -> Estimate | None:
        """Fit the network's disc instead of an ambiguous fit.

        None, and the workspace as it was, where the network sees no ball.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        estimate : Estimate
            The ambiguous fit.
        frame : tuple of float
            Time of the frame and since the frame before, s.
        speed : float
            Of the target, px per frame.
        """
        fitter, p = self._fitter, len(self._fitter.family.parameters)
        if not self.judges(color):
            return None
        predicted = fitter.work.motion.predicted[:p].copy()
        discs = self.network.discs(image, (predicted,))
        unclear = likeliest(discs, self.network.limits.clear, self.network.limits.same) is None
        if unclear:
            discs += self.network.discs(image, (estimate.state[:p],))
        return self._near_disc(image, color, estimate, discs, (usual_size(fitter.work, frame), speed))

    def _near_disc(
        self,
        image: Image,
        color: ColorModel,
        estimate: Estimate,
        discs: Sequence[Disc],
        known: tuple[tuple[float, float] | None, float],
    ) -> Estimate | None:
        """Fit with the network's disc as the prior; None, and the workspace as it was, where that sees no ball."""
        limits = self.network.limits
        size, speed = known
        disc = likeliest(discs, limits.clear, limits.same)
        sharp = estimate.fit.msac_score >= limits.sharp
        if disc is None or sharp or not self.network.has_color(image, color, disc.circle):
            return None
        if speed > self._parameters.soft_region.least_way * disc.circle[2]:
            disc = self._with_region(image, disc, estimate.state)
        apart, midway = self._field_offset(speed)
        if self._is_apart(disc, apart):
            disc = of_both_fields(disc, estimate.state, apart, midway)
            if squared_distances(disc, estimate.state[:DISC]) < limits.differs:
                return None
        if size is not None:
            disc = self.network.of_size(disc, size)
        fitted = self._fit_following(image, color, estimate.state, speed, disc)
        if fitted.rejection or self._differs(disc, fitted):
            return self._take(disc, fitted)
        self.spread = covariance_of(disc)
        return fitted

    def _field_offset(self, speed: float) -> tuple[Floats, float]:
        """From one field of the picture to the other, px, and how far on that way the fit is, as a share.

        Of a half-frame the way since the rows that are not new, at whose end it is.
        """
        work = self._fitter.work
        if work.rows == 0:
            return (work.field_offset.fitted if self.is_interlaced() else np.zeros(2)), 0.5
        velocity: Floats = work.motion.velocity[:2]
        return velocity * (speed / max(math.hypot(*velocity.tolist()), TINY)), 1.0

    def _is_apart(self, disc: Disc, offset: Floats) -> bool:
        """Whether the fields lie farther apart than the fit around a disc looks."""
        limits = self.network.limits
        return math.hypot(*offset.tolist()) > max(limits.range_share * disc.circle[2], limits.min_range_px)

    def refined(self, image: Image, disc: Disc) -> Disc:
        """Mean of a disc with the region there, if that is blurred.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        disc : Disc
        """
        return self._with_region(image, disc, self._fitter.family.from_coarse(*disc.circle).state)

    def fit_lost(self, image: Image, color: ColorModel, disc: Disc) -> bool:
        """Fit the edge points around the disc of a target that was lost; whether they confirm it.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        disc : Disc
        """
        fitter = self._fitter
        state = fitter.family.from_coarse(*disc.circle).state
        fitted = self._fit(image, color, state, np.array(disc.circle), speed=None, prior=disc)
        if fitted.rejection or squared_distances(disc, fitted.state[:DISC]) > self.network.limits.differs:
            return False
        return not fitter.validate_detection(fitter.weigh(fitted, image, color), Prior.HERE)

    def _with_region(self, image: Image, disc: Disc, state: Floats) -> Disc:
        """Weigh the network's disc with the region there, if the rim of that is a ramp all around."""
        there = state.copy()
        there[:DISC] = disc.circle
        limits, region = self._parameters.soft_region, self._region(image, there)
        worth = region.worth(limits) if region else 0.0
        if region is None or worth <= limits.sure * limits.worth:
            return disc
        sigma = limits.sigma * region.half_width * (limits.worth / worth) ** 2
        return self.network.weighed(disc, (region.x, region.y, region.half_width), sigma)

    def _fit_following(self, image: Image, color: ColorModel, state: Floats, speed: float, disc: Disc) -> Estimate:
        """Fit around a disc of a target that is followed: with its fields where the picture is known to have two."""
        if self.is_interlaced():
            return self._fit(image, color, state, np.array(disc.circle), prior=disc, speed=speed)
        work = self._fitter.work
        fields = work.field_offset.fitted.copy()
        fitted = self._fit(image, color, state, np.array(disc.circle), prior=disc)
        work.window.speed, work.field_offset.fitted[:] = speed, fields
        return fitted

    def is_interlaced(self) -> bool:
        """Whether the frames before showed two fields, half a frame apart."""
        return interpreted(time_between_fields)(self._fitter.work)[1] > 0.0

    def _fit(
        self,
        image: Image,
        color: ColorModel,
        state: Floats,
        begin: Floats,
        *,
        speed: float | None = 0.0,
        prior: Disc | None = None,
    ) -> Estimate:
        """Fit in a narrow window around an outline; with a prior that begins there, a disc of the network.

        `speed`: px per frame, of a shape whose fields lie apart; None where nothing is known of how it moves.
        """
        limits, whole = self.network.limits, state.copy()
        whole[: len(begin)] = begin
        reach = max(limits.range_share * float(self._fitter.family.half_width(whole)), limits.min_range_px)
        window = SearchWindow(
            reach,
            self._parameters.detection.speed if speed is None else speed,
            limits.sigma_share * reach,
            velocity_unknown=speed is None,
        )
        if prior is None:
            return self._fitter.fit(image, color, whole, window)
        sigma, of_motion = self._fitter.work.motion.prior_sigma, self._fitter.work.motion.prior_sigma.copy()
        sigma[:DISC] = np.sqrt(np.diag(covariance_of(prior)))
        fitted = self._fitter.fit(image, color, whole, window._replace(use_prior=True))
        sigma[:] = of_motion
        return fitted

    def _differs(self, disc: Disc, fitted: Estimate) -> bool:
        """Whether a fit differs from the network's disc, and is not so sharp that it is right."""
        limits = self.network.limits
        apart = float(squared_distances(disc, fitted.state[:DISC]))
        return fitted.fit.msac_score < limits.sharp and apart > limits.differs

    def _take(self, disc: Disc, fitted: Estimate) -> Estimate:
        """Make the last fit a disc of the network."""
        work = self._fitter.work
        self._fitter.state[:DISC] = disc.circle
        work.covariance[:DISC, :DISC] = covariance_of(disc)
        return fitted._replace(state=self._fitter.state.copy(), rejection=Rejection.NONE)

    def _region(self, image: Image, state: Floats) -> SoftRegion | None:
        limits, here = self._parameters.soft_region, gate_of(self._fitter.family, state)
        return find_soft_region(image, here, limits) if self.is_disc else None


def of_both_fields(disc: Disc, state: Floats, offset: Floats, midway: float = 0.5) -> Disc:
    """Disc of which the network may have seen one field only: along the offset of the fields the fit is believed.

    Parameters
    ----------
    disc : Disc
    state : ndarray of shape (s,), float64
        Of the fit.
    offset : ndarray of shape (2,), float64
        From one field to the other, as it was fitted, px; zeros in pictures that are not interlaced.
    midway : float
        How far on that way the fit is: 0.5, or 1 of a half-frame.
    """
    square = float(offset @ offset)
    if square == 0.0:
        return disc
    x, y, radius = disc.circle
    share = float(offset @ (state[:2] - (x, y))) / square
    share = min(max(share, midway - 1.0), midway)
    covariance = covariance_of(disc)
    covariance[:2, :2] += 0.25 * np.outer(offset, offset)
    circle = x + share * float(offset[0]), y + share * float(offset[1]), radius
    return disc._replace(circle=circle, precision=np.asarray(np.linalg.inv(covariance), np.float64))
