"""The compiled step from one frame to the next (Epstein & Feldman, Alg. 3), and the fitter that takes it."""

import functools
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter, FittingParameters
from matchset.fitting.local_fit import make_local_fit
from matchset.fitting.validation import Rejection
from matchset.numeric.jit import kernel
from matchset.numeric.record import Block
from matchset.shapes.shape import Shape
from matchset.tracking.motion import correct, predict

S = TypeVar("S", bound=Shape)
Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]


@functools.cache
def make_track_step(
    trace: Callable[..., Any], half_width: Callable[..., Any], layout: "np.dtype[np.void]"
) -> Callable[[Bytes, Scores, Block, float, float], int]:
    """Compile the step for a family of shapes.

    Parameters
    ----------
    trace, half_width : callable
        Compiled, see `Shape`.
    layout : dtype
        Of the workspace.

    Returns
    -------
    callable
        ``track_step(image, table, block, time, interval)``: into the frame at a time, s, an interval after the one
        before; returns the `Rejection`. An interval of 0 only fits, near the state and by the window in the workspace:
        one function for both, since the fit is most of what is compiled.
    """
    fit_locally = make_local_fit(trace, half_width)

    @kernel(refcount=False)
    def track_step(image: Bytes, table: Scores, block: Block, time: float, interval: float) -> int:
        work = block.view(layout)[0]
        if interval > 0.0:
            predict(work, time, interval)
        rejection = fit_locally(image, table, work)
        if interval > 0.0 and rejection == Rejection.NONE.value:
            rejection = correct(work, time)
        return rejection

    return track_step


def tracking_fitter(
    family: type[S], points: int, parameters: FittingParameters | None = None, uses_color: bool = True
) -> Fitter[S]:
    """Make a `Fitter` whose compiled function is the step of a tracker."""
    return Fitter(family, points, make_track_step, parameters, uses_color)
