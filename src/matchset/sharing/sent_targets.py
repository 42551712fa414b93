"""What is handed in to be shared, as parts of a message: `target_messages`."""

from collections.abc import Iterable, Mapping
from typing import Any

from matchset.localization.neighbors.neighbor import Neighbor
from matchset.localization.pose import Pose
from matchset.numeric.arguments import check_kind
from matchset.sharing.messages import MOST_TARGETS, PoseMessage, TargetMessage, TrackMessage
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost, Track

Found = Track[Any] | Pose | Lost[Any]
Shareable = Found | tuple[Found, ...]
"""A track, a pose, why there is none, or a track with its pose."""
Named = Mapping[str, Shareable] | Iterable[Target[Any] | Neighbor] | Found
"""What `Share.publish` takes."""
BALL = "ball"


def target_messages(found: Named, captured: float) -> list[TargetMessage]:
    """Make the parts of a message.

    Parameters
    ----------
    found : mapping of str, iterable of Target or Neighbor, Track, Pose or Lost
        Of one target, which is called "ball"; of several by their names; or what `MultiTracker` or `Neighbors` answer.
    captured : float
        When the picture was taken, s on the clock of the messages.

    Raises
    ------
    TypeError, ValueError
        If it is something else, or too many.
    """
    if isinstance(found, Track | Pose | Lost):
        found = {BALL: found}
    if isinstance(found, Mapping):
        made = [_message(name, 0, each, captured) for name, each in found.items()]
    else:
        made = [_one_of_several(each, captured) for each in found]
    if len(made) > MOST_TARGETS:
        raise ValueError(f"at most {MOST_TARGETS} targets are shared at once, got {len(made)}")
    return made


def _one_of_several(each: object, captured: float) -> TargetMessage:
    check_kind("what is shared", each, (Target, Neighbor), "or a mapping from names to tracks and poses")
    if isinstance(each, Neighbor):
        return _message(f"neighbor {each.identity}", each.identity, (each.ball, each.pose), captured)
    assert isinstance(each, Target)
    return _message(f"{each.label} {each.identity}".strip(), each.identity, each.track, captured)


def _message(name: str, identity: int, found: Shareable, captured: float) -> TargetMessage:
    check_kind("the name of what is shared", name, str)
    if not 0 < len(name) <= 64:
        raise ValueError(f"the name of what is shared has 1 to 64 characters, got {name!r:.80}")
    parts = found if isinstance(found, tuple) else (found,)
    for part in parts:
        check_kind(f"{name}", part, (Track, Pose, Lost))
    track = next((_track(part) for part in parts if isinstance(part, Track)), None)
    pose = next((_pose(part, captured) for part in parts if isinstance(part, Pose)), None)
    lost = next((part.reason for part in parts if isinstance(part, Lost)), "")
    seen = track is not None or pose is not None
    return TargetMessage(
        name=name, identity=identity, track=track, pose=pose, lost="" if seen else (lost or "lost")[:200]
    )


def _track(track: Track[Any]) -> TrackMessage:
    found = track.measured()
    return TrackMessage(
        shape=type(track.shape).__name__,
        values={name: value for name, (value, _) in found.items()},
        stds={name: sigma for name, (_, sigma) in found.items() if sigma is not None},
        support=float(track.support),
    )


def _pose(pose: Pose, captured: float) -> PoseMessage:
    """Make the message of a pose, as a recording has it, but for its time."""
    systematic = pose.systematic_covariance
    return PoseMessage(
        position=_tuples(pose.position),
        rotation_matrix=None if pose.rotation_matrix is None else _tuples(pose.rotation_matrix),
        covariance=_tuples(pose.covariance),
        observed=pose.observed,
        time=captured,
        systematic_covariance=None if systematic is None else _tuples(systematic),
    )


def _tuples(values: Any) -> Any:
    listed = values.tolist()
    return tuple(map(tuple, listed)) if isinstance(listed[0], list) else tuple(listed)
