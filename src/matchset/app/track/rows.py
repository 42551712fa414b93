"""What is written down for one frame: `Row`."""

import math
from typing import Any

import msgspec
import numpy as np

from matchset.tracking.track import Lost, Track

_DECIMALS = 4


class Row(msgspec.Struct, frozen=True):
    """The answer for one frame, as tables hold it.

    Parameters
    ----------
    frame : int
        Its place in the video, from 0, in decode order.
    time : float
        When it was taken, s.
    shape : dict of str to float, or None
        The shape's parameters by name, px and rad; None where it was not found.
    std : dict of str to float, or None
        Their standard deviations, by the same names; a parameter without a finite one is left out.
    support : float or None
        Share of the outline that was confirmed, 0 ... 1.
    reason : str
        Why it was not found, in words; empty where it was.
    """

    frame: int
    time: float
    shape: dict[str, float] | None = None
    std: dict[str, float] | None = None
    support: float | None = None
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether this frame's pixels confirm the shape."""
        return self.shape is not None

    @property
    def brief(self) -> str:
        """The shape in a few words, for a line that changes all the time; empty where it was not found."""
        named = list((self.shape or {}).items())[:3]
        return "  ".join(f"{'r' if name == 'radius' else name} {value:6.1f}" for name, value in named)


def row_of(frame: int, answer: Track[Any] | Lost[Any]) -> Row:
    """Turn a tracker's answer into the row of its frame.

    Parameters
    ----------
    frame : int
        The frame's index.
    answer : Track or Lost
        What `Tracker.update` returned for it.

    Returns
    -------
    Row
        With numbers rounded to 1e-4 px, far below any camera's noise.
    """
    if isinstance(answer, Lost):
        return Row(frame, answer.time, reason=answer.reason)
    names = answer.shape.parameters
    variances = np.diagonal(answer.covariance)
    return Row(
        frame=frame,
        time=answer.time,
        shape={name: round(float(getattr(answer.shape, name)), _DECIMALS) for name in names},
        std={
            name: round(math.sqrt(variance), _DECIMALS)
            for name, variance in zip(names, variances, strict=True)
            if math.isfinite(variance) and variance >= 0.0
        },
        support=round(float(answer.support), _DECIMALS),
    )
