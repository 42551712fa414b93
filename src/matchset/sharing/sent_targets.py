"""What is handed in to be shared: `sent_targets` sorts it, `target_message` makes a part of a message of each."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from matchset.localization.neighbors.neighbor import Neighbor
from matchset.localization.pose import Pose
from matchset.numeric.arguments import are_finite, check_kind
from matchset.shapes.shape import outline
from matchset.sharing.messages import LONGEST_NAME, MOST_TARGETS, PoseMessage, TargetMessage, TrackMessage
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost, Track

Found = Track[Any] | Pose | Lost[Any]
Shareable = Found | tuple[Found, ...]
"""A track, a pose, why there is none, or a track with its pose."""
BALL = "ball"
LONGEST_REASON = 200  # format: characters


class SentOutline(NamedTuple):
    """An outline to be shared.

    Attributes
    ----------
    shape : str
        Family.
    values : dict of str to (float, float or None)
        As `Track.measured`, px and rad.
    support : float
    box : tuple of float
        Around it: left, top, right and bottom, px.
    """

    shape: str
    values: dict[str, tuple[float, float | None]]
    support: float
    box: tuple[float, float, float, float]


class SentTarget(NamedTuple):
    """A target to be shared.

    Attributes
    ----------
    name : str
    identity : int
        0 where there is one target of this name.
    outline : SentOutline or None
    pose : Pose or None
    lost : str
        Why neither is there; empty if one is.
    """

    name: str
    identity: int
    outline: SentOutline | None
    pose: Pose | None
    lost: str


Named = Mapping[str, Shareable] | Iterable[Target[Any] | Neighbor | SentTarget] | Found
"""What `Share.publish` takes."""


def sent_targets(found: Named) -> list[SentTarget]:
    """Sort what is handed in.

    Parameters
    ----------
    found : mapping of str, iterable of Target, Neighbor or SentTarget, Track, Pose or Lost
        Of one target, which is called "ball"; of several by their names; or what `MultiTracker` or `Neighbors` answer.

    Raises
    ------
    TypeError, ValueError
        If it is something else, or too many.
    """
    if isinstance(found, Track | Pose | Lost):
        found = {BALL: found}
    if isinstance(found, Mapping):
        made = [_sent(name, 0, each) for name, each in found.items()]
    else:
        check_kind("what is shared", found, Iterable)
        made = [_one_of_several(each) for each in found]
    if len(made) > MOST_TARGETS:
        raise ValueError(f"at most {MOST_TARGETS} targets are shared at once, got {len(made)}")
    return made


class NamedLately:
    """Knows which targets are gone: those that were not named for some time, so that one that comes back finds all.

    Parameters
    ----------
    linger : float
        That time, s. More keeps what is declared of a target through longer gaps, less lets others see sooner that it
        is gone. Chosen by hand: a target that leaves the picture is back by then, or is another one.
    """

    def __init__(self, linger: float = 10.0) -> None:
        self._linger, self._named = linger, dict[str, float]()

    def gone(self, names: Iterable[str], now: float) -> list[str]:
        """Note which targets are named now, s, and return those that are gone: of more than fit, those named first."""
        for name in names:
            self._named.pop(name, None)
            self._named[name] = now
        first = list(self._named)[: max(len(self._named) - MOST_TARGETS, 0)]
        gone = [name for name, time in self._named.items() if name in first or now - time > self._linger]
        for name in gone:
            del self._named[name]
        return gone


def ages_of(sent: Sequence[SentTarget], time: float | Mapping[str, float], now: float) -> list[float]:
    """Return how old the picture of each target is now, s.

    Parameters
    ----------
    sent : sequence of SentTarget
    time : float or mapping of str to float
        When the picture was taken, s; or that of each, by name.
    now : float
        On the same clock.

    Raises
    ------
    ValueError
        If a time is missing or not finite.
    """
    ages = []
    for each in sent:
        taken = time.get(each.name) if isinstance(time, Mapping) else time
        if not are_finite(taken, now):
            raise ValueError(f"times must be finite, got {taken!r} of {each.name!r} and {now!r}")
        assert taken is not None
        ages.append(now - taken)
    return ages


def target_message(sent: SentTarget, captured: float) -> TargetMessage:
    """Make the part of a message of a target.

    Parameters
    ----------
    sent : SentTarget
    captured : float
        When the picture was taken, s on the clock of the messages.
    """
    return TargetMessage(
        name=sent.name,
        captured=captured,
        identity=sent.identity,
        track=None if sent.outline is None else _track(sent.outline),
        pose=None if sent.pose is None else _pose(sent.pose, captured),
        lost=sent.lost[:LONGEST_REASON],
    )


def _one_of_several(each: object) -> SentTarget:
    if isinstance(each, SentTarget):
        return each
    check_kind("what is shared", each, (Target, Neighbor), "or a mapping from names to tracks and poses")
    if isinstance(each, Neighbor):
        return _sent(f"neighbor {each.identity}", each.identity, (each.ball, each.pose))
    assert isinstance(each, Target)
    return _sent(f"{each.label} {each.identity}".strip(), each.identity, each.track)


def _sent(name: str, identity: int, found: Shareable) -> SentTarget:
    check_kind("the name of what is shared", name, str)
    if not 0 < len(name) <= LONGEST_NAME:
        raise ValueError(f"the name of what is shared has 1 to {LONGEST_NAME} characters, got {name!r:.80}")
    parts = found if isinstance(found, tuple) else (found,)
    for part in parts:
        check_kind(name, part, (Track, Pose, Lost))
    drawn = next((_outline(part) for part in parts if isinstance(part, Track)), None)
    pose = next((part for part in parts if isinstance(part, Pose)), None)
    why = next((part.reason for part in parts if isinstance(part, Lost)), "") or "lost"
    return SentTarget(name, identity, drawn, pose, "" if drawn is not None or pose is not None else why)


def _outline(track: Track[Any]) -> SentOutline:
    points = outline(track.shape)
    (left, top), (right, bottom) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return SentOutline(type(track.shape).__name__, track.measured(), float(track.support), (left, top, right, bottom))


def _track(sent: SentOutline) -> TrackMessage:
    return TrackMessage(
        shape=sent.shape,
        values={name: value for name, (value, _) in sent.values.items()},
        stds={name: sigma for name, (_, sigma) in sent.values.items() if sigma is not None},
        support=sent.support,
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
