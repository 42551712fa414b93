"""The slow part of three numbers, a steady drift included: `SlowPart`."""

from collections.abc import Sequence

# geometry: longest step of the integration, as a share of its time; it is stable up to 0.8
LONGEST_STEP = 0.25


class SlowPart:
    """Follows three numbers slowly: a critically damped filter of second order, without a lag behind a steady drift.

    With r = x - y, y the slow part of x, ``y' = v + 2 r / T`` and ``v' = r / T^2``; so of x there is
    ``s^2 / (s + 1 / T)^2`` in r. The first number that comes is taken for slow.

    Parameters
    ----------
    time : float
        T, s. More follows more slowly.

    Attributes
    ----------
    time : float
        T; may be changed.
    values : list of 3 floats
        The slow part.
    speeds : list of 3 floats
        Its rate, per second.
    """

    def __init__(self, time: float) -> None:
        self.time = time
        self.forget()

    def forget(self) -> None:
        """Know nothing."""
        self.values, self.speeds, self._drifts, self._begun = [0.0] * 3, [0.0] * 3, [0.0] * 3, False

    def update(self, values: Sequence[float], step: float) -> None:
        """Note the numbers, so many s after the last ones."""
        if not self._begun:
            self.values, self._begun = list(values), True
            return
        step = min(step, LONGEST_STEP * self.time)
        for k, value in enumerate(values):
            off = value - self.values[k]
            self.speeds[k] = self._drifts[k] + 2.0 * off / self.time
            self._drifts[k] += step * off / self.time**2
            self.values[k] += step * self.speeds[k]
