"""Can it be the same shape? Where one is expected, and how far from there it may turn up."""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.tracking.parameters import TrackerParameters


class Place(NamedTuple):
    """Center and half-width of a shape, px."""

    x: float
    y: float
    size: float

    def about(self, other: "Place") -> bool:
        """Whether a shape found again at `other` is about where this prediction has it."""
        far = math.hypot(other.x - self.x, other.y - self.y)
        return 0.8 * self.size < other.size < 1.25 * self.size and far < 0.5 * self.size

    def reachable(self, other: "Place", missed: float, limits: TrackerParameters) -> bool:
        """Whether a shape can have come from here to `other`.

        Parameters
        ----------
        other : Place
        missed : float
            Frames since the last sighting.
        limits : TrackerParameters
            Its `growth` and `jump` count.
        """
        larger, smaller = max(self.size, other.size), min(self.size, other.size)
        far = math.hypot(other.x - self.x, other.y - self.y)
        return larger <= smaller * limits.growth**missed and far <= limits.jump * larger * missed + 10.0


def place_of(family: type[Any], state: npt.NDArray[np.float64]) -> Place:
    """Center and size of a state of a family of shapes."""
    return Place(float(state[0]), float(state[1]), float(family.half_width(state)))
