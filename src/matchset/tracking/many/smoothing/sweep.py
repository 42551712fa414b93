"""One reading of a video, forward or backward: what its trackers saw in each frame (`Sweep`)."""

import contextlib
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import msgspec

from matchset.image.frame import Frame
from matchset.shapes.shape import Shape
from matchset.tracking.many.linking import Linking
from matchset.tracking.many.sightings import Sighting
from matchset.tracking.many.target import Target
from matchset.tracking.many.tracklet import Followed, Tracklet
from matchset.tracking.track import mirrored


class Click(NamedTuple):
    """Something in a video that shall be followed.

    Attributes
    ----------
    frame : int
        Index of the frame.
    what : (float, float) or Shape
        A point of it, px, or its outline, roughly.
    label : str or None
        Of its color; None where there is one only.
    """

    frame: int
    what: tuple[float, float] | Shape
    label: str | None = None


class SeveralFollower(Protocol):
    """What follows several targets from frame to frame."""

    def add(self, what: tuple[float, float] | Shape, label: str | None = None) -> int:
        """Follow what is at a point, or a shape, from the next frame on."""
        ...

    def update(self, frame: Frame) -> list[Target[Any]]:
        """Track all targets in a frame."""
        ...


class OwnedSighting(NamedTuple):
    """An outline in a frame, and whose it was taken for in the end.

    Attributes
    ----------
    sighting : Sighting
        In the time of its frame.
    owner : int
        Number of the target in its sweep.
    tracklet : int
        Number of the tracklet in its sweep.
    is_certain : bool
        Whether that it is of this owner was certain in this frame.
    """

    sighting: Sighting
    owner: int
    tracklet: int
    is_certain: bool


class _Noted(NamedTuple):
    """A tracklet's sighting in a frame, and whose that was taken for then."""

    place: int
    sighting: Sighting
    owner: Followed | None
    is_certain: bool


class Sweep:
    """Notes what is seen in each frame, in one direction.

    A tracklet whose owner was in doubt for some frames has that owner in them for which it was taken in the end.

    Parameters
    ----------
    tracker : MultiTracker
        That has seen no frame.
    linking : Linking
        Of that tracker.
    clicks : sequence of Click
    strict : bool
        Whether a click on what is followed already is a ValueError.
    backward : bool
        Whether frames come in reverse: the tracker then sees each at its time mirrored at that of the first one.

    Attributes
    ----------
    identities : list of (int or None)
        Those that the tracker gave its targets, by their numbers in `OwnedSighting.owner`.
    """

    def __init__(
        self, tracker: SeveralFollower, linking: Linking, clicks: Sequence[Click], strict: bool, backward: bool = False
    ) -> None:
        self._tracker, self._linking, self._strict, self._backward = tracker, linking, strict, backward
        self._clicks = sorted(clicks, key=lambda click: -click.frame if backward else click.frame)
        self._notes: dict[Tracklet, list[_Noted]] = {}
        self._twice: float | None = None  # twice the time at which it is mirrored, s
        self._count = 0
        self.identities: list[int | None] = []

    def update(self, frame: Frame) -> None:
        """Track all targets in the next frame.

        Raises
        ------
        ValueError
            As by `MultiTracker.update`, and by `MultiTracker.add` where that is strict.
        """
        self._click(frame.index)
        shown = frame
        if self._backward:
            self._twice = 2.0 * frame.time if self._twice is None else self._twice
            shown = msgspec.structs.replace(frame, time=self._twice - frame.time)
        self._tracker.update(shown)
        for tracklet in self._linking.tracklets:
            sighting = tracklet.sighting._replace(tracker=None)
            if self._twice is not None:
                sighting = sighting._replace(track=mirrored(sighting.track, frame.time, self._twice))
            noted = _Noted(self._count, sighting, tracklet.target, tracklet.is_certain)
            self._notes.setdefault(tracklet, []).append(noted)
        self._count += 1

    def sightings(self) -> list[list[OwnedSighting]]:
        """Return what was seen and taken for a target, frame by frame in order of time."""
        frames: list[list[OwnedSighting]] = [[] for _ in range(self._count)]
        numbers: dict[Followed, int] = {}
        for tracklet, notes in enumerate(self._notes.values()):
            owner: Followed | None = notes[-1].owner
            for noted in reversed(notes):
                owner = noted.owner if noted.is_certain or owner is None else owner
                if owner is not None:
                    number = numbers.setdefault(owner, len(numbers))
                    frames[noted.place].append(OwnedSighting(noted.sighting, number, tracklet, noted.is_certain))
        self.identities = [each.identity for each in numbers]
        return frames[::-1] if self._backward else frames

    def last_seen(self, indices: Sequence[int]) -> list[Click]:
        """Return where each target was seen last, as clicks; `indices` of the frames in order of time."""
        last: dict[int, Click] = {}
        for index, sightings in zip(indices, self.sightings(), strict=True):
            for each in sightings:
                last[each.owner] = Click(index, each.sighting.track.shape, each.sighting.label)
        return list(last.values())

    def _click(self, index: int) -> None:
        """Hand the tracker what was clicked up to here."""
        while self._clicks and (self._clicks[0].frame >= index if self._backward else self._clicks[0].frame <= index):
            _, what, label = self._clicks.pop(0)
            with contextlib.suppress(*([] if self._strict else [ValueError])):
                self._tracker.add(what, label)
