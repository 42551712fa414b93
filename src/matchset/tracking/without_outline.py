"""Where a target is whose outline no edges confirm: `WithoutOutline`.

Last of all, where the fit and the search found nothing, a disc counts that has the target's color
(`search.color_disc`), one that the network sees there (`image/disc_network`), or else one that looks as it did
(`search.template`). Nothing is learned from it but its looks.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.fitting.validation import Prior
from matchset.image.color import ColorModel
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.network_outlines import covariance_of, likeliest
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.color_disc import ColorDiscs
from matchset.tracking.search.prominence import Prominence
from matchset.tracking.search.template import Template
from matchset.tracking.track_step import TrackStep

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


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
        self._discs = ColorDiscs(parameters.color_disc, self.prominence)
        self._template = Template(parameters.template)
        self._color: Floats | None = None
        self.seen = False

    def forget(self) -> None:
        """Be as one is that has seen nothing."""
        self._discs.forget()
        self._template.forget()
        self.seen, self._color = False, None

    def remember(self, image: Image, color: ColorModel, seen: Gate, time: float) -> None:
        """Remember the color and the looks of a target whose outline is seen.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        seen : Gate
            Where it is.
        time : float
            Of the picture, s.
        """
        self.seen = True
        if self._step.fitter.weighs(color):
            self._discs.measure(image, color, seen)
        if self._step.outlines.is_disc:
            self._template.learn(image, seen, time)
            self._color = self._step.outlines.network.median_color(image, (seen.x, seen.y, seen.half_width))

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

    def take(
        self, image: Image, color: ColorModel, last: Gate, expected: Gate | None, time: float, interval: float
    ) -> bool:
        """Take a disc for the target about where it is expected, or anywhere by its color; whether there was one.

        Parameters
        ----------
        image, color, time
            See `remember`.
        last : Gate
            Where the target was seen last.
        expected : Gate or None
            Where it should be, if it was seen lately.
        interval : float
            Since the frame before, s.
        """
        step, parameters = self._step, self._parameters
        if not step.outlines.is_disc:
            return False
        missed = step.missed(time, interval)
        if step.fitter.weighs(color):
            disc = self._discs.find(image, color, expected, missed) if expected else None
            found = disc or self._discs.find_anywhere(image, color, last.half_width)
            if found and self._take(image, color, Gate(*found[:3]), parameters.color_disc.sigma, (time, disc is None)):
                return True
        if expected is None:
            return False
        if self._take_by_network(image, color, last, expected, (missed, time)):
            return True
        like = self._template.find(image, expected, missed, time)
        return like is not None and self._take(image, color, Gate(*like[:3]), parameters.template.sigma, (time, False))

    def _take(self, image: Image, color: ColorModel, disc: Gate, sigma: float, when: tuple[float, bool]) -> bool:
        """Take a disc whose parameters have a standard deviation, half-widths."""
        return self._step.take_disc(image, color, disc, (sigma * disc.half_width) ** 2 * np.eye(3), when)

    def _take_by_network(
        self, image: Image, color: ColorModel, last: Gate, expected: Gate, when: tuple[float, float]
    ) -> bool:
        """Take what the network sees where the target is expected or was last, if it has its size and color."""
        (missed, time), outlines, limits = when, self._step.outlines, self._parameters.network
        if self._color is None:
            return False
        likely = []
        for disc in outlines.network.discs(image, [np.array(each[:3]) for each in (expected, last)]):
            there, seen = Gate(*disc.circle), outlines.network.median_color(image, disc.circle)
            ratio = max(there.half_width, last.half_width) / min(there.half_width, last.half_width)
            possible = ratio < limits.growth and expected.reachable(there, missed, self._parameters.reach)
            if possible and seen is not None and outlines.network.is_alike(seen, self._color):
                likely.append(disc)
        best = likeliest(likely, limits.lost)
        if best is None:
            return False
        return self._step.take_disc(image, color, Gate(*best.circle), covariance_of(best), (time, False))

    def begin(self, image: Image, color: ColorModel, clicked: Gate, time: float) -> bool:
        """Begin with a disc that the network sees at the click, or one that looks as what was clicked; whether one is.

        Parameters
        ----------
        image, color, time
            See `remember`.
        clicked : Gate
            Circle around the click.
        """
        step, template, sample = self._step, self._template, color.sample
        if not step.outlines.is_disc or sample is None:
            return False
        network = step.outlines.network
        disc = likeliest(network.discs(image, [np.array(clicked[:3])]), network.limits.sure)
        if disc is not None:
            self._color = network.median_color(image, disc.circle)
            return step.take_disc(image, color, Gate(*disc.circle), covariance_of(disc), (time, True))
        template.learn(sample.image, Gate(*sample.circle), time)
        like = template.find(image, clicked, 1.0, time)
        return like is not None and self._take(
            image, color, Gate(*like[:3]), self._parameters.template.sigma, (time, True)
        )
