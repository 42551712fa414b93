"""What is written down of the pose in one frame: `PoseRow`."""

import math

import msgspec
import numpy as np

from matchset.localization.pose import Pose
from matchset.localization.pose_spread import seen_spread, yaw_variance
from matchset.tracking.track import Lost

POSITION = ("x", "y", "z")
SEEN = ("side", "height", "heading", "yaw")
_DECIMALS = 6


class PoseRow(msgspec.Struct, frozen=True):
    """The pose in one frame, as tables hold it.

    Parameters
    ----------
    frame : int
        Its place in the video, from 0, in decode order.
    time : float
        When it was taken, s.
    values : dict of str to float, or None
        `x`, `y`, `z` of the ball in the camera frame, m; `side`, `height`, `heading`, m, where the rotation was
        observed; `yaw`, rad. None where the ball was not placed.
    std : dict of str to float, or None
        Their standard deviations, by the same names.
    observed : str
        "position", "level" or "full", see `Pose`; empty where the ball was not placed.
    reason : str
        Why it was not placed, in words; empty where it was.
    """

    frame: int
    time: float
    values: dict[str, float] | None = None
    std: dict[str, float] | None = None
    observed: str = ""
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether this frame's pixels placed the ball."""
        return self.values is not None

    @property
    def brief(self) -> str:
        """The position in a few words, for a line that changes all the time; empty where there is none."""
        if self.values is None:
            return ""
        return "  ".join(f"{name} {self.values[name]:+7.3f}" for name in POSITION) + f" m  {self.observed}"


def pose_row_of(frame: int, pose: "Pose | Lost[Pose]") -> PoseRow:
    """Turn a pose into the row of its frame.

    Parameters
    ----------
    frame : int
        The frame's index.
    pose : Pose or Lost
        What `Localizer.update` returned for it.

    Returns
    -------
    PoseRow
        With numbers rounded to 1e-6 m and rad.
    """
    if isinstance(pose, Lost):
        return PoseRow(frame, pose.time, reason=pose.reason)
    values = dict(zip(POSITION, pose.position.tolist(), strict=True))
    variances = dict(zip(POSITION, np.diag(pose.covariance)[:3].tolist(), strict=True))
    seen = seen_spread(pose)
    if seen is not None:
        for name, value, variance in zip(SEEN, (pose.side, pose.height, pose.heading), np.diag(seen), strict=False):
            values[name] = float(value or 0.0)
            variances[name] = float(variance)
    values["yaw"], variances["yaw"] = pose.yaw, yaw_variance(pose)
    return PoseRow(
        frame,
        pose.time,
        values={name: _rounded(value) for name, value in values.items()},
        std={name: _rounded(math.sqrt(max(variance, 0.0))) for name, variance in variances.items()},
        observed=pose.observed,
    )


def _rounded(value: float) -> float:
    return round(value, _DECIMALS) + 0.0  # no -0.0
