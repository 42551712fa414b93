"""Where a target is whose outline no edges confirm: `WithoutOutline`.

Last of all, where the fit and the search found nothing, a disc counts that has the target's color
(`search.color_disc`), or else one that looks as it did (`search.template`). Nothing is learned from it but its looks.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.fitting.validation import Prior
from matchset.image.color import ColorModel
from matchset.tracking.motion import Gate
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.color_disc import ColorDiscs
from matchset.tracking.search.prominence import Prominence
from matchset.tracking.search.template import Template
from matchset.tracking.track_step import TrackStep

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
        self.seen = False

    def forget(self) -> None:
        """Be as one is that has seen nothing."""
        self._discs.forget()
        self._template.forget()
        self.seen = False

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
        if self._step.is_disc:
            self._template.learn(image, seen, time)

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
        if not step.is_disc:
            return False
        missed = step.missed(time, interval)
        if step.fitter.weighs(color):
            disc = self._discs.find(image, color, expected, missed) if expected else None
            found = disc or self._discs.find_anywhere(image, color, last.half_width)
            sigma = parameters.color_disc.sigma
            if found and step.take_disc(image, color, Gate(*found[:3]), sigma, (time, disc is None)):
                return True
        like = self._template.find(image, expected, missed, time) if expected else None
        sigma = parameters.template.sigma
        return like is not None and step.take_disc(image, color, Gate(*like[:3]), sigma, (time, False))

    def begin(self, image: Image, color: ColorModel, clicked: Gate, time: float) -> bool:
        """Begin with a disc that looks as what was clicked, about where that was; whether there was one.

        Parameters
        ----------
        image, color, time
            See `remember`.
        clicked : Gate
            Circle around the click.
        """
        step, template, sample = self._step, self._template, color.sample
        if not step.is_disc or sample is None:
            return False
        template.learn(sample.image, Gate(*sample.circle), time)
        like, sigma = template.find(image, clicked, 1.0, time), self._parameters.template.sigma
        return like is not None and step.take_disc(image, color, Gate(*like[:3]), sigma, (time, True))
