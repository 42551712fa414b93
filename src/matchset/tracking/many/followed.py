"""One target of several: its tracker, its slot in the filters, and what was last seen of it (`Followed`)."""

from typing import Any

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.shape import Shape
from matchset.tracking.many.motion_bank import Predicted
from matchset.tracking.motion import Gate, gate_of
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker


class Group:
    """Targets of which only the nearest is seen; which of them that is, what was seen since they met will tell.

    Attributes
    ----------
    scores : dict of Followed to float
        Log-likelihood of what was seen since, if that was this target.
    """

    def __init__(self) -> None:
        self.scores: dict[Followed, float] = {}

    def add(self, each: "Followed", score: float) -> None:
        """Add a target."""
        self.scores[each], each.group = score, self

    def remove(self, each: "Followed") -> None:
        """Remove a target; one that remains alone is in no group."""
        del self.scores[each]
        each.group = None
        if len(self.scores) == 1:
            next(iter(self.scores)).group = None
            self.scores.clear()

    def handicap(self, each: "Followed") -> float:
        """Return how much less likely it is that this target was seen than that the likeliest one was."""
        return max(self.scores.values()) - self.scores[each]


class Followed:
    """A target that is followed, or expected while it is hidden.

    Parameters
    ----------
    label : str
        Key of its color.
    slot : int
        Of the motion bank.
    tracker : Tracker
        Which never searches the whole frame.
    track : Track
        Where it was found.

    Attributes
    ----------
    identity : int or None
        None until it is confirmed.
    since : float
        When it was found first, s.
    track : Track
        The last one.
    own : bool
        Whether its tracker's own last sighting was taken for it: it need not be started anew.
    sightings : int
        In how many frames it was seen.
    restarts : int
        In how many frames to come its tracker is started where the filters expect it.
    group : Group or None
        Those of which only one is seen, this one among them.
    """

    def __init__(self, label: str, slot: int, tracker: Tracker[Any], track: Track[Any]) -> None:
        self.label, self.slot, self.tracker, self.track = label, slot, tracker, track
        self.identity: int | None = None
        self.since = self.seen = self.sought = track.time
        self.own, self.sightings, self.restarts = False, 1, 0
        self.group: Group | None = None
        tracker.restart(track.shape)

    @property
    def family(self) -> type[Any]:
        """The family of its shape."""
        return type(self.track.shape)

    @property
    def place(self) -> Gate:
        """Where it was seen last, and its half-width, px."""
        return gate_of(self.family, self.track.shape.state)

    def expected(self, predicted: Predicted) -> Gate:
        """Return where it should be, px; of one that is hidden behind another, by its motion before."""
        slot = self.slot_now(predicted)
        center, _, _ = predicted.likeliest(slot)
        return Gate(float(center[0]), float(center[1]), float(predicted.half_widths[slot]))

    def slot_now(self, predicted: Predicted) -> int:
        """Slot of the filters that say where it is: the second one while it is hidden behind another target."""
        return self.slot if self.group is None or self.own else self.slot + len(predicted.half_widths) // 2

    def shape_at(self, place: Gate) -> Shape:
        """Return its shape at another place, px."""
        state = self.track.shape.state.copy()
        state[:2] = place.x, place.y
        if len(state) == 3:  # theorem: center and half-width are all that a family of three parameters has
            state[2] *= place.half_width / self.place.half_width
        shape: Shape = self.family.from_state(state, self.track.shape)
        return shape

    def follow(self, frame: Frame, predicted: Predicted, passed: float) -> Track[Any] | Lost[Any]:
        """Track it in a frame, `passed` seconds after the one before; from where it is expected if it was hidden."""
        if not self.own or self.restarts > 0:
            slot = self.slot_now(predicted)
            center, velocity, _ = predicted.likeliest(slot)
            before = center - passed * velocity
            place = Gate(float(before[0]), float(before[1]), float(predicted.half_widths[slot]))
            self.tracker.start(self.shape_at(place), (float(velocity[0]), float(velocity[1])))
            self.restarts -= 1
        return self.tracker.update(frame)
