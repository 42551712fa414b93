"""Where the shape will be in the next frame: constant velocity, and how far that has been wrong lately."""

import math

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]

TRUST = 0.7  # share of the latest change that the velocity follows: 1 is quick and noisy, 0 never learns
MEMORY = 0.8  # share of the spread that a frame as predicted leaves
FADE = 0.25  # s after which a velocity without a sighting has faded to 1/e
PROMPT = 0.05  # s without a sighting from which it fades


@kernel
def _correct(state: Floats, velocity: Floats, spread: Floats, seen: Floats, passed: float, count: int) -> None:
    """Take in the state that was seen `passed` seconds after the last one."""
    for k in range(state.shape[0]):
        if passed > 0.0:
            missed = seen[k] - state[k] - velocity[k] * passed
            if k < count:
                velocity[k] += TRUST / passed * missed
                spread[k] = max(abs(missed), MEMORY * spread[k] + (1.0 - MEMORY) * abs(missed))
        state[k] = seen[k]
    spread[0] = spread[1] = max(spread[0], spread[1])


class Motion:
    """State and velocity of a shape that is followed.

    Parameters
    ----------
    state : ndarray of shape (s,), float64
        State at the first sighting.
    time : float
        When that was, s.
    spread : float
        How far from it the next sighting may be, px.
    count : int
        How many of the state's numbers move: the shape's parameters. The others are modes and keep still.

    Attributes
    ----------
    velocity : ndarray of shape (s,), float64
        Per second.
    spread : ndarray of shape (count,), float64
        By how much the predictions of the parameters have lately missed.
    """

    def __init__(self, state: Floats, time: float, spread: float, count: int) -> None:
        self.state = state.copy()
        self.time = time
        self.velocity = np.zeros_like(state)
        self.spread = np.full(count, spread)

    @property
    def surprise(self) -> float:
        """By how much the center was lately not where it was predicted, px."""
        return float(self.spread[0])

    def predict(self, time: float) -> Floats:
        """State at a time, extrapolated; the velocity fades while nothing is seen.

        Parameters
        ----------
        time : float
            s, not before the last sighting.

        Returns
        -------
        ndarray of shape (s,), float64
        """
        ahead = time - self.time
        if ahead > PROMPT:
            ahead = FADE * (1.0 - math.exp(-ahead / FADE))
        predicted: Floats = self.state + ahead * self.velocity
        return predicted

    def correct(self, state: Floats, time: float) -> None:
        """Take in a sighting.

        Parameters
        ----------
        state : ndarray of shape (s,), float64
        time : float
            s.
        """
        _correct(self.state, self.velocity, self.spread, state, time - self.time, len(self.spread))
        self.time = time
