"""Whether the seen motion of the ball answers to the vehicle's own commands: `MotionConsistency`.

A vehicle tilts all the time. The ball then moves up and down in its pictures as dead reckoning says, unless these
pictures are older than their time stamps. Of the last poses, with the rows e of the rotations from the camera to the
level frame at rest and the unit vectors u to the ball,

    seen and own motion together    r = e u + h / d
    own motion alone                q = e mean(u) + h / d
    seen motion                     s = r - q

with the vehicle's height h by dead reckoning and the mean distance d: the height of the ball over its distance. A
neighbor moves slowly, so each without its straight line in time, r is small where the pictures are as old as they say;
where they are not, r is as large as q and s together. The result is ``sum r^2 / (sum q^2 + sum s^2 + n noise^2)``, near
0 or near 1. The largest r^2 is left out of its sum, for one outlier.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.ego_motion import EgoState
from matchset.control.parameter_checks import require, require_positive
from matchset.localization.pose import Pose
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]

TINY = 1e-12  # s^2 and m, least spread of the times, least distance
COLUMNS = 9  # format: time; row of the rotation; direction to the ball; height of the vehicle; distance of the ball
TIME, ROW, DIRECTION, HEIGHT, DISTANCE = 0, 1, 4, 7, 8  # format: their first columns


class MotionConsistencyParameters(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    rename={"max_inconsistency": "most", "settling_time": "begin"},
):
    """When the motion of the ball does not answer to the commands; the key in a file is in parentheses if another one.

    Chosen on the simulated flights of seeds 0 to 9, with and without pictures half a second old; `python -m
    benchmarks.flight.faults` shows a change.

    Parameters
    ----------
    window : int
        Number of poses that are looked at. More finds smaller disagreement, later.
    max_duration : float
        Largest time from the first to the last of them, s; over a longer one nothing is said. Less says nothing where
        pictures are missing, more mixes in what was long ago. Chosen by hand: twice that of ten pictures.
    noise : float
        Motion that says nothing, the standard deviation of the ball's height over its distance, rad: dead reckoning is
        no better. More asks for a larger own motion.
    max_inconsistency : float
        Largest result with which a vehicle flies on. In flights without fault 0.34 was the largest, 0.24 but for one
        with a gust of wind; with pictures half a second old it is passed after 0.16 s in the median and after 0.9 s at
        the latest (``most``).
    settling_time : float
        Time after the start in which nothing is said, s: the vehicle is in a hand or on the ground, which its dead
        reckoning does not know (``begin``).
    """

    window: int = 10
    max_duration: float = 0.67
    noise: float = 0.012
    max_inconsistency: float = 0.4
    settling_time: float = 0.8

    def __post_init__(self) -> None:
        require(self, ("window",), lambda value: value >= 4, "4 or more")
        require_positive(self, ("max_duration", "noise", "max_inconsistency", "settling_time"))


class MotionConsistency:
    """Compares the seen with the commanded motion over the last poses. The constructor compiles all kernels.

    Parameters
    ----------
    parameters : MotionConsistencyParameters, optional

    Attributes
    ----------
    inconsistency : float
        The result of the last update; 0 while there is none.
    """

    def __init__(self, parameters: MotionConsistencyParameters | None = None) -> None:
        self.parameters = parameters or MotionConsistencyParameters()
        self._window = np.zeros((self.parameters.window, COLUMNS))
        self.reset()
        measure(self._window, self.parameters.noise)

    @property
    def holds(self) -> bool:
        """Whether the ball moves as the commands say, or it is not known."""
        return self.inconsistency <= self.parameters.max_inconsistency

    def reset(self) -> None:
        """Forget everything: the vehicle does not fly."""
        self._count, self._begin, self.inconsistency = 0, math.inf, 0.0

    def update(self, pose: Pose, ego: EgoState) -> None:
        """Note a pose in the camera frame, and the vehicle's state by dead reckoning at the same time.

        Parameters
        ----------
        pose : Pose
        ego : EgoState
        """
        parameters, time = self.parameters, pose.time
        self._begin = min(self._begin, time)
        if not time - self._begin >= parameters.settling_time:
            return
        number = self._count % parameters.window
        oldest = self._window[(number + 1) % parameters.window, TIME]
        self._window[number] = _row(pose, ego)
        self._count += 1
        known = self._count >= parameters.window and 0.0 < time - oldest <= parameters.max_duration
        self.inconsistency = measure(self._window, parameters.noise) if known else 0.0


def _row(pose: Pose, ego: EgoState) -> tuple[float, ...]:
    """Return a row of the window; the rotation's row is that of Ry(yaw) Rx(-pitch) Rz(roll) that gives what is down."""
    (x, y, z), roll, pitch = pose.position.tolist(), ego.roll, ego.pitch
    distance = max(math.sqrt(x * x + y * y + z * z), TINY)
    down = math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll), math.sin(pitch)
    return pose.time, *down, x / distance, y / distance, z / distance, ego.position.item(1), distance


@kernel
def measure(window: Floats, noise: float) -> float:
    """Return the inconsistency of the poses in the rows of a window, in any order."""
    count = window.shape[0]
    mean, middle, distance, spread = np.zeros(3), 0.0, 0.0, 0.0
    for row in window:
        middle += row[TIME] / count
        distance += row[DISTANCE] / count
        for k in range(3):
            mean[k] += row[DIRECTION + k] / count
    motions = np.zeros((count, 3))  # r, q and s of each pose
    for i in range(count):
        row, motion = window[i], motions[i]
        spread += (row[TIME] - middle) ** 2
        height = (row[HEIGHT] - window[0, HEIGHT]) / max(distance, TINY)
        motion[0] = motion[1] = height
        for k in range(3):
            motion[0] += row[ROW + k] * row[DIRECTION + k]
            motion[1] += row[ROW + k] * mean[k]
        motion[2] = motion[0] - motion[1]
    squares, largest = np.zeros(3), 0.0
    for j in range(3):
        value, slope = 0.0, 0.0
        for i in range(count):
            value += motions[i, j] / count
            slope += motions[i, j] * (window[i, TIME] - middle) / max(spread, TINY)
        for i in range(count):
            square = (motions[i, j] - value - slope * (window[i, TIME] - middle)) ** 2
            squares[j] += square
            if j == 0:
                largest = max(largest, square)
    disagreement = (squares[0] - largest) * count / (count - 1)
    share: float = disagreement / (squares[1] + squares[2] + count * noise**2)
    return share
