"""Detectors whose cells suit the size that is expected: `Detectors`."""

from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.shapes.shape import Shape
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.detector import Detector
from matchset.tracking.search.voting import Searcher, stride_for

S = TypeVar("S", bound=Shape)
Image = npt.NDArray[np.uint8]


class Detectors(Generic[S]):
    """Detectors of a family in pictures of one size, each made when it is needed first.

    Parameters
    ----------
    fitter : Fitter
        Fits their candidates.
    parameters : TrackerConstants
    """

    def __init__(self, fitter: Fitter[S], parameters: TrackerConstants) -> None:
        self._fitter, self._parameters = fitter, parameters
        self.forget()

    def forget(self) -> None:
        """Know no size of pictures."""
        self._made: dict[int, Detector[S]] = {}

    def suited(self, image: Image, half_width: float) -> Detector[S]:
        """Detector for a picture whose cells suit a shape of a half-width, px.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        half_width : float
            `math.inf` where nothing is known of it.
        """
        limits = self._parameters
        height, width = image.shape[:2]
        stride = stride_for(width, limits.search, half_width)
        if stride not in self._made:
            searcher = Searcher(width, height, limits.search, half_width)
            self._made[stride] = Detector(
                self._fitter, searcher, limits.detection, limits.hypotheses, limits.brightness
            )
        return self._made[stride]
