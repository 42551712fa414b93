"""How much of a neighbor's speed is flown along: `SpeedFeedforward`.

Who flies along with all that its neighbor does, and predicts it for the time of action, enlarges it: of a chain each
then wobbles more than the one before (string stability, Swaroop & Hedrick 1996). So the slow part of the speed is flown
along in full and of the quick part a share, ``slow + pace (v - slow)``, ``slow' = (v - slow) / calm``.
"""

import math

import msgspec


class FeedforwardParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What of a neighbor's speed is flown along.

    Parameters
    ----------
    share : float
        Of the quick part, 0 ... 1. More stays closer to a neighbor that moves, and hands its wobble on enlarged.
    calm : float
        Time constant that tells quick from slow, s. More hands on less, and falls behind a neighbor that moves off.
    """

    share: float = 0.7
    calm: float = 0.23

    def __post_init__(self) -> None:
        if not 0.0 <= self.share <= 1.0:
            raise ValueError(f"share must be within 0 ... 1, got {self.share}")
        if not 0.0 < self.calm < math.inf:
            raise ValueError(f"calm must be positive, got {self.calm}")


class SpeedFeedforward:
    """Follows one coordinate of a neighbor's speed.

    Parameters
    ----------
    parameters : FeedforwardParameters
    """

    def __init__(self, parameters: FeedforwardParameters) -> None:
        self.parameters = parameters
        self._slow: float | None = None

    def update(self, speed: float, step: float) -> None:
        """Take in the speed of this moment, `step` seconds after the last one."""
        if self._slow is None:
            self._slow = speed
        self._slow += (speed - self._slow) * step / (self.parameters.calm + step)

    def of(self, speed: float) -> float:
        """Tell what of a speed is flown along."""
        slow = speed if self._slow is None else self._slow
        return slow + self.parameters.share * (speed - slow)
