"""Whether what was clicked is a ring, as on a printed marker: `is_ring`."""

from collections.abc import Callable

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.circle_score import Sample


class RingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What is a ring. Chosen by hand on rendered rings and on clicks on real balls, of which none may be one.

    Parameters
    ----------
    inner, rim : float
        From which share of its radius circles around the middle are looked at, and from which they are the rim.
    width : float
        Of such a circle, as a share of the radius.
    filled : float
        Least share of a circle at the rim that has the color: more leaves out rings that were not clicked exactly.
    empty : float
        Largest share of one further in that has it: more takes balls with a large highlight for rings, which are then
        followed by their outline alone.
    """

    inner: float = 0.3
    rim: float = 0.8
    width: float = 0.1
    filled: float = 0.6
    empty: float = 0.25


def is_ring(
    scores: Callable[[npt.NDArray[np.uint8]], npt.NDArray[np.int8]],
    sample: Sample,
    parameters: RingParameters | None = None,
) -> bool:
    """Whether a clicked disc has the target's color at its rim, and all around its middle another one.

    Parameters
    ----------
    scores : callable
        Of pixels: positive where they look like the target.
    sample : Sample
    parameters : RingParameters, optional
    """
    limits = parameters or RingParameters()
    x, y, radius = sample.circle
    rows, columns = np.indices(sample.image.shape[:2])
    share = np.hypot(columns - x, rows - y) / radius
    colored = scores(sample.image).reshape(share.shape) > 0
    circles = [
        (low, colored[(low <= share) & (share < low + limits.width)])
        for low in np.arange(limits.inner, 1.0, limits.width)
    ]
    rim = [float(circle.mean()) for low, circle in circles if circle.size and low + 1e-9 >= limits.rim]
    inside = [float(circle.mean()) for low, circle in circles if circle.size and low + 1e-9 < limits.rim]
    return max(rim, default=0.0) > limits.filled and min(inside, default=1.0) < limits.empty
