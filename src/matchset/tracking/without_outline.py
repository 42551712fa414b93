"""Where a target is whose outline no edges confirm: `WithoutOutline`.

Last of all, where the fit and the search found nothing, a disc counts that the network sees there
(`image/disc_network`), of the color and size of the target. Nothing is learned from it but its color.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from matchset.fitting.validation import Prior
from matchset.image.color import ColorModel
from matchset.image.disc_network.network import Disc
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.network_outlines import NetworkParameters, covariance_of, likeliest
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.disc_search import DiscSearch
from matchset.tracking.search.prominence import Prominence
from matchset.tracking.track_step import TrackStep

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


class _Expected(NamedTuple):
    """What is known of where a lost target is, and of its size.

    Attributes
    ----------
    place : Gate
        Where it should be, or was seen last.
    half_width : float
        As it was seen last, px.
    missed : float
        How many frames ago that was.
    """

    place: Gate
    half_width: float
    missed: float

    def log_odds(self, found: Gate, limits: NetworkParameters) -> float | None:
        """Say what place and size add to the log-odds of a disc; None where it is far too large or small.

        The place is one of as many as there are about as far off, and the longer it was not seen the less is known.
        """
        growth = abs(math.log(found.half_width / self.half_width))
        if growth > math.log(limits.growth):
            return None
        away = (self.place.distance(found) / self.half_width) ** 2 + ((self.missed - 1.0) / limits.forgotten) ** 2
        return -min(0.5 * math.log1p(away), limits.anywhere)


class WithoutOutline:
    """Remembers what a target is like whose outline is seen, and takes a disc that is like it where none is seen.

    Parameters
    ----------
    step : TrackStep
    parameters : TrackerParameters

    Attributes
    ----------
    prominence : Prominence
        Whether the target is alone with its color.
    seen : bool
        Whether the outline of the target was seen.
    """

    def __init__(self, step: TrackStep[Any], parameters: TrackerParameters) -> None:
        self._step, self._parameters = step, parameters
        self.prominence = Prominence(parameters.prominence, parameters.search)
        self._search = DiscSearch(parameters.disc_search)
        self._color: Floats | None = None
        self._half_width = 0.0
        self.seen = False

    def forget(self, color: ColorModel) -> None:
        """Be as one is that has seen nothing but what the color was learned from.

        Parameters
        ----------
        color : ColorModel
        """
        self._step.outlines.network.know(color.sample)
        self.prominence.forget()
        self._search.forget()
        self.seen, self._color, self._half_width = False, None, 0.0

    def remember(self, image: Image, color: ColorModel, seen: Gate) -> None:
        """Remember the color and the looks of a target whose outline is seen.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        seen : Gate
            Where it is.
        """
        self.seen = True
        if self._step.fitter.weighs(color):
            self.prominence.measure(image, color, seen)
        if self._step.outlines.is_disc:
            self._color = self._step.outlines.network.median_color(image, (seen.x, seen.y, seen.half_width))
            self._half_width = seen.half_width

    def relight(self, gains: Floats) -> None:
        """Remember the color, and what the network knows of it, in another light.

        Parameters
        ----------
        gains : ndarray of shape (channels,), float64
            By which the channels of all pixels were multiplied.
        """
        self._step.outlines.network.relight(gains)
        if self._color is None:
            return
        pixel = cv2.cvtColor(self._color.astype(np.float32).reshape(1, 1, 3), cv2.COLOR_Lab2BGR)
        changed = np.clip(pixel * gains.astype(np.float32), 0.0, 1.0)
        self._color = cv2.cvtColor(changed, cv2.COLOR_BGR2Lab).reshape(3).astype(np.float64)

    def elsewhere(self, color: ColorModel, unknown: bool) -> Prior:
        """Say what is known of a shape that is not where somebody clicked, nor where the target is expected.

        A color that was learned against what is next to the target may be anywhere else.

        Parameters
        ----------
        color : ColorModel
        unknown : bool
            Whether nothing is known of it in any case.
        """
        return Prior.NONE if unknown or (color.is_local and not self.seen) else Prior.PRESENT

    def searches(self, color: ColorModel) -> bool:
        """Whether the network looks for a lost target of a color."""
        outlines = self._step.outlines
        known = self._color is not None and self._parameters.network.used
        return outlines.is_disc and self._step.fitter.weighs(color) and known

    def take(
        self, image: Image, color: ColorModel, last: Gate, expected: Gate | None, time: float, interval: float
    ) -> bool:
        """Take a disc for the target about where it is expected, or anywhere by its color; whether there was one.

        Parameters
        ----------
        image, color
            See `remember`.
        last : Gate
            Where the target was seen last.
        expected : Gate or None
            Where it should be, if it was seen lately.
        time : float
            Of the picture, s.
        interval : float
            Since the frame before, s.
        """
        step = self._step
        if not step.outlines.is_disc:
            return False
        missed = step.missed(time, interval)
        if not step.without_outline:  # what approaches is larger than when its looks were remembered
            self._half_width = last.half_width
        return self._take_by_network(image, color, last, expected, (missed, time))

    def _take_disc(self, image: Image, color: ColorModel, disc: Disc, when: tuple[float, bool], sure: float) -> bool:
        """Take a disc of the network, unless that is not sure and the region there is another shape."""
        there = Gate(*disc.circle)
        if disc.log_odds <= sure and self._is_other_shape(image, there):
            return False
        self._step.take_disc(image, color, there, covariance_of(disc), when)
        return True

    def _is_other_shape(self, image: Image, disc: Gate) -> bool:
        """Whether the region at a disc is seen to be another shape."""
        state = self._step.fitter.family.from_coarse(*disc).state
        return self._step.outlines.is_other_shape(image, state)

    def _take_by_network(
        self, image: Image, color: ColorModel, last: Gate, expected: Gate | None, when: tuple[float, float]
    ) -> bool:
        """Take what the network sees where the target is expected, was last or may have gone, if it is alike."""
        (missed, time), limits = when, self._parameters.network
        if self._color is None or not limits.used:
            return False
        prior = _Expected(expected or last, self._half_width, missed)
        reach = self._parameters.disc_search.reach * missed * self._half_width
        near = [last] if expected is None else [expected, last]
        best = self._likeliest(image, near, prior, reach)
        if best is None:
            return False
        disc = best[1]
        if disc.log_odds > limits.renewed:
            self._color = self._step.outlines.network.median_color(image, disc.circle)
            self._half_width = disc.circle[2]
        return self._take_disc(image, color, disc, (time, expected is None), limits.renewed)

    def _likeliest(
        self, image: Image, near: Sequence[Gate], prior: "_Expected", reach: float
    ) -> tuple[float, Disc] | None:
        """Likeliest disc near some places, or where something stands out, if its log-odds are enough."""
        search, color, network = self._search, self._color, self._step.outlines.network
        assert color is not None
        around, places = prior.place._replace(half_width=self._half_width), list[Gate]()
        search.begin_picture()
        for side in (reach, float(max(image.shape))):  # what is far off does not take the place of what is near
            places += search.about(image, color, around, side)
        larger = [each._replace(half_width=search.limits.larger * each.half_width) for each in places]
        likely = self._likely(image, [*near, *larger], prior)
        for place in places:
            if all(place.distance(Gate(*disc.circle)) > place.half_width for _, disc in likely):
                search.in_vain(place)
        best = max(likely, key=lambda each: each[0], default=None)
        return best if best is not None and best[0] > network.limits.lost else None

    def _likely(self, image: Image, places: Sequence[Gate], prior: "_Expected") -> list[tuple[float, Disc]]:
        """Discs that the network sees about some places; before each, the log-odds that it is the target."""
        network, color, likely = self._step.outlines.network, self._color, list[tuple[float, Disc]]()
        assert color is not None
        for disc in network.discs(image, [np.array(each[:3]) for each in places], searched=True):
            odds = network.alike(image, disc, color)
            if odds is not None and (known := prior.log_odds(Gate(*disc.circle), network.limits)) is not None:
                likely.append((odds + known, disc))
        return likely

    def begin(self, image: Image, color: ColorModel, clicked: Gate, time: float) -> bool:
        """Begin with a disc that the network sees at the click, or one that looks as what was clicked; whether one is.

        Parameters
        ----------
        image, color, time
            See `remember`.
        clicked : Gate
            Circle around the click.
        """
        step = self._step
        if not step.outlines.is_disc or color.sample is None:
            return False
        network = step.outlines.network
        limits = network.limits
        disc = likeliest(network.discs(image, [np.array(clicked[:3])]), limits.sure, limits.same)
        if disc is not None:
            self._color, self._half_width = network.median_color(image, disc.circle), disc.circle[2]
            return self._take_disc(image, color, disc, (time, True), limits.clicked)
        return False
