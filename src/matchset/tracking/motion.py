"""Where the shape will be in the next frame: constant velocity, and how far that has been wrong lately."""

import math

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]

TRUST = 0.7  # share of the latest change that the velocity follows: 1 is quick and noisy, 0 never learns
MEMORY = 0.8  # share of the spread that a frame as predicted leaves
FADE = 0.25  # s after which a velocity without a sighting has faded to 1/e
LEAST = 0.3  # px: no prediction is trusted to be better
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


@kernel
def _predict(
    state: Floats,
    velocity: Floats,
    spread: Floats,
    ahead: float,
    missed: float,
    trust: float,
    expected: Floats,
    room: Floats,
) -> tuple[float, float]:
    """Extrapolate by `ahead` seconds; returns the speed, px/s, and the surprise, px."""
    for k in range(state.shape[0]):
        expected[k] = state[k] + ahead * velocity[k]
    for k in range(spread.shape[0]):
        room[k] = missed * (trust * spread[k] + LEAST)
    return math.hypot(velocity[0], velocity[1]), spread[0]


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
    room : ndarray of shape (count,), float64
        How far each parameter may be from the last prediction.
    speed, surprise : float
        Speed of the center at the last prediction, px/s, and by how much it has lately missed, px.
    """

    def __init__(self, state: Floats, time: float, spread: float, count: int) -> None:
        self.state = state.copy()
        self.time = time
        self.velocity = np.zeros_like(state)
        self.spread = np.full(count, spread)
        self.expected, self.room = state.copy(), np.zeros(count)
        self.speed, self.surprise = 0.0, spread

    def predict(self, time: float, missed: float, trust: float) -> Floats:
        """State at a time, extrapolated; the velocity fades while nothing is seen.

        Parameters
        ----------
        time : float
            s, not before the last sighting.
        missed : float
            Frames since then.
        trust : float
            How many recent surprises each parameter may be off: written to `room`.

        Returns
        -------
        ndarray of shape (s,), float64
            Valid until the next prediction.
        """
        ahead = time - self.time
        if ahead > PROMPT:
            ahead = FADE * (1.0 - math.exp(-ahead / FADE))
        self.speed, self.surprise = _predict(
            self.state, self.velocity, self.spread, ahead, missed, trust, self.expected, self.room
        )
        return self.expected

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
