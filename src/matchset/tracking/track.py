"""What a tracker answers: `Track` where this frame's pixels confirm the shape, `Lost` where they do not."""

from typing import Generic, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

S = TypeVar("S")


class Track(msgspec.Struct, Generic[S], frozen=True):
    """A shape that this frame's own pixels confirm.

    Parameters
    ----------
    shape : S
        The shape, px and rad.
    covariance : ndarray of shape (p, p), float64
        Covariance of the shape's parameters, in their order.
    support : float
        Share of the outline (as far as it lies in the picture) that edge points confirm, 0 ... 1.
    match_set : ndarray of shape (m, 2), float64
        The edge points that decided the fit, px (Epstein & Feldman, Eq. 4); gross outliers are left out.
    time : float
        The frame's time, s.
    """

    shape: S
    covariance: npt.NDArray[np.float64]
    support: float
    match_set: npt.NDArray[np.float64]
    time: float


class Lost(msgspec.Struct, Generic[S], frozen=True):
    """No shape in this frame, and why; false in a condition.

    Parameters
    ----------
    reason : str
        In words a user understands.
    time : float
        The frame's time, s.
    predicted : S or None
        Where the motion says the shape is, while the tracker coasts.
    """

    reason: str
    time: float
    predicted: S | None = None

    def __bool__(self) -> bool:
        return False
