"""How much later a command shows in the pictures than was told: `DelayEstimator`.

The latency of a camera or of a radio that nobody measured: for a controller both are the same, a time from a command to
what a picture shows of it. `MotionConsistency` compares delays by what each leaves of the motion in the pictures; where
least is left is the delay. Between the delays a parabola is laid through the least and its neighbors (Jacovitti &
Scarano 1993, average square difference).
"""

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import require_not_negative, require_positive

Floats = npt.NDArray[np.float64]

TINY = 1e-15  # rad^2: least curvature


class DelayEstimatorParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of a `DelayEstimator`.

    Chosen on flights without pictures of seeds below 110 with latencies told wrong:
    docs/log/control.md#untold-latency. The range
    of the delay is that of the small delays of `MotionConsistencyParameters`.

    Parameters
    ----------
    noise : float
        Motion that says nothing, standard deviation, rad.
    contrast : float
        How much more than the noise, and than what is left at the best delay, must be left at the worst one before the
        delay is changed, no unit. More waits for larger motion.
    min_time, max_time : float
        Time constant with which the delay follows the best one at first, and at most, s; in between it is the time for
        which there was sufficient contrast, as in a mean. More is calmer.
    max_rate : float
        Largest rate of the delay, s/s; faster, dead reckoning would jump.
    """

    noise: float = 0.003
    contrast: float = 1.0
    min_time: float = 0.15
    max_time: float = 4.0
    max_rate: float = 0.5

    def __post_init__(self) -> None:
        require_positive(self, ("noise", "contrast", "min_time", "max_time"))
        require_not_negative(self, ("max_rate",))


class DelayEstimator:
    """Estimates an additional delay from commands to pictures.

    Parameters
    ----------
    delays : ndarray of float64
        Those that are compared, s beyond what was told, ascending in equal steps, 0 among them.
    parameters : DelayEstimatorParameters, optional

    Attributes
    ----------
    extra : float
        The additional delay, s, within the range of `delays`.
    """

    def __init__(self, delays: Floats, parameters: DelayEstimatorParameters | None = None) -> None:
        self.parameters = parameters or DelayEstimatorParameters()
        self.delays, self.extra = delays, 0.0
        self._delays: list[float] = delays.tolist()  # a few numbers: faster than NumPy's own
        self.reset()

    def reset(self) -> None:
        """Begin anew to learn; the delay stays: it is the camera's and the radio's."""
        self.seen = 0.0

    def update(self, left: Floats, step: float) -> None:
        """Follow the delay that leaves least.

        Parameters
        ----------
        left : ndarray of shape (n,)
            Mean square that each delay leaves, rad^2; all 0 while nothing is known.
        step : float
            Time since the last update, s.
        """
        parameters, values = self.parameters, left.tolist()
        least = min(values)
        if not max(values) - least > parameters.contrast * (parameters.noise**2 + least):
            return
        best = values.index(least)
        middle = min(max(best, 1), len(values) - 2)
        before, at, after = values[middle - 1 : middle + 2]
        first, last, curvature = self._delays[0], self._delays[-1], before - 2.0 * at + after
        goal = self._delays[best]
        if curvature > TINY:
            spacing = self._delays[1] - first
            goal = self._delays[middle] + 0.5 * spacing * (before - after) / curvature
        goal = min(max(goal, first), last)
        self.seen += step
        time = min(max(self.seen, parameters.min_time), parameters.max_time)
        limit = parameters.max_rate * step
        change = (goal - self.extra) * step / (time + step)
        self.extra += min(max(change, -limit), limit)
