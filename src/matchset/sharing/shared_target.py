"""A target of a partner as it is known here: `SharedTarget`; and what may not be used, and why: `reason_not_to_use`."""

from typing import Any

import msgspec
import numpy as np

from matchset.localization.pose import Pose
from matchset.numeric.arguments import require_positive
from matchset.numeric.words import measured, one_line
from matchset.sharing.clock_offset import Offset
from matchset.sharing.messages import PoseMessage, TargetMessage
from matchset.tracking.track import Lost

ORTHONORMAL = 1e-6  # format: how far a rotation's axes may be from unit length and right angles


class AgeParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is too old, or not known well enough, to be used.

    Parameters
    ----------
    max_age : float
        Largest age of a picture, its uncertainty added, s. More bridges gaps of a bad network, less refuses what is no
        longer true sooner. Chosen by hand: a vehicle of 1 m/s is 0.5 m away by then.
    max_uncertainty : float
        Largest uncertainty of the age, s. Chosen by hand: 5 cm at 1 m/s.
    """

    max_age: float = 0.5
    max_uncertainty: float = 0.05

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)


class Age(msgspec.Struct, frozen=True):
    """How old something of a partner is.

    Parameters
    ----------
    seconds : float
        Age of the picture, s.
    uncertainty : float
        It is off by no more, s: that of the clocks' offset.
    """

    seconds: float
    uncertainty: float


class SharedTarget(msgspec.Struct, frozen=True, kw_only=True):
    """A target of a partner, in the newest of its pictures that came; false in a condition where it must not be used.

    Parameters
    ----------
    partner : str
        Who sees it.
    name : str
        What the partner calls it.
    identity : int
        As `Target.identity` of the partner.
    pose : Pose or Lost
        In the frame of the partner's camera; its time is on the clock of this computer's pictures (`time.monotonic`).
        `Lost`, with the reason, where it is old, is not seen, the clock of the partner is not known, or the partner has
        no pose of it.
    shape : str
        Family of its outline in the partner's picture; empty where none is shared.
    values : dict of str to (float, float or None)
        The outline as `Track.measured` gives it, px and rad; empty where it must not be used.
    age : Age or None
        How old the picture is; None as long as the clock of the partner is not known.
    reason : str
        Why it must not be used, in words; empty if it may.
    """

    partner: str
    name: str
    identity: int
    pose: Pose | Lost[Pose]
    shape: str
    values: dict[str, tuple[float, float | None]]
    age: Age | None
    reason: str

    def __bool__(self) -> bool:
        return not self.reason

    def to_dict(self) -> dict[str, Any]:
        """Return it for JSON: s, m, px and rad."""
        return {
            "partner": self.partner,
            "name": self.name,
            "identity": self.identity,
            "usable": bool(self),
            "reason": self.reason,
            "age": None if self.age is None else self.age.seconds,
            "age_uncertainty": None if self.age is None else self.age.uncertainty,
            "shape": self.shape,
            **{name: value for name, (value, _) in self.values.items()},
            "pose": self.pose.to_dict(),
        }

    @one_line
    def __repr__(self) -> str:
        if self.reason:
            return f"SharedTarget({self.partner} {self.name!r}, not to be used: {self.reason})"
        age = "" if self.age is None else f", {measured(self.age.seconds, self.age.uncertainty)} s old"
        return f"SharedTarget({self.partner} {self.name!r}{age}: {self.pose!r})"


def reason_not_to_use(age: Age | None, lost: str, parameters: AgeParameters) -> str:
    """Say why something of a partner must not be used; empty if it may.

    Parameters
    ----------
    age : Age or None
        None if the clock of the partner is not known.
    lost : str
        Why the partner does not see it; empty if it does.
    parameters : AgeParameters
    """
    if lost:
        return f"not seen: {lost}"
    if age is None:
        return "the clock of the partner is not known yet"
    if not age.uncertainty <= parameters.max_uncertainty:
        return f"its time is known to ±{age.uncertainty:.3g} s, at most ±{parameters.max_uncertainty:g} s is used"
    if not age.seconds + age.uncertainty <= parameters.max_age:
        return f"it is {age.seconds:.2f} s old, at most {parameters.max_age:g} s is used"
    if not age.seconds + age.uncertainty >= 0.0:
        return f"it is of {-age.seconds:.3g} s from now"
    return ""


def shared_target(
    partner: str,
    message: TargetMessage,
    offset: Offset | None,
    now: float,
    parameters: AgeParameters,
    ahead: float = 0.0,
) -> SharedTarget:
    """Make what is known here of a target in the message of a partner.

    Parameters
    ----------
    partner : str
    message : TargetMessage
    offset : Offset or None
        Of its clock, now.
    now : float
        s.
    parameters : AgeParameters
    ahead : float
        By how much the clock of the messages is ahead of that of pictures, s.
    """
    age = None if offset is None else Age(now - (message.captured + offset.seconds), offset.uncertainty)
    reason = reason_not_to_use(age, message.lost, parameters)
    taken = (now if age is None else now - age.seconds) - ahead
    track, pose = message.track, message.pose
    found: Pose | Lost[Pose] = Lost(reason or "the partner shares no pose of it", taken)
    if pose is not None and not reason:
        found = _pose(pose, taken) if is_pose(pose) else Lost("what the partner sends is no pose", taken)
    return SharedTarget(
        partner=partner,
        name=message.name,
        identity=message.identity,
        pose=found,
        shape="" if track is None else track.shape,
        values={} if track is None or reason else {name: (x, track.stds.get(name)) for name, x in track.values.items()},
        age=age,
        reason=reason,
    )


def is_pose(message: PoseMessage) -> bool:
    """Whether a partner's numbers are a pose: a rotation, if one was observed, and variances."""
    covariances = [each for each in (message.covariance, message.systematic_covariance) if each is not None]
    if any(row[axis] < 0.0 for covariance in covariances for axis, row in enumerate(covariance)):
        return False
    if message.rotation_matrix is None:
        return True
    turned = np.array(message.rotation_matrix)
    return bool(np.allclose(turned.T @ turned, np.eye(3), atol=ORTHONORMAL) and np.linalg.det(turned) > 0.0)


def _pose(message: PoseMessage, time: float) -> Pose:
    systematic = message.systematic_covariance
    return Pose(
        position=np.array(message.position),
        rotation_matrix=None if message.rotation_matrix is None else np.array(message.rotation_matrix),
        covariance=np.array(message.covariance),
        observed=message.observed,
        time=time,
        systematic_covariance=None if systematic is None else np.array(systematic),
    )
