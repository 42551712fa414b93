"""How the neighbor moves, from poses seen by a vehicle that does not measure its own tilt: `NeighborFilter`.

In the frame at rest of dead reckoning each coordinate of the ball, and the way its marker points, is the sum of a drift
with an acceleration that lasts a while (Singer 1970), ``d'' = a, a' = -a/T + noise``, and a sway about the period of
what hangs on a rope, ``s'' = -w^2 s - 2 z w s' + noise``. A Kalman filter follows both. To the covariance of a pose
comes what the unmeasured tilt and turn of the vehicle do to it: a degree of tilt at 1.5 m looks like 26 mm.
"""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.dead_reckoning import PLACE, SIZE, turn_of
from matchset.control.ego_motion import EgoState
from matchset.control.neighbor_filter import PATIENCE, REFUSED, STATES, marker_way, predict, take, to_rest
from matchset.localization.pose import Pose
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
UNTURNED = np.empty((0, 0))
PLACED, TURNED = 1, 2  # what of a pose is believed; both are their sum


class NeighborFilterParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the neighbor's poses are filtered.

    Parameters
    ----------
    acceleration : float
        Standard deviation of the neighbor's acceleration and of what the dead reckoning misses, m/s^2. More follows
        sooner and smooths less.
    turning : float
        Standard deviation of its angular acceleration, rad/s^2.
    lasting, turn_lasting : float
        For how long such an acceleration lasts, s: of the place and of the turning.
    period : float
        Of the sway, s: 2.2 for a rope of 1.2 m. A neighbor that follows something that sways, sways with it.
    damping : float
        How far the sway is from a steady one, as a damping ratio: more forgives a wrong period, and predicts less.
    sway : float
        Standard deviation of the sway, m.
    turn_sway : float
        The same for the neighbor's turning, rad.
    tilt : float
        Standard deviation of the vehicle's own tilt about what its commands say, rad.
    yaw : float
        The same for its turning, rad.
    shared : float
        Least standard deviation of a place, m: what the shading and the lens do to all frames alike.
    gate : float
        Largest deviation from the prediction that is believed, standard deviations.
    jump : float
        Largest deviation from the prediction that is believed at all, m, however long it was not seen. Less than from
        the neighbor to the next one, whose ball looks the same; more than the neighbor may move unseen.
    patience : int
        How many poses in a row may be left out before the next one within a jump is believed and all begins anew.
    """

    acceleration: float = 0.52
    turning: float = 0.8
    lasting: float = 0.68
    turn_lasting: float = 1.0
    period: float = 2.2
    damping: float = 0.021
    sway: float = 0.075
    turn_sway: float = 0.03
    tilt: float = 0.025
    yaw: float = 0.01
    shared: float = 0.005
    gate: float = 5.0
    jump: float = 0.7
    patience: int = 10

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")


class NeighborFilter:
    """Filters one neighbor in the frame at rest; all kernels are compiled here.

    Parameters
    ----------
    parameters : NeighborFilterParameters, optional

    Attributes
    ----------
    time : float
        Of the last pose that was believed, s; -inf before the first.
    turn_time : float
        The same for the way its marker points.
    """

    def __init__(self, parameters: NeighborFilterParameters | None = None) -> None:
        self.parameters = parameters or NeighborFilterParameters()
        self.time = self.turn_time = -math.inf
        self._state = np.zeros((4, STATES))  # x, y, z, and the angle of the marker's way to the right of z
        self._covariance = np.zeros((4, STATES, STATES))
        self._limits = np.array([float(getattr(self.parameters, name)) for name in self.parameters.__struct_fields__])
        self._refused = np.zeros(2, np.int64)
        self._seen = np.zeros(3), np.zeros((6, 6)), np.zeros((3, 3))  # copies: a pose's arrays may be of any layout
        precompile()

    def update(self, pose: Pose, own: EgoState) -> bool:
        """Take in a pose in the camera frame, seen from a state of the vehicle at the same time.

        Returns
        -------
        bool
            Whether its position was believed.
        """
        position, covariance, turn = self._seen
        position[:], covariance[:] = pose.position, pose.covariance
        if pose.turn is not None:
            turn[:] = pose.turn
        believed = _take_in(
            position,
            covariance,
            UNTURNED if pose.turn is None else turn,
            own.numbers,
            pose.time - self.time,
            pose.time - self.turn_time,
            self._state,
            self._covariance,
            self._limits,
            self._refused,
        )
        if believed & PLACED:
            self.time = pose.time
        if believed & TURNED:
            self.turn_time = pose.time
        return bool(believed & PLACED)

    def at(self, time: float, reach: float) -> Floats:
        """Predict for a time, extrapolating at most so far past what was seen last; after that it stands.

        Parameters
        ----------
        time : float
            s.
        reach : float
            s.

        Returns
        -------
        ndarray of shape (4, 4)
            x, y, z and the angle of the marker's way to the right of z, rad; each with its speed and the accelerations
            of its sway and of its drift.
        """
        ahead: Floats = self.at_times((time,), reach)[0]
        return ahead

    def at_times(self, times: Sequence[float], reach: float) -> Floats:
        """Predict for several times, see `at`; ndarray of shape (times, 4, 4)."""
        ahead = np.zeros((len(times), 4, 4))
        ahead[:, 0, 0] = times
        _predict_all(self._state, self.time, self.turn_time, reach, self._limits, ahead)
        return ahead


@kernel
def _predict_all(state: Floats, seen: float, turned: float, reach: float, limits: Floats, ahead: Floats) -> None:
    """Write what `predict` says for several times; the first number of each is its time."""
    for k in range(ahead.shape[0]):
        time, ahead[k, 0, 0] = ahead[k, 0, 0], 0.0
        predict(state, time - seen, time - turned, reach, limits, ahead[k])


@kernel
def _take_in(
    position: Floats,
    spread: Floats,
    attitude: Floats,
    own: Floats,
    since: float,
    turn_since: float,
    state: Floats,
    covariance: Floats,
    limits: Floats,
    refused: npt.NDArray[np.int64],
) -> int:
    """Take in a pose seen from an own state; what of it was believed."""
    turn, seen, wide, believed = np.empty((3, 3)), np.empty(4), np.empty(4), 0
    turn_of(own, turn)
    to_rest(position, spread, turn, own[PLACE : PLACE + 3], limits, seen, wide)
    turned = attitude.shape[0] == 3 and marker_way(attitude, spread, turn, limits, seen, wide)
    if take(state, covariance, seen, wide, 0, 3, since, limits, refused) != REFUSED:
        believed += PLACED
    if turned and take(state, covariance, seen, wide, 3, 4, turn_since, limits, refused) != REFUSED:
        believed += TURNED
    return believed


def precompile() -> None:
    """Compile the kernels that Python calls, with the types that `NeighborFilter` hands over."""
    state, covariance, limits = np.zeros((4, STATES)), np.zeros((4, STATES, STATES)), np.ones(PATIENCE + 1)
    refused, own = np.zeros(2, np.int64), np.zeros(SIZE)
    since = math.inf
    _take_in(np.zeros(3), np.zeros((6, 6)), UNTURNED, own, since, since, state, covariance, limits, refused)
    _predict_all(state, 0.0, 0.0, 0.0, limits, np.zeros((1, 4, 4)))
