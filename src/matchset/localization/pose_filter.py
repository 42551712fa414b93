"""A Kalman filter for poses: smooths them, rejects outliers, predicts: `PoseFilter`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.localization.pose import UNOBSERVED_VARIANCE, Observed, Pose
from matchset.numeric.arguments import check_kind
from matchset.numeric.copies import Copied
from matchset.numeric.kalman import predict_constant_velocity, update
from matchset.numeric.rotation import rotate, rotation_vector_between
from matchset.numeric.words import one_line, short
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]


# geometry: the filter's six numbers are three and their speeds, of which the three are measured
MEASURED = np.eye(3, 6)


class FilterParameters(msgspec.Struct, frozen=True):
    """How poses are filtered.

    Parameters
    ----------
    acceleration : float
        Root of the spectral density of the ball's acceleration against the camera, m/s^2 per root of Hz: about its
        strength times the root of twice the time it lasts. More follows sooner and smooths less. Chosen by hand for
        small quadrotors; `python -m benchmarks --only localization_prediction` would show a change, as for the rest.
    angular_acceleration : float
        The same for its rotation, rad/s^2 per root of Hz.
    initial_speed, initial_angular_speed : float
        Standard deviation of a speed that is not known yet, m/s and rad/s.
    common_share : float
        Share of a pose's variance that neighboring frames have in common (shading, the lens): averaging does not
        reduce it.
    gate : float
        Largest squared Mahalanobis distance from the prediction of a pose that is used. 16.3 is the quantile 0.999 of
        chi-squared with three degrees of freedom: it rejects one good pose in a thousand.
    patience : int
        How many poses in a row are rejected before the next one initializes the filter again.
    memory : float
        How long after the last pose there is a prediction, s.
    """

    acceleration: float = 0.7
    angular_acceleration: float = 3.0
    initial_speed: float = 1.0
    initial_angular_speed: float = 1.0
    common_share: float = 0.3
    gate: float = 16.3
    patience: int = 3
    memory: float = 0.5


class _Motion:
    """State of three numbers and their speeds."""

    def __init__(self, noise: float, initial_speed: float) -> None:
        self.noise, self.initial_speed = float(noise), float(initial_speed)
        self.time, self.rejected = -math.inf, 0
        self.state, self.covariance, self.common = np.zeros(6), np.zeros((6, 6)), np.zeros((3, 3))

    def initialize(self, time: float, measured: Floats, covariance: Floats) -> None:
        """Begin with a measurement and no speed."""
        self.time, self.rejected = time, 0
        self.state[:3], self.state[3:] = measured, 0.0
        self.covariance[:] = 0.0
        self.covariance[:3, :3] = covariance
        self.covariance[3:, 3:] = self.initial_speed**2 * np.eye(3)

    def at(self, time: float) -> tuple[Floats, Floats]:
        """State and covariance at a later time."""
        state, covariance = self.state.copy(), self.covariance.copy()
        predict_constant_velocity(state, covariance, float(time - self.time), self.noise)
        return state, covariance


def precompile() -> None:
    """Compile the kernels of a filter, so that no frame waits for them."""
    state, covariance, rotation = np.zeros(6), np.eye(6), np.eye(3)
    predict_constant_velocity(state, covariance, 0.0, 0.0)
    update(state, covariance, np.zeros(3), MEASURED, np.eye(3), 1.0)
    rotation_vector_between(rotation, rotation, state[:3])
    rotate(rotation, state[:3])


class PoseFilter(Copied):
    """Kalman filter for the poses of one ball: constant velocity, and constant angular velocity if it is observed.

    Only `Pose.random_covariance` is filtered; `Pose.systematic_covariance`, which all poses share, is added to what is
    predicted, as the last pose had it.

    Position and rotation are filtered apart; the covariance between them is left out. The state of the rotation is the
    rotation vector from a reference, which then becomes the estimate (a multiplicative filter). Its kernels are
    compiled here.

    Parameters
    ----------
    parameters : FilterParameters, optional
    """

    def __init__(self, parameters: FilterParameters | None = None) -> None:
        check_kind("parameters", parameters, (FilterParameters, type(None)))
        self.parameters = parameters or FilterParameters()
        self._move = _Motion(self.parameters.acceleration, self.parameters.initial_speed)
        self._spin = _Motion(self.parameters.angular_acceleration, self.parameters.initial_angular_speed)
        self._reference = np.eye(3)
        self._observed: Observed = "position"
        self._time = -math.inf
        self._systematic: Floats | None = None
        self._make_derived()

    def _derive(self) -> None:
        precompile()

    @one_line
    def __repr__(self) -> str:
        last = "no pose yet" if self._time == -math.inf else f"{self._observed}, last pose at {short(self._time)} s"
        return f"PoseFilter({last})"

    def update(self, pose: "Pose | Lost[Pose]") -> bool:
        """Correct the filter by the next pose.

        Parameters
        ----------
        pose : Pose or Lost
            Later than the one before, by any time; a `Lost` changes nothing.

        Returns
        -------
        bool
            Whether its position was used.

        Raises
        ------
        ValueError
            If the time does not run forward.
        """
        check_kind("pose", pose, (Pose, Lost), "Localizer.update(ball) gives one")
        if not pose.time > self._time:
            raise ValueError(f"time must run forward: a pose at {pose.time} s follows one at {self._time} s")
        self._time = pose.time
        if isinstance(pose, Lost):
            return False
        random = pose.random_covariance
        if pose.rotation_matrix is not None:
            self._correct_rotation(pose, np.array(pose.rotation_matrix, np.float64), random[3:, 3:])
        used = self._correct(self._move, pose.time, pose.position, random[:3, :3])
        if used:
            self._take_systematic(pose)
        return used

    def predict(self, now: float) -> "Pose | Lost[Pose]":
        """Pose at a time, with the covariance that it has grown to.

        Parameters
        ----------
        now : float
            s, on the clock of the poses, not before the last of them: when a command will act.

        Returns
        -------
        Pose or Lost
            `Lost` before the first pose and when the last one is older than `memory`. The rotation is None if it was
            not observed for so long.

        Raises
        ------
        ValueError
            If `now` is before the last pose, or not finite.
        """
        try:
            later = self._time <= now < math.inf
        except TypeError:  # a word or None
            later = False
        if not later:
            raise ValueError(f"a prediction is for {self._time} s or later, got {now!r} s")
        if not now - self._move.time <= self.parameters.memory:
            never = self._move.time == -math.inf
            return Lost("no pose yet" if never else f"the last pose is {now - self._move.time:.2f} s old", now)
        state, predicted = self._move.at(now)
        covariance = np.zeros((6, 6))
        covariance[:3, :3] = predicted[:3, :3] + self._move.common
        rotation, observed = None, self._observed
        if now - self._spin.time <= self.parameters.memory:
            vector, predicted = self._spin.at(now)
            rotation = self._reference.copy()
            rotate(rotation, vector[:3])
            covariance[3:, 3:] = predicted[:3, :3] + self._spin.common
        else:
            covariance[3:, 3:], observed = UNOBSERVED_VARIANCE * np.eye(3), "position"
        systematic = None
        if self._systematic is not None:  # no average makes these errors smaller: they are added here
            systematic = self._systematic.copy()
            if rotation is None:
                systematic[3:] = systematic[:, 3:] = 0.0
            covariance += systematic
        return Pose(
            position=state[:3],
            rotation_matrix=rotation,
            covariance=covariance,
            observed=observed,
            time=now,
            systematic_covariance=systematic,
        )

    def _take_systematic(self, pose: Pose) -> None:
        """Take over the errors that all poses share; those of a rotation that was not observed stay as they were."""
        new, before = pose.systematic_covariance, self._systematic
        self._systematic = None if new is None else new.copy()
        if self._systematic is not None and before is not None and pose.rotation_matrix is None:
            self._systematic[3:], self._systematic[:, 3:] = before[3:], before[:, 3:]

    def _correct_rotation(self, pose: Pose, rotation: Floats, covariance: Floats) -> None:
        """Correct the rotation by that of a pose."""
        spin, vector = self._spin, np.empty(3)
        rotation_vector_between(self._reference, rotation, vector)
        if self._correct(spin, pose.time, vector, covariance):
            self._observed = pose.observed
        rotate(self._reference, spin.state[:3])
        spin.state[:3] = 0.0

    def _correct(self, motion: _Motion, time: float, measured: Floats, covariance: Floats) -> bool:
        """Correct a motion by a measurement, or initialize it; False if the measurement was rejected."""
        limits = self.parameters
        if not time - motion.time <= limits.memory or motion.rejected >= limits.patience:
            motion.initialize(time, measured, (1.0 - limits.common_share) * covariance)
        else:
            state, predicted = motion.at(time)
            noise = np.array(covariance, np.float64)  # all of it: the gate must pass what frames have in common
            gate = float(limits.gate)
            if update(state, predicted, measured - state[:3], MEASURED, noise, gate) > gate:
                motion.rejected += 1
                return False
            motion.state, motion.covariance = state, predicted
            motion.time, motion.rejected = time, 0
        motion.common = limits.common_share * covariance
        return True
