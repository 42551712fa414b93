"""Lets the target's color follow the light while its shape is well confirmed: `ColorAdapting`."""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.image.color import ColorModel
from matchset.image.light.color_adaptation import AdaptationParameters, adapt_table, adaptation_block
from matchset.image.light.relighting import RelightingParameters, gains_between, relit, thinned

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Image = npt.NDArray[np.uint8]


class ColorAdapting:
    """Adapts a color to what is inside and around a shape.

    Parameters
    ----------
    limits : AdaptationParameters
    relighting : RelightingParameters
    """

    def __init__(self, limits: AdaptationParameters, relighting: RelightingParameters) -> None:
        self._limits, self._block, self._relighting = limits, adaptation_block(limits), relighting
        self._learned = np.zeros(0, np.float32)
        self._kept: tuple[Image, Singles] | None = None

    def begin(self, color: ColorModel) -> None:
        """Take a color as it was learned: it is not forgotten.

        Parameters
        ----------
        color : ColorModel
        """
        self._learned, self._kept = color.log_odds.copy(), None

    def adapt(self, image: Image, color: ColorModel, fitter: Fitter[Any], frames: int) -> None:
        """Adapt to a shape that is whole and well confirmed, a quarter of its surroundings at a time.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
            Changed in place.
        fitter : Fitter
            With the fit of this picture.
        frames : int
            How many pictures there were.
        """
        limits = self._limits
        if frames % limits.period or color.gray == "edges" or not limits.rate > 0.0:
            return
        fit = fitter.statistics
        whole = fit.visible == fitter.points and fit.inliers >= limits.min_support * fit.visible
        if whole and fit.interior_share >= limits.min_interior:
            outline, interior, tables = fitter.outline, fitter.interior, (color.log_odds, self._learned, color.table)
            x, y = fitter.state.tolist()[:2]
            adapt_table(image, *tables, outline, interior, x, y, frames // limits.period, self._block)

    def keep(self, image: Image, color: ColorModel) -> None:
        """Keep a color, and a few pixels of a picture (h, w, channels), uint8, in whose light it is right."""
        if self._relighting.used and not color.gray:
            self._kept = thinned(image, self._relighting.side), color.log_odds.copy()

    def relight(self, image: Image, color: ColorModel) -> tuple[ColorModel, Floats] | None:
        """Take the color that was kept in the light of a picture, as of `keep`, where that has changed as a whole.

        Returns
        -------
        ColorModel
        ndarray of shape (channels,), float64
            By which the channels of all pixels were multiplied since then.
        """
        if self._kept is None:
            return None
        view, log_odds = self._kept
        gains = gains_between(view, thinned(image, self._relighting.side), self._relighting)
        if gains is None:
            return None
        changed = relit(color, log_odds, gains)
        self.begin(changed)
        self.keep(image, changed)
        return changed, gains
