"""What is followed without a gap, and whose it may be: `Tracklet`, `Hypothesis`; and the target itself: `Followed`."""

from typing import Any, NamedTuple

from matchset.shapes.shape import Shape
from matchset.tracking.many.motion_bank import Predicted
from matchset.tracking.many.sightings import Sighting
from matchset.tracking.motion import Gate
from matchset.tracking.tracker import Tracker


class Followed:
    """A target: what is certain of it.

    Parameters
    ----------
    label : str
        Key of its color.
    slot : int
        Of the filters: its motion, as far as that is certain.
    first : Sighting
        Where it was found first.

    Attributes
    ----------
    identity : int or None
        None until it is confirmed, unless somebody said that it shall be followed.
    since, seen : float
        When it was found first and last, s.
    last : Sighting
        The last one.
    tracklet : Tracklet or None
        What is followed and taken for it now; None while it is not seen.
    sightings : int
        In how many frames it was seen.
    sought : float
        When it was searched for last while it was not seen, s.
    probe : Tracker or None
        With which it is looked for while it is not seen.
    probed : float or None
        When that saw a frame last, s.
    """

    def __init__(self, label: str, slot: int, first: Sighting) -> None:
        self.label, self.slot, self.last = label, slot, first
        self.identity = first.identity
        self.since = self.seen = self.sought = first.track.time
        self.tracklet: Tracklet | None = None
        self.sightings = 1
        self.probe: Tracker[Any] | None = None
        self.probed: float | None = None

    def take_probe(self, tracklet: "Tracklet", time: float) -> None:
        """Take the tracker of a tracklet that was lost at a time, s, to look for the target with."""
        if self.probe is None:
            self.probe, self.probed, tracklet.tracker = tracklet.tracker, time, None

    def shape_at(self, place: Gate) -> Shape:
        """Return its shape at another place, px."""
        return shape_at(self.last, place)


class Hypothesis:
    """That a tracklet is of a target.

    Attributes
    ----------
    slot : int
        Of the filters: the target's motion if that is so.
    score : float
        Log-likelihood of the tracklet's sightings since it is in doubt.
    """

    def __init__(self, slot: int, score: float) -> None:
        self.slot, self.score = slot, score


class Tracklet:
    """Sightings of consecutive frames by one tracker.

    Parameters
    ----------
    label : str
        Key of the color.
    sighting : Sighting
        The first one.

    Attributes
    ----------
    tracker : Tracker or None
        None until the next frame.
    hypotheses : dict of Followed to Hypothesis
        Whose it may be.
    is_certain : bool
        Whether there is no doubt: then there is one hypothesis, whose filter is the target's.
    sighting : Sighting
        The last one.
    doubted : int
        Sightings since it is in doubt whose it is.
    restarts : int
        In how many frames to come its tracker is started where the filters expect it.
    """

    def __init__(self, label: str, sighting: Sighting) -> None:
        self.label, self.sighting = label, sighting
        self.tracker = sighting.tracker
        self.hypotheses: dict[Followed, Hypothesis] = {}
        self.is_certain = False
        self.doubted, self.restarts = 0, 0

    @property
    def target(self) -> Followed | None:
        """The target that it is taken for now."""
        return next((each for each in self.hypotheses if each.tracklet is self), None)

    def owner(self) -> Followed:
        """Return the target whose it is most likely."""
        if self.is_certain:
            return next(iter(self.hypotheses))
        return max(self.hypotheses, key=lambda each: self.hypotheses[each].score)

    def start(self, predicted: Predicted, passed: float) -> None:
        """Let its tracker begin where the next frame, `passed` seconds later, should show it."""
        owner = self.target or self.owner()
        assert self.tracker is not None
        start(self.tracker, self.sighting, predicted.likeliest(self.hypotheses[owner].slot), passed)


class Observed(NamedTuple):
    """What is seen in a frame.

    Attributes
    ----------
    continued : dict of Tracklet to Sighting
    ended : list of Tracklet
        Those whose trackers have lost what they followed, or are where another one is.
    fresh : list of Sighting
        What none of them follows.
    """

    continued: dict[Tracklet, Sighting]
    ended: list[Tracklet]
    fresh: list[Sighting]


def start(tracker: Tracker[Any], last: Sighting, expected: tuple[Gate, tuple[float, float]], passed: float) -> None:
    """Let a tracker begin where something is expected: place and velocity, `passed` seconds after the last frame."""
    place, (vx, vy) = expected
    before = place._replace(x=place.x - passed * vx, y=place.y - passed * vy)
    tracker.start(shape_at(last, before), (vx, vy))


def shape_at(last: Sighting, place: Gate) -> Shape:
    """Return the shape of a sighting at another place, px."""
    shape = last.track.shape
    state = shape.state.copy()
    state[:2] = place.x, place.y
    family = type(shape)
    if len(family.parameters) == 3:  # theorem: center and half-width are all that a family of three parameters has
        state[2] *= place.half_width / last.place.half_width
    moved: Shape = family.from_state(state, shape)
    return moved
