"""Steps of brightness and tint, as automatic exposure and white balance make or settle them: `ControlSteps`."""

import math

import msgspec

from matchset.numeric.arguments import require_within

Gain = tuple[float, float, float]


class ControlSteps(msgspec.Struct, frozen=True, kw_only=True):
    """Sudden steps of brightness and tint.

    Every other step goes up, the others back. Without settling the camera itself made the step (it chose another
    exposure or white balance) and the level stays until the next one. With settling the light made it, and the camera
    takes it back: after t seconds ``exp(-t / settling)`` of its logarithm are left.

    Parameters
    ----------
    brightness : float
        Factor of a step up, 1/8 ... 8. 1: none. From about 2 on bright surfaces saturate.
    tint : float
        Share by which blue rises and red falls in a step up, -0.9 ... 0.9. 0: none.
    every : float
        From one step to the next, s; the first comes after half of it.
    settling : float
        Time constant of the way back, s. 0: none. Phones take about 0.3 s.
    """

    brightness: float = 1.0
    tint: float = 0.0
    every: float = 1.5
    settling: float = 0.0

    def __post_init__(self) -> None:
        limits = {"brightness": (0.125, 8.0), "tint": (-0.9, 0.9), "every": (1e-3, 1e6), "settling": (0.0, 1e6)}
        require_within(self, limits, "of steps lies in")

    def gain(self, seconds: float) -> Gain:
        """Gain of B, G and R at some time.

        Parameters
        ----------
        seconds : float
            Time in the clip, s.

        Returns
        -------
        tuple of 3 floats
            1 is unchanged.
        """
        share = self._share(seconds)
        level = self.brightness**share
        return level * (1.0 + share * self.tint), level, level * (1.0 - share * self.tint)

    def _share(self, seconds: float) -> float:
        """Share of a step up that is there now: 0 or 1 without settling, else the rest of all steps so far."""
        done = math.floor(seconds / self.every + 0.5)
        if self.settling <= 0.0:
            return float(done % 2) if done > 0 else 0.0
        ages = [(seconds - (k - 0.5) * self.every, 1.0 if k % 2 else -1.0) for k in range(1, done + 1)]
        return sum(sign * math.exp(-age / self.settling) for age, sign in ages)
