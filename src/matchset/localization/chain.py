"""Poses composed along a chain of vehicles into one frame for all: `compose`, `seen_from_last`.

A vehicle carries its camera and its ball rigidly, so a pose in its camera frame is known in the frame of its ball.
Composing along the chain gives the position of every camera in the frame of the last ball.
"""

from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.localization.pose import UNOBSERVED_VARIANCE, Pose
from matchset.numeric.rotation import cross_matrix
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]

FACING_AWAY = np.diag((-1.0, 1.0, -1.0))  # geometry: half a turn about the vertical
"""From a forward camera to the frame of a ball whose marker looks backward: half a turn about the vertical."""


class Mount(msgspec.Struct, frozen=True):
    """Where a vehicle carries its camera, in the frame of its own ball; the camera looks away from the marker.

    Parameters
    ----------
    lens : tuple of 3 floats
        The camera in the ball frame, m: z through the marker, which looks backward, y down, x to the left.
    """

    lens: tuple[float, float, float] = (0.0, 0.19, -0.05)


class CameraPlace(msgspec.Struct, frozen=True):
    """A camera in the frame of a ball.

    Parameters
    ----------
    position : ndarray of shape (3,), float64
        m: x is the side, y minus the height, z the heading (Epstein & Feldman, Eq. 6-8).
    rotation_matrix : ndarray of shape (3, 3), float64
        From the camera frame to that of the ball.
    """

    position: Floats
    rotation_matrix: Floats


def compose(first: "Pose | Lost[Pose]", second: "Pose | Lost[Pose]", mount: Mount | None = None) -> "Pose | Lost[Pose]":
    """Express the pose that a neighbor sees in the camera frame of the vehicle that sees the neighbor.

    With p1, R1 the neighbor's ball as seen, m and M its camera in the frame of its ball, p2, R2 what it sees itself:
    ``p = p1 + R1 (m + M p2)``, ``R = R1 M R2``. Errors dp1, w1 of the first move it by ``dp1 + w1 x (p - p1)`` and
    ``w1``, those of the second by ``R1 M dp2`` and ``R1 M w2``; they are independent.

    Parameters
    ----------
    first : Pose or Lost
        The neighbor's ball.
    second : Pose or Lost
        What the neighbor's camera sees.
    mount : Mount, optional

    Returns
    -------
    Pose or Lost
        At the time of the older one, as certain as both allow. Lost where one of them is, and where the neighbor's
        rotation is not observed.
    """
    if not isinstance(first, Pose):
        return first
    if not isinstance(second, Pose):
        return second
    time = min(first.time, second.time)
    if first.rotation_matrix is None:
        return Lost("how the neighbor is turned is not observed", time)
    mount = mount or Mount()
    turn = first.rotation_matrix @ FACING_AWAY
    arm = first.rotation_matrix @ np.array(mount.lens) + turn @ second.position
    slope = np.eye(6)
    slope[:3, 3:] = -cross_matrix(arm)
    carried = np.zeros((6, 6))
    carried[:3, :3] = carried[3:, 3:] = turn
    covariance = slope @ first.covariance @ slope.T + carried @ second.covariance @ carried.T
    if second.rotation_matrix is None:
        covariance[3:] = covariance[:, 3:] = 0.0
        covariance[3:, 3:] = UNOBSERVED_VARIANCE * np.eye(3)
    systematic = _carried_systematic(first, second, slope, carried)
    observed = second.observed if second.observed != "full" else first.observed
    return Pose(
        position=first.position + arm,
        rotation_matrix=None if second.rotation_matrix is None else turn @ second.rotation_matrix,
        covariance=covariance,
        observed=observed,
        time=time,
        systematic_covariance=systematic,
    )


def _carried_systematic(first: Pose, second: Pose, slope: Floats, carried: Floats) -> Floats | None:
    """Systematic covariance of a composed pose, (6, 6), as its covariance; None where neither pose has one."""
    if first.systematic_covariance is None and second.systematic_covariance is None:
        return None
    total = np.zeros((6, 6))
    for pose, turn in ((first, slope), (second, carried)):
        if pose.systematic_covariance is not None:
            total += turn @ pose.systematic_covariance @ turn.T
    if second.rotation_matrix is None:
        total[3:] = total[:, 3:] = 0.0
    return total


def seen_from_last(poses: "Sequence[Pose | Lost[Pose]]", mount: Mount | None = None) -> list[CameraPlace | None]:
    """Put every camera of a chain into the frame of the last ball.

    Parameters
    ----------
    poses : sequence of Pose or Lost
        What each camera sees of the next vehicle's ball, in the order of the chain.
    mount : Mount, optional

    Returns
    -------
    list of CameraPlace or None
        One for each camera; None from the last gap of the chain on forward.
    """
    places: list[CameraPlace | None] = []
    last: Pose | Lost[Pose] | None = None
    for pose in reversed(poses):
        last = pose if last is None else compose(pose, last, mount)
        rotation = last.rotation_matrix if isinstance(last, Pose) else None
        if isinstance(last, Pose) and rotation is not None:
            places.append(CameraPlace(-(last.position @ rotation), rotation.T))
        else:
            places.append(None)
    return places[::-1]
