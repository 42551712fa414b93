"""Lets the target's color follow the light while its shape is well confirmed: `ColorAdapting`."""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.image.color import ColorModel
from matchset.image.color_adaptation import AdaptationParameters, adapt_table, adaptation_block

Image = npt.NDArray[np.uint8]


class ColorAdapting:
    """Adapts a color to what is inside and around a shape.

    Parameters
    ----------
    limits : AdaptationParameters
    """

    def __init__(self, limits: AdaptationParameters) -> None:
        self._limits, self._block = limits, adaptation_block(limits)
        self._learned = np.zeros(0, np.float32)

    def begin(self, color: ColorModel) -> None:
        """Take a color as it was learned: it is not forgotten.

        Parameters
        ----------
        color : ColorModel
        """
        self._learned = color.log_odds.copy()

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
            quadrant = frames // limits.period % 4
            adapt_table(image, *tables, outline, interior, x, y, quadrant, self._block)
