"""Poses as messages for an autopilot's own estimator: ODOMETRY, LANDING_TARGET, TARGET_RELATIVE; and a velocity.

`odometry_of_ball`: the camera stands still, the ball is on the vehicle. `odometry_of_camera`: the ball stands still,
the camera is on the vehicle. `landing_target`, `target_relative`: the camera is on the vehicle, the ball anywhere.
`velocity_target`: what the vehicle is to fly at. Each returns the values of one message, to first order with its
covariance. What was not seen is not made up: it is NaN, or has the variance of an unknown angle.
"""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from matchset.links.mavlink.axes import FRD_OF_RDF, CameraAxes, level_turn, quaternion
from matchset.links.mavlink.message import Values
from matchset.links.mavlink.telemetry import AutopilotAttitude
from matchset.localization.pose import UNOBSERVED_VARIANCE, Pose
from matchset.numeric.rotation import cross_matrix

Floats = npt.NDArray[np.float64]

LOCAL_FRD, BODY_FRD = 20, 12  # format: MAV_FRAME
LEVEL_BODY = 8  # format: MAV_FRAME_BODY_NED: forward, right, down, level
OBSERVED_BODY = 1  # format: TARGET_OBS_FRAME_BODY_FRD
VISION, BY_CAMERA = 2, 2  # format: MAV_ESTIMATOR_TYPE, LANDING_TARGET_TYPE
VELOCITY_ONLY = 0b0101_1100_0111  # format: POSITION_TARGET_TYPEMASK: ignore position, acceleration and yaw
NO_TURN = (1.0, 0.0, 0.0, 0.0)  # format: quaternion of no rotation
MICRO = 1e6  # format: time stamps are in microseconds


def odometry_of_ball(pose: Pose, mount: CameraAxes, marker_heading: float, time: float) -> Values:
    """ODOMETRY of a vehicle that carries the ball, before a camera that stands still.

    Parameters
    ----------
    pose : Pose
        Of the ball; where its rotation was not observed the attitude is NaN.
    mount : CameraAxes
        How the camera stands: the reference is level, below its axis, with its origin where the mount says.
    marker_heading : float
        Where marker 0 faces on the vehicle, rad, clockwise from its front: pi, to the back, in the paper.
    time : float
        When the picture was taken, s, on our clock.
    """
    turn = mount.turn
    position = turn @ pose.position + mount.offset
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = turn @ pose.covariance[:3, :3] @ turn.T
    covariance[3:, 3:] = UNOBSERVED_VARIANCE * np.eye(3)
    attitude = None
    if pose.rotation_matrix is not None:
        attitude = turn @ pose.rotation_matrix @ _body_of_ball(marker_heading).T
        parts = np.zeros((6, 6))  # of the error in the camera frame: position there, attitude in the vehicle's axes
        parts[:3, :3], parts[3:, 3:] = turn, attitude.T @ turn
        covariance = parts @ pose.covariance @ parts.T
    return _odometry(position, attitude, covariance, time)


def odometry_of_camera(pose: Pose, mount: CameraAxes, time: float) -> Values | None:
    """ODOMETRY of a vehicle that carries the camera, before a ball that stands still.

    The reference is at the ball: forward as marker 0 faces, right, down.

    Parameters
    ----------
    pose : Pose
        Of the ball.
    mount : CameraAxes
        How the camera sits on the vehicle.
    time : float
        When the picture was taken, s, on our clock.

    Returns
    -------
    dict or None
        None where the ball's rotation was not observed: then nobody knows from which side it is seen.
    """
    if pose.rotation_matrix is None:
        return None
    to_ball = FRD_OF_RDF @ pose.rotation_matrix.T
    arm = pose.position + mount.turn.T @ mount.offset  # from the vehicle's center to the ball, in the camera frame
    attitude = to_ball @ mount.turn.T
    parts = np.zeros((6, 6))  # with a small turn d of the ball: -to_ball (e + arm x d); the attitude turns by -turn d
    parts[:3, :3], parts[:3, 3:], parts[3:, 3:] = -to_ball, -to_ball @ cross_matrix(arm), -mount.turn
    return _odometry(-to_ball @ arm, attitude, parts @ pose.covariance @ parts.T, time)


def landing_target(pose: Pose, mount: CameraAxes, diameter: float, time: float) -> Values:
    """LANDING_TARGET: the ball as the vehicle sees it, forward, right, down.

    Parameters
    ----------
    pose, mount, time
        See `odometry_of_camera`.
    diameter : float
        Of the ball, m.
    """
    x, y, z = (mount.turn @ pose.position + mount.offset).tolist()
    right, down, ahead = pose.position.tolist()
    size = 2.0 * math.asin(min(1.0, 0.5 * diameter / pose.distance))
    turn = NO_TURN if pose.rotation_matrix is None else quaternion(mount.turn @ pose.rotation_matrix @ FRD_OF_RDF.T)
    return {
        "time_usec": round(MICRO * time),
        "frame": BODY_FRD,
        "angle_x": math.atan2(right, ahead),
        "angle_y": math.atan2(down, ahead),
        "distance": pose.distance,
        "size_x": size,
        "size_y": size,
        "x": x,
        "y": y,
        "z": z,
        "q": turn,
        "type": BY_CAMERA,
        "position_valid": 1,
    }


def target_relative(pose: Pose, mount: CameraAxes, attitude: AutopilotAttitude | None, time: float) -> Values:
    """TARGET_RELATIVE: the ball as the vehicle sees it, forward, right, down, with standard deviations.

    Parameters
    ----------
    pose, mount, time
        See `odometry_of_camera`.
    attitude : AutopilotAttitude or None
        Of the vehicle when the picture was taken; None if it is not known.
    """
    turn, known = mount.turn, pose.rotation_matrix is not None
    x, y, z = (turn @ pose.position + mount.offset).tolist()
    covariance = turn @ pose.covariance[:3, :3] @ turn.T
    yaw_variance = float((turn @ pose.covariance[3:, 3:] @ turn.T)[2, 2]) if known else UNOBSERVED_VARIANCE
    target = NO_TURN
    if pose.rotation_matrix is not None:
        target = quaternion(turn @ pose.rotation_matrix @ FRD_OF_RDF.T)
    return {
        "timestamp": round(MICRO * time),
        "frame": OBSERVED_BODY,
        "x": x,
        "y": y,
        "z": z,
        "pos_std": tuple(math.sqrt(max(0.0, variance)) for variance in np.diagonal(covariance).tolist()),
        "yaw_std": math.sqrt(max(0.0, yaw_variance)),
        "q_target": target,
        "q_sensor": (0.0,) * 4 if attitude is None else quaternion(level_turn(*attitude[1:])),
        "type": BY_CAMERA,
    }


def velocity_target(velocity: Sequence[float], yaw_rate: float, time: float) -> Values:
    """SET_POSITION_TARGET_LOCAL_NED: a velocity to fly at, level, in the vehicle's own directions.

    Parameters
    ----------
    velocity : three floats
        Forward, right, down, m/s.
    yaw_rate : float
        Clockwise seen from above, rad/s.
    time : float
        Now, s, on our clock.

    Raises
    ------
    ValueError
        If a number is not finite.
    """
    if not all(map(math.isfinite, (*velocity, yaw_rate))):
        raise ValueError(f"a velocity must be finite, got {tuple(velocity)} m/s, {yaw_rate} rad/s")
    forward, right, down = velocity
    return {
        "time_boot_ms": round(1e3 * time) % 2**32,
        "coordinate_frame": LEVEL_BODY,
        "type_mask": VELOCITY_ONLY,
        "vx": forward,
        "vy": right,
        "vz": down,
        "yaw_rate": yaw_rate,
    }


def _odometry(position: Floats, attitude: Floats | None, covariance: Floats, time: float) -> Values:
    """Return the values of ODOMETRY."""
    x, y, z = position.tolist()
    unknown = dict.fromkeys(("vx", "vy", "vz", "rollspeed", "pitchspeed", "yawspeed"), math.nan)
    return {
        "time_usec": round(MICRO * time),
        "frame_id": LOCAL_FRD,
        "child_frame_id": BODY_FRD,
        "x": x,
        "y": y,
        "z": z,
        "q": (math.nan,) * 4 if attitude is None else quaternion(attitude),
        **unknown,
        "pose_covariance": tuple(covariance[np.triu_indices(6)].tolist()),
        "velocity_covariance": (math.nan, *(0.0,) * 20),
        "estimator_type": VISION,
        "quality": 0,
    }


def _body_of_ball(marker_heading: float) -> Floats:
    """Turn vectors of the ball into those of the vehicle that carries it."""
    c, s = math.cos(marker_heading), math.sin(marker_heading)
    return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))) @ FRD_OF_RDF
