"""Poses over time: smoothed, outliers gated, extrapolated to when a command will act: `PoseFilter`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.localization.pose import UNSEEN, Observed, Pose
from matchset.numeric.kalman import advance, correct
from matchset.numeric.linalg import rotate, turn_from
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]


class FilterParameters(msgspec.Struct, frozen=True):
    """How poses are filtered.

    Parameters
    ----------
    acceleration : float
        How much the ball accelerates against the camera: root of the spectral density, m/s^2 per root of Hz. About
        its strength times the root of twice the time it lasts. More follows sooner and smooths less.
    turning : float
        The same for its turning, rad/s^2 per root of Hz.
    speed, spin : float
        Standard deviation of a speed that is not known yet, m/s and rad/s.
    lasting : float
        Share of a pose's variance that frames have in common (shading, the lens), which no averaging takes away.
    gate : float
        Largest squared deviation from the prediction, in standard deviations, that is believed: 16.3 leaves out one
        good pose in a thousand.
    patience : int
        How many poses in a row may be left out before the next one is believed and all begins anew.
    memory : float
        How long after the last pose it is extrapolated, s.
    """

    acceleration: float = 0.7
    turning: float = 3.0
    speed: float = 1.0
    spin: float = 1.0
    lasting: float = 0.3
    gate: float = 16.3
    patience: int = 3
    memory: float = 0.5


class _Motion:
    """Three numbers and their speeds at a time."""

    def __init__(self, noise: float, speed: float) -> None:
        self.noise, self.speed = float(noise), float(speed)
        self.time, self.refused = -math.inf, 0
        self.state, self.covariance, self.lasting = np.zeros(6), np.zeros((6, 6)), np.zeros((3, 3))

    def begin(self, time: float, spread: Floats, start: Floats) -> None:
        self.time, self.refused = time, 0
        self.state[:3], self.state[3:] = start, 0.0
        self.covariance[:] = 0.0
        self.covariance[:3, :3] = spread
        self.covariance[3:, 3:] = self.speed**2 * np.eye(3)

    def at(self, time: float) -> tuple[Floats, Floats]:
        """State and covariance at a later time."""
        state, covariance = self.state.copy(), self.covariance.copy()
        advance(state, covariance, float(time - self.time), self.noise)
        return state, covariance


def precompile() -> None:
    """Compile the kernels of a filter, so that no frame waits for them."""
    state, covariance, turn = np.zeros(6), np.eye(6), np.eye(3)
    advance(state, covariance, 0.0, 0.0)
    correct(state, covariance, np.zeros(3), np.eye(3), 1.0)
    turn_from(turn, turn, state[:3])
    rotate(turn, state[:3])


class PoseFilter:
    """Filters the poses of one ball: constant velocity, and constant turning where the rotation is observed.

    Place and rotation are filtered apart; what their errors have in common is left out.

    Parameters
    ----------
    parameters : FilterParameters, optional
    """

    def __init__(self, parameters: FilterParameters | None = None) -> None:
        self.parameters = parameters or FilterParameters()
        self._move = _Motion(self.parameters.acceleration, self.parameters.speed)
        self._spin = _Motion(self.parameters.turning, self.parameters.spin)
        self._turn = np.eye(3)
        self._observed: Observed = "position"
        self._time = -math.inf
        precompile()

    def update(self, pose: "Pose | Lost[Pose]") -> bool:
        """Take in the next pose.

        Parameters
        ----------
        pose : Pose or Lost
            Later than the one before, by any time; a `Lost` changes nothing.

        Returns
        -------
        bool
            Whether its position was believed.

        Raises
        ------
        ValueError
            If the time does not run forward.
        """
        if not pose.time > self._time:
            raise ValueError(f"time must run forward: a pose at {pose.time} s follows one at {self._time} s")
        self._time = pose.time
        if isinstance(pose, Lost):
            return False
        if pose.turn is not None:
            self._take_turn(pose, pose.turn)
        return self._take_place(pose)

    def predict(self, now: float) -> "Pose | Lost[Pose]":
        """Pose at a time, with the covariance that it has grown to.

        Parameters
        ----------
        now : float
            s, on the clock of the poses, not before the last of them: when a command will act.

        Returns
        -------
        Pose or Lost
            `Lost` before the first pose and when the last is too old. Its rotation is None if that was not observed
            for so long.

        Raises
        ------
        ValueError
            If `now` is before the last pose, or not finite.
        """
        if not self._time <= now < math.inf:
            raise ValueError(f"a prediction is for {self._time} s or later, got {now} s")
        if not now - self._move.time <= self.parameters.memory:
            never = self._move.time == -math.inf
            return Lost("no pose yet" if never else f"the last pose is {now - self._move.time:.2f} s old", now)
        state, spread = self._move.at(now)
        covariance = np.zeros((6, 6))
        covariance[:3, :3] = spread[:3, :3] + self._move.lasting
        turn, observed = None, self._observed
        if now - self._spin.time <= self.parameters.memory:
            turned, spread = self._spin.at(now)
            turn = self._turn.copy()
            rotate(turn, turned[:3])
            covariance[3:, 3:] = spread[:3, :3] + self._spin.lasting
        else:
            covariance[3:, 3:], observed = UNSEEN * np.eye(3), "position"
        return Pose(position=state[:3], turn=turn, covariance=covariance, observed=observed, time=now)

    def _take_place(self, pose: Pose) -> bool:
        """Correct the position by a pose, or begin anew with it."""
        return self._take(self._move, pose.time, pose.position, pose.covariance[:3, :3])

    def _take_turn(self, pose: Pose, turn: Floats) -> None:
        """Correct the rotation by a pose; its state is the rotation vector from `_turn`, which then takes it up."""
        spin = self._spin
        away = np.empty(3)
        turn_from(self._turn, np.array(turn, np.float64), away)
        if self._take(spin, pose.time, away, pose.covariance[3:, 3:]):
            self._observed = pose.observed
        rotate(self._turn, spin.state[:3])
        spin.state[:3] = 0.0

    def _take(self, motion: _Motion, time: float, seen: Floats, spread: Floats) -> bool:
        """Correct a motion by what was seen; False if it was not believed."""
        limits = self.parameters
        fresh = (1.0 - limits.lasting) * spread
        if not time - motion.time <= limits.memory or motion.refused >= limits.patience:
            motion.begin(time, fresh, seen)
        else:
            state, covariance = motion.at(time)
            wide = np.array(spread, np.float64)  # the gate must not shut out what frames have in common
            if correct(state, covariance, seen - state[:3], wide, float(limits.gate)) > limits.gate:
                motion.refused += 1
                return False
            motion.state, motion.covariance = state, covariance
            motion.time, motion.refused = time, 0
        motion.lasting = limits.lasting * spread
        return True
