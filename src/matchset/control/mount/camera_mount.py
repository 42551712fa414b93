"""The rotation from a camera to its vehicle, told and corrected in flight: `CameraMount`.

Two vehicles that hold their places are level in the mean, whatever their flight controllers take for level: one that is
not accelerates. So the neighbor's marker, on the equator of its ball, is seen level in the mean. If its mean elevation,
in a frame that dead reckoning keeps level, is e, then the camera is mounted higher than was told by d, or the marker is
m too high, and ``e = d + m``. No flight separates the two: a camera that is turned about the axis about which the
vehicle pitches shows nothing else of that, and how the height looks when the distance changes is lost in the motion of
the neighbor (decision 099). With standard deviations known before, s_d and s_m, the best estimate is

    d = s_d^2 / (s_d^2 + s_m^2) e,

e by a scalar Kalman filter of a constant in white noise, which stands for the tilts of both vehicles.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.ego_motion import EgoState
from matchset.localization.pose import Pose
from matchset.numeric.arguments import require, require_not_negative, require_positive

Floats = npt.NDArray[np.float64]


class MountParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How camera and marker are mounted.

    Parameters
    ----------
    yaw, pitch, roll : float
        The camera on its vehicle: turned to the right, then up, then clockwise, rad. `matchset calibrate --mount`
        measures them.
    marker_yaw : float
        How far the neighbor's marker is to the right of its back, as seen from behind, rad. Nothing in a flight shows
        it; `matchset calibrate --mount` measures it.
    marker_elevation : float
        How far that marker is above the equator of its ball, rad; `matchset calibrate --mount` measures it.
    pitch_sigma : float
        Standard deviation of `pitch`, rad. More learns more of a wrong one, and takes more of a marker that is not on
        the equator for it; 0 learns nothing. Estimate: 5 degrees for a mount by eye.
    marker_sigma : float
        Standard deviation of the elevation of the marker on its ball, rad. Estimate: 5 mm on a ball of 28 cm.
    tilt_noise : float
        Root of the spectral density of both vehicles' tilts about their means, rad per root of Hz. More learns later,
        and is disturbed less. Chosen by: `python -m benchmarks.flight.fly --quick --only pitched`, seeds 0 to 9.
    elevation_noise : float
        How fast the mean elevation may change, rad per root of s: a ball that was touched.
    settling_time : float
        Time in flight in which nothing is learned, s: trims are not known yet, and the neighbor may just begin to fly,
        and lean as nobody does in the mean. Estimate.
    significance : float
        Standard deviations by which the mean elevation must differ from 0 before anything is corrected; from then on
        all of it is. Less finds a smaller pitch; more leaves a set place alone that need not move: a long chain makes a
        larger motion of each. Chosen by: chains of ten, seeds 0 to 4.
    max_correction : float
        Limit of the correction, rad.
    max_rate : float
        Limit of its rate, rad/s: the set place moves with it. Estimate: 4 cm/s at 1.5 m.
    min_marker_cosine : float
        Least cosine between the marker's direction, level, and that to the vehicle's back at which it counts.
    """

    yaw: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0
    marker_yaw: float = 0.0
    marker_elevation: float = 0.0
    pitch_sigma: float = 0.09
    marker_sigma: float = 0.03
    tilt_noise: float = 0.07
    elevation_noise: float = 0.0005
    settling_time: float = 2.5
    significance: float = 2.5
    max_correction: float = 0.2
    max_rate: float = 0.03
    min_marker_cosine: float = 0.5

    def __post_init__(self) -> None:
        for name in ("yaw", "pitch", "roll", "marker_yaw", "marker_elevation"):
            require(self, (name,), lambda value: abs(value) < 0.5 * math.pi, "less than a quarter turn, in rad")
        require_not_negative(
            self, ("pitch_sigma", "elevation_noise", "settling_time", "significance", "max_correction")
        )
        require_positive(self, ("marker_sigma", "tilt_noise", "max_rate", "min_marker_cosine"))


class CameraMount:
    """Turns poses from the camera to the vehicle, and learns the camera's pitch.

    Parameters
    ----------
    parameters : MountParameters, optional

    Attributes
    ----------
    correction : float
        By how much the camera is taken to look higher than was told, rad.
    from_camera : ndarray of shape (3, 3)
        Rotation from the camera to the vehicle, as it is now taken to be.
    """

    def __init__(self, parameters: MountParameters | None = None) -> None:
        self.parameters = parameters or MountParameters()
        told = self.parameters
        self._told = mounting(told.yaw, told.pitch, told.roll)
        self._marker = turn_about_down(told.marker_yaw) if told.marker_yaw else None
        self._straight = not (told.yaw or told.pitch or told.roll or told.marker_yaw)
        self._turned = np.empty((2, 2, 3, 3))  # blocks of a covariance on the way
        prior = told.pitch_sigma**2
        self._share = prior / (prior + told.marker_sigma**2)
        self._elevation, self._variance = 0.0, prior + told.marker_sigma**2
        self._time, self._begin, self._evident = math.inf, math.inf, False
        self.correction, self.from_camera = 0.0, self._told

    @property
    def sigma(self) -> float:
        """Standard deviation of the camera's pitch as it is now taken to be, rad."""
        told = self.parameters
        return math.sqrt(self._share * told.marker_sigma**2 + self._share**2 * self._variance)

    def turn(self, pose: Pose) -> Pose:
        """Turn a pose in the camera frame into the vehicle's: x right, y down, z forward, where its sticks say so.

        Parameters
        ----------
        pose : Pose
        """
        if self._straight and self.correction == 0.0:
            return pose
        turn, rotation = self.from_camera, pose.rotation_matrix
        if rotation is not None:
            rotation = turn @ rotation if self._marker is None else turn @ rotation @ self._marker
        return Pose(
            position=turn @ pose.position,
            rotation_matrix=rotation,
            covariance=self._turned_by(turn, pose.covariance),
            observed=pose.observed,
            time=pose.time,
            systematic_covariance=None
            if pose.systematic_covariance is None
            else self._turned_by(turn, pose.systematic_covariance),
        )

    def _turned_by(self, turn: Floats, covariance: Floats) -> Floats:
        """Turn the covariance of a pose, (6, 6)."""
        turned = np.empty((6, 6))
        np.matmul(turn, in_blocks(covariance), self._turned)
        np.matmul(self._turned, turn.T, in_blocks(turned))
        return turned

    def learn(self, pose: Pose, own: EgoState) -> None:
        """Correct the mean elevation of the marker by a pose in flight, and the camera's pitch by that.

        Parameters
        ----------
        pose : Pose
            In the camera frame.
        own : EgoState
            The vehicle by dead reckoning when the picture was taken.
        """
        step, self._time = pose.time - self._time, pose.time
        self._begin = min(self._begin, pose.time)
        if pose.time - self._begin < self.parameters.settling_time:
            return
        if pose.rotation_matrix is None or not 0.0 < step < math.inf or self._share == 0.0:
            return
        parameters, level = self.parameters, own.rotation
        right, down, forward = (level @ (self._told @ pose.rotation_matrix[:, 2])).tolist()
        back = -(right * math.sin(own.yaw) + forward * math.cos(own.yaw))
        if not back >= parameters.min_marker_cosine:
            return
        self._variance += parameters.elevation_noise**2 * step
        gain = self._variance / (self._variance + parameters.tilt_noise**2 / step)
        self._elevation += gain * (math.atan2(-down, back) - parameters.marker_elevation - self._elevation)
        self._variance *= 1.0 - gain
        if abs(self._elevation) > parameters.significance * math.sqrt(self._variance):
            self._evident = True
        best = self._share * self._elevation if self._evident else 0.0
        best = min(max(best, -parameters.max_correction), parameters.max_correction)
        farthest = parameters.max_rate * step
        change = min(max(best - self.correction, -farthest), farthest)
        if change != 0.0:
            self.correction += change
            self.from_camera = mounting(parameters.yaw, parameters.pitch + self.correction, parameters.roll)


def in_blocks(covariance: Floats) -> Floats:
    """View a matrix, (6, 6), as its four blocks of position and rotation, (2, 2, 3, 3)."""
    return covariance.reshape(2, 3, 2, 3).transpose(0, 2, 1, 3)


def turn_about_down(angle: float) -> Floats:
    """Rotation about the y axis, which points down, by an angle, rad, that takes z to the right, (3, 3)."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array(((cosine, 0.0, sine), (0.0, 1.0, 0.0), (-sine, 0.0, cosine)))


def mounting(yaw: float, pitch: float, roll: float) -> Floats:
    """Rotation from a camera to its vehicle, (3, 3): turned to the right, then up, then clockwise, rad."""
    up, over = math.cos(pitch), math.cos(roll)  # SciPy's Rotation takes longer than all the rest of a step
    pitched = np.array(((1.0, 0.0, 0.0), (0.0, up, -math.sin(pitch)), (0.0, math.sin(pitch), up)))
    rolled = np.array(((over, -math.sin(roll), 0.0), (math.sin(roll), over, 0.0), (0.0, 0.0, 1.0)))
    mount: Floats = turn_about_down(yaw) @ pitched @ rolled
    return mount
