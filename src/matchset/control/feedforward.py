"""Feedforward of a neighbor's speed: `SpeedFeedforward`, a first-order low-shelf filter.

A follower that flies along with the whole speed of its neighbor, predicted for the time at which a command acts,
amplifies it: in a chain each vehicle oscillates more than the one before (string stability, Swaroop & Hedrick 1996). So
slow changes of the speed are passed with gain 1 and fast ones with a gain k below 1: with the crossover time T,

    H(s) = (1 + k T s) / (1 + T s),

computed as ``low + k (v - low)`` with the low-passed speed ``low' = (v - low) / T``.
"""

import msgspec

from matchset.numeric.arguments import require_positive, require_share


class FeedforwardParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of a `SpeedFeedforward`.

    Parameters
    ----------
    high_frequency_gain : float
        Gain k of fast changes, 0 ... 1. More stays closer to a neighbor that moves, and passes its oscillation on with
        a larger amplitude. Chosen by: the search of decision 074; 1.0 makes chains of ten crash.
    crossover_time : float
        Time constant T that separates slow from fast, s. More passes less oscillation on, and falls behind a neighbor
        that speeds up. Chosen by: the search of decision 074.
    """

    high_frequency_gain: float = 0.7
    crossover_time: float = 0.23

    def __post_init__(self) -> None:
        require_share(self, ("high_frequency_gain",))
        require_positive(self, ("crossover_time",))


class SpeedFeedforward:
    """Filters one coordinate of a neighbor's speed.

    Parameters
    ----------
    parameters : FeedforwardParameters
    """

    def __init__(self, parameters: FeedforwardParameters) -> None:
        self.parameters = parameters
        self._low: float | None = None

    def update(self, speed: float, step: float) -> None:
        """Update the low-passed speed.

        Parameters
        ----------
        speed : float
            The neighbor's speed now, m/s.
        step : float
            Time since the last update, s.
        """
        if self._low is None:
            self._low = speed
        self._low += (speed - self._low) * step / (self.parameters.crossover_time + step)

    def output(self, speed: float) -> float:
        """Return the part of a speed that is flown, m/s; before the first update all of it."""
        low = speed if self._low is None else self._low
        return low + self.parameters.high_frequency_gain * (speed - low)
