"""What is believed of a ball between two pictures: `Belief`. It is replaced, never changed."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.places.changes import Reference

Floats = npt.NDArray[np.float64]


class Belief(NamedTuple):
    """Everything that is known of a ball, but for its motion, which the workspace of the fit holds.

    Attributes
    ----------
    circle : (x, y, radius)
        As it was seen last, px.
    size : (float, float)
        ln(radius / px) as it is believed, and since when, s.
    lab : ndarray of shape (3,), float64
        Median color of its middle, CIE Lab.
    pixel : ndarray of shape (channels,), float32
        The same as a pixel.
    time : float
        When color and reference were renewed last, s.
    searched : int
        How many pictures were searched for it so far; says which part of a picture is searched next.
    reference : Reference or None
        With what motion is seen.
    way : float
        Length of the streak that was clicked, px, whose color is mixed with what is behind it; 0 of a disc.
    in_vain : tuple of (x, y, int)
        Places at which no ball was seen, and in which of the searched pictures.
    """

    circle: Circle3
    size: tuple[float, float]
    lab: Floats
    pixel: npt.NDArray[np.float32]
    time: float
    searched: int = 0
    reference: Reference | None = None
    way: float = 0.0
    in_vain: tuple[tuple[float, float, int], ...] = ()
