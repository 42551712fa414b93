"""What a page is told of a target that is found, or lost: `found_state`, `lost_state`; and its name: `checked_name`."""

import itertools
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from matchset.live.targets.target_localizer import TargetPlace
from matchset.live.wire.state import TargetState
from matchset.localization.ball_target import BallTarget
from matchset.shapes.shape import Shape, outline
from matchset.tracking.track import Track

OUTLINE_POINTS = 72  # geometry: of an outline that a browser draws
MARKER_POINTS = 24  # geometry: of a marker's
TENTH = 10.0  # format: coordinates on the screen have one decimal


class TargetFacts(NamedTuple):
    """What is told of a target in every picture.

    Attributes
    ----------
    number : int
    name : str
    shape : str
        Of which family it is.
    ball : BallTarget or None
        Its size; None: not known.
    readings : sequence of str
        What its click may mean.
    reading : int
        Which of these was taken, from 1.
    since : float or None
        When it was found first, s; None: not yet.
    alternatives : sequence of int
        Numbers of the targets that it may be as well.
    """

    number: int
    name: str
    shape: str = "circle"
    ball: BallTarget | None = None
    readings: Sequence[str] = ()
    reading: int = 0
    since: float | None = None
    alternatives: Sequence[int] = ()


def found_state(about: TargetFacts, track: Track[Any], place: TargetPlace) -> TargetState:
    """Return what is told of a target that is found."""
    return TargetState(
        about.number,
        about.name,
        True,
        shape=about.shape,
        values=track.measured(),
        outline=flat(outline(track.shape, OUTLINE_POINTS)),
        match_set=flat(track.match_set),
        support=float(track.support),
        position=dict(place.position),
        markers=[flat(outline(marker, MARKER_POINTS)) for marker in place.markers],
        axes=[] if place.axes is None else flat(place.axes),
        left_out=place.left_out,
        diameter=None if about.ball is None else about.ball.diameter,
        diameter_sigma=0.0 if about.ball is None else about.ball.diameter_sigma,
        readings=list(about.readings),
        reading=about.reading,
        since=about.since,
        alternatives=list(about.alternatives),
    )


def lost_state(about: TargetFacts, reason: str, lost_for: float = 0.0, predicted: Shape | None = None) -> TargetState:
    """Return what is told of a target that is lost.

    Parameters
    ----------
    about : TargetFacts
    reason : str
    lost_for : float
        s
    predicted : Shape, optional
        Where it is expected.
    """
    return TargetState(
        about.number,
        about.name,
        False,
        shape=about.shape,
        reason=reason,
        lost_for=lost_for,
        predicted=[] if predicted is None else flat(outline(predicted, OUTLINE_POINTS)),
        diameter=None if about.ball is None else about.ball.diameter,
        diameter_sigma=0.0 if about.ball is None else about.ball.diameter_sigma,
        readings=list(about.readings),
        reading=about.reading,
        since=about.since,
    )


def flat(points: Any) -> list[float]:
    """Write points as numbers one after the other, px."""
    return list(itertools.chain.from_iterable((np.rint(points * TENTH) / TENTH).tolist()))


def checked_name(name: str, others: Iterable[str]) -> str:
    """Return a name for a target without spaces around it.

    Raises
    ------
    ValueError
        If it is empty, has characters that cannot be seen, or is another target's.
    """
    stripped = name.strip()
    if not stripped:
        raise ValueError("a target's name must not be empty")
    if not stripped.isprintable():
        raise ValueError(f"a target's name must be letters that can be seen, in one line, got {name!r}")
    if stripped.casefold() in {other.casefold() for other in others}:
        raise ValueError(f"there is a target {stripped!r} already")
    return stripped


def free_name(name: str, others: Iterable[str]) -> str:
    """Return a name that is no other target's: itself, or with a number behind it."""
    taken = {other.casefold() for other in others}
    names = itertools.chain([name], (f"{name} ({number})" for number in itertools.count(2)))
    return next(each for each in names if each.casefold() not in taken)
