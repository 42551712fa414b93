"""What a flight left to identify a vehicle by: sticks, and poses of the ball in the camera: `StickLog`."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.flight.chain.pilot import PilotStep
from matchset.localization.pose import Pose

Floats = npt.NDArray[np.float64]
STICKS = ("roll", "pitch", "yaw", "throttle")


class LoggedStep(NamedTuple):
    """What counts of a `PilotStep`: its picture is not kept.

    Attributes
    ----------
    now : float
        When the command was sent, s.
    sticks : tuple of float
        Roll, pitch, yaw and throttle, as the vehicle receives them.
    flying : bool
        Whether the safety filter let the follower fly.
    pose : Pose or None
    age : float
        From the picture to the command, s.
    """

    now: float
    sticks: tuple[float, ...]
    flying: bool
    pose: Pose | None
    age: float

    @classmethod
    def of(cls, step: PilotStep) -> "LoggedStep":
        """Take it from a step."""
        sticks = tuple(float(getattr(step.command, name)) for name in STICKS)
        pose = step.pose if isinstance(step.pose, Pose) else None
        return cls(step.now, sticks, step.safety.phase in ("flying", "holding"), pose, step.age)


class StickLog(msgspec.Struct, frozen=True):
    """Sticks and poses of one flight, on one clock.

    Parameters
    ----------
    sent : ndarray of shape (n,)
        When each command was sent, s.
    sticks : ndarray of shape (n, 4)
        Roll, pitch, yaw and throttle, as the vehicle receives them.
    taken : ndarray of shape (m,)
        When each picture was taken, s, by its time stamp.
    balls : ndarray of shape (m, 3)
        The ball's center in the camera frame (x right, y down, z forward), m.
    covariances : ndarray of shape (m, 3, 3)
        Of these in the camera frame, m^2.
    outs : ndarray of shape (m, 3)
        Direction of the marker, out of the ball, in the camera frame; NaN where it was not seen.
    out_variances : ndarray of shape (m,)
        Of its angle about the vertical, rad^2.
    age : float
        From a picture to its command, s: the median.
    """

    sent: Floats
    sticks: Floats
    taken: Floats
    balls: Floats
    covariances: Floats
    outs: Floats
    out_variances: Floats
    age: float

    @classmethod
    def of(cls, steps: Sequence[LoggedStep], airborne: float) -> "StickLog":
        """Collect the first flight among the steps of one pilot, up to its descent.

        Parameters
        ----------
        steps : sequence of LoggedStep
        airborne : float
            Poses of the first so many s after the take-off are left out.
        """
        begin = next((k for k, step in enumerate(steps) if step.flying), len(steps))
        end = next((k for k, step in enumerate(steps) if k > begin and not step.flying), len(steps))
        flown = steps[begin:end]
        start = flown[0].now + airborne if flown else math.inf
        poses = [step.pose for step in flown if step.pose is not None and step.pose.time >= start]
        nowhere = np.full(3, math.nan)
        turned = [nowhere if pose.rotation_matrix is None else pose.rotation_matrix[:, 2] for pose in poses]
        ages = [step.age for step in flown if math.isfinite(step.age)]
        return cls(
            np.array([step.now for step in steps[:end]]),
            np.array([step.sticks for step in steps[:end]]).reshape(-1, len(STICKS)),
            np.array([pose.time for pose in poses]),
            np.array([pose.position for pose in poses]).reshape(-1, 3),
            np.array([pose.covariance[:3, :3] for pose in poses]).reshape(-1, 3, 3),
            np.array(turned).reshape(-1, 3),
            np.array([pose.covariance[4, 4] for pose in poses]),
            float(np.median(ages)) if ages else math.nan,
        )

    @property
    def duration(self) -> float:
        """From the first to the last picture that counts, s."""
        return float(self.taken[-1] - self.taken[0]) if len(self.taken) else 0.0
