"""Which targets of a recorded video look alike and are followed together: `FileGroup`, `FileGroups`."""

import itertools
from collections.abc import Iterable
from typing import Any

import msgspec

from matchset.live.files.file_target import FileTarget
from matchset.live.targets.alike import ALIKE, AlikeParameters, are_alike, on_one
from matchset.tracking.track import Lost, Track


class FileGroupParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How all that looks like a target is found in a video.

    Parameters
    ----------
    lead : int
        Frames after the first one in which the way backward begins, with what the way forward has found up to there.
        Fewer: what is found in the second frame is not known yet, and has two names. Chosen by hand: a search takes
        three frames, and what it finds counts from its second sighting on.
    alike : AlikeParameters
    """

    lead: int = 8
    alike: AlikeParameters = ALIKE


class FileGroup:
    """Targets of a video that look alike.

    Parameters
    ----------
    parameters : FileGroupParameters, optional

    Attributes
    ----------
    members : dict of int to FileTarget
    finds : bool
        Whether all that looks like them is followed, too.
    told : dict of int to dict of int to Track
        Where a person said that targets are, by the places of frames and their numbers.
    """

    def __init__(self, parameters: FileGroupParameters | None = None) -> None:
        self.parameters = parameters or FileGroupParameters()
        self.members: dict[int, FileTarget] = {}
        self.finds = False
        self.told: dict[int, dict[int, Track[Any]]] = {}

    def add(self, target: FileTarget) -> None:
        """Take a target; where it was clicked and found it certainly is."""
        self.members[target.number] = target
        for place in target.clicks if target.clicked else ():
            answer = target.answer(place)
            if isinstance(answer, Track):
                self.told.setdefault(place, {})[target.number] = answer

    def remove(self, number: int) -> None:
        """Follow a target no more."""
        self.members.pop(number, None)
        for known in self.told.values():
            known.pop(number, None)

    def correct(self, number: int, place: int, track: Track[Any]) -> None:
        """Take note where a target is; another one that was taken for it there was this one."""
        target = self.members[number]
        before = target.answer(place)
        self.told.setdefault(place, {})[number] = track
        for other in self.members.values():
            taken = other.answer(place)
            if other is target or not (isinstance(taken, Track) and on_one(taken, track)):
                continue
            if isinstance(before, Track) and not on_one(before, track):
                self.told[place][other.number] = before
                other.put(place, before)
            else:
                other.put(place, Lost(f"hidden behind {target.name}, which looks the same", track.time))
        target.put(place, track)

    def twins(self, place: int) -> tuple[FileTarget, FileTarget] | None:
        """Return two members that are on one outline in a frame, the elder first; None: there are none."""
        for one, other in itertools.combinations(self.members.values(), 2):
            a, b = one.answer(place), other.answer(place)
            if isinstance(a, Track) and isinstance(b, Track) and on_one(a, b):
                return one, other
        return None

    def set_finds(self, finds: bool) -> None:
        """Have all that looks like them followed, too, or no more of them."""
        self.finds = finds
        for each in self.members.values():
            each.finds = finds
            each.version += 1

    def looks_like(self, target: FileTarget) -> bool:
        """Whether a target looks like its members."""
        return any(look_alike(target, each, self.parameters.alike) for each in self.members.values())

    def next_told(self, place: int) -> int | None:
        """Return the next frame after this one for which a person said where a target is."""
        return min((each for each in self.told if each > place), default=None)


class FileGroups:
    """All groups of a video.

    Parameters
    ----------
    parameters : FileGroupParameters, optional
    """

    def __init__(self, parameters: FileGroupParameters | None = None) -> None:
        self._parameters = parameters or FileGroupParameters()
        self._groups: list[FileGroup] = []

    def of(self, number: int) -> FileGroup | None:
        """Return the group of a target."""
        return next((each for each in self._groups if number in each.members), None)

    def join(self, target: FileTarget, others: Iterable[FileTarget]) -> FileGroup | None:
        """Take a target into the group of those that look like it, or begin one with one of the others."""
        group = next((each for each in self._groups if each.looks_like(target)), None)
        if group is None:
            other = next((each for each in others if look_alike(each, target, self._parameters.alike)), None)
            if other is None:
                return None
            group = self.begin(other)
        group.add(target)
        return group

    def begin(self, target: FileTarget) -> FileGroup:
        """Return the group of a target; a new one if it is in none."""
        group = self.of(target.number)
        if group is None:
            group = FileGroup(self._parameters)
            group.add(target)
            self._groups.append(group)
        return group

    def end_finding(self, number: int) -> bool:
        """Look for no more like a target that a person drops; returns whether some were looked for, and others stay."""
        group = self.of(number)
        if group is None or not group.finds or len(group.members) == 1:
            return False
        group.set_finds(False)
        return True

    def forget(self, number: int) -> None:
        """Follow a target no more."""
        group = self.of(number)
        if group is not None:
            group.remove(number)
            self._groups = [each for each in self._groups if each.members]


def look_alike(one: FileTarget, other: FileTarget, parameters: AlikeParameters = ALIKE) -> bool:
    """Whether two targets have one color and are of one family."""
    if one.color is None or other.color is None or one.shape != other.shape:
        return False
    return are_alike(one.color, other.color, parameters)
