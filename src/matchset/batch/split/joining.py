"""One table of the stretches of a video: frames are matched by their pictures, targets by their places.

`cuts_between` finds where stretches go over into each other, `joined` writes the table.
"""

import csv
import io
import itertools
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence

import msgspec
import numpy as np
from scipy.optimize import linear_sum_assignment

from matchset.media.video_stretch import StretchMark, StretchParameters

TIME_STEP = 1e-6  # format: of the times in tables, s
BEHIND = re.compile(r"(?<=\bbehind target )\d+")  # format: an identity in the words of `tracking.many`


class MisfitError(ValueError):
    """Two stretches do not have the same pictures where they overlap."""


class JoinParameters(msgspec.Struct, frozen=True):
    """When two stretches are believed to be parts of one video, and where one goes over into the other.

    Parameters
    ----------
    pictures : int
        Pictures that must be the same. More: not satisfied by still pictures alone; needs a longer overlap.
    same : int
        Frames with a target that is seen whose rows must be the same in both, one after the other, where one goes over
        into the other; from there on they must be to the end of the overlap. More: it is surer that they stay the
        same, and more often the overlap ends first.
    near : float
        Targets of both are one if their places differ by less than so many radii, in most of the frames.
    """

    pictures: int = 30
    same: int = 150
    near: float = 0.5


PARAMETERS = JoinParameters()
Row = list[str]


class Part:
    """The table of a stretch, and the marks of its frames.

    Parameters
    ----------
    table : bytes
        tracks.csv or poses.csv.
    marks : sequence of StretchMark

    Attributes
    ----------
    names : list of str
        Its columns.
    rows : dict of int to list
        The rows of each frame, by its number.
    """

    def __init__(self, table: bytes, marks: Sequence[StretchMark]) -> None:
        lines = csv.reader(io.StringIO(table.decode(), newline=""))
        self.names, self.marks = next(lines), list(marks)
        self.rows: dict[int, list[Row]] = {}
        for row in lines:
            self.rows.setdefault(int(row[0]), []).append(row)

    def column(self, name: str) -> int | None:
        """Return the place of a column; None if there is none."""
        return self.names.index(name) if name in self.names else None


class Cut(msgspec.Struct, frozen=True):
    """Where one stretch goes over into the next.

    Parameters
    ----------
    frame : int
        The first frame of the later stretch's rows, by its own number.
    shift : int
        What is to be added to the numbers of its frames.
    same : bool
        Whether the rows of both are the same from there to the end of the overlap.
    names : dict of str to str
        The identities of its targets in the earlier one.
    """

    frame: int
    shift: int
    same: bool
    names: dict[str, str]


def cuts_between(parts: Sequence[Part], parameters: JoinParameters = PARAMETERS) -> list[Cut]:
    """Find where stretches go over into each other.

    Parameters
    ----------
    parts : sequence of Part
        In their order.

    Raises
    ------
    MisfitError
        If two of them do not have the same pictures where they overlap, or three have.
    """
    cuts = [cut_between(one, other, parameters) for one, other in itertools.pairwise(parts)]
    for before, after in itertools.pairwise(cuts):
        if not before.frame < after.frame + after.shift:
            raise MisfitError("two stretches overlap a third one at the same place")
    cycle, shifts = StretchParameters().cycle, itertools.accumulate(cut.shift for cut in cuts)
    in_step = [shift % cycle == 0 for shift in shifts]  # else what is done in every n-th frame was in others
    return [msgspec.structs.replace(cut, same=cut.same and fits) for cut, fits in zip(cuts, in_step, strict=True)]


def frames_needed(parameters: JoinParameters = PARAMETERS) -> int:
    """Return how many frames two stretches must have in common, at least, so that they may be joined."""
    return parameters.same + StretchParameters().cycle


def joined(parts: Sequence[Part], cuts: Sequence[Cut]) -> bytes:
    """Return one table of all stretches.

    Parameters
    ----------
    parts : sequence of Part
    cuts : sequence of Cut
        `cuts_between` them.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(parts[0].names)
    shift, begin, used, names = 0, -math.inf, 0, dict[str, str]()
    for number, part in enumerate(parts):
        cut = cuts[number] if number < len(cuts) else None
        end = math.inf if cut is None else cut.frame + cut.shift
        for frame, rows in part.rows.items():
            if begin <= frame < end:
                writer.writerows(_renamed(part, rows, frame + shift, names))
        used = _used(part, names, used, begin, end)
        if cut is not None:
            names = _next_names(parts[number + 1], cut, names, used)
            begin, shift = cut.frame, shift + cut.shift
    return text.getvalue().encode()


def cut_between(one: Part, other: Part, parameters: JoinParameters = PARAMETERS) -> Cut:
    """Find where a stretch goes over into the next one.

    Raises
    ------
    MisfitError
        If their pictures or times are not the same where they overlap.
    """
    shift, common = _shift(one, other, parameters)
    names = _same_targets(one, other, shift, common, parameters)
    marks, others = {mark.index - shift: mark for mark in one.marks}, {mark.index: mark for mark in other.marks}
    run, place = 0, None
    for frame in range(common[0], min(max(marks), max(others)) + 1):
        before, after = one.rows.get(frame + shift, []), other.rows.get(frame, [])
        pictures = marks.get(frame), others.get(frame)
        if not _same_picture(*pictures) or _comparable(one, before, {}) != _comparable(other, after, names):
            run, place = 0, None
        elif _any_seen(other, after):
            run += 1
        if run >= parameters.same and place is None:
            place = frame
    return Cut(common[-1] if place is None else place, shift, place is not None, names)


def _same_picture(one: StretchMark | None, other: StretchMark | None) -> bool:
    """Whether a frame is the same in both stretches, or decodes in neither."""
    if one is None or other is None:
        return one is other
    return one.stamp == other.stamp and one.checksum == other.checksum and abs(one.time - other.time) < TIME_STEP


def _shift(one: Part, other: Part, parameters: JoinParameters) -> tuple[int, list[int]]:
    """Return what is to be added to the frames' numbers of the later part, and its frames that the earlier one has."""
    places = {mark.stamp: mark for mark in one.marks}
    pairs = [(places[mark.stamp], mark) for mark in other.marks if mark.stamp in places]
    same = [(a, b) for a, b in pairs if _same_picture(a, b)]
    shifts = Counter(a.index - b.index for a, b in same)
    shift, count = shifts.most_common(1)[0] if shifts else (0, 0)
    common = [b.index for a, b in same if a.index - b.index == shift]
    if count < parameters.pictures or len(common) < len(pairs) - parameters.pictures:
        raise MisfitError(f"{count} of {len(pairs)} pictures of two stretches are the same where they overlap")
    return shift, common


def _comparable(part: Part, rows: Sequence[Row], names: dict[str, str]) -> list[Row]:
    """Return the rows of a frame without its number, each with the identity that it has in the earlier stretch."""
    identity = part.column("identity")
    if identity is None:
        return [row[2:] for row in rows]
    return sorted(_with_names(part, row, lambda name: names.get(name, "new") if names else name)[2:] for row in rows)


def _with_names(part: Part, row: Row, name_of: Callable[[str], str]) -> Row:
    """Return a row with other identities, wherever it names one."""
    changed = list(row)
    for name in ("identity", "alternatives", "reason"):
        column = part.column(name)
        if column is not None and name == "reason":
            changed[column] = BEHIND.sub(lambda found: name_of(found[0]), row[column])
        elif column is not None:
            changed[column] = " ".join(sorted(map(name_of, row[column].split()), key=lambda each: (len(each), each)))
    return changed


def _any_seen(part: Part, rows: Sequence[Row]) -> bool:
    """Whether a target is seen in a frame: where none is, rows are the same, whatever a tracker knows."""
    found = part.column("found")
    return found is not None and any(row[found] == "1" for row in rows)


def _same_targets(
    one: Part, other: Part, shift: int, common: Sequence[int], parameters: JoinParameters
) -> dict[str, str]:
    """Return the identities of targets of the later stretch in the earlier one, by where they are."""
    if one.column("identity") is None:
        return {}
    votes: Counter[tuple[str, str]] = Counter()
    for frame in common:
        before = list(_places(one, one.rows.get(frame + shift, [])))
        after = list(_places(other, other.rows.get(frame, [])))
        apart = np.array([[math.dist(new[1:3], old[1:3]) for old in before] for new in after]).reshape(
            len(after), len(before)
        )
        for row, column in zip(*linear_sum_assignment(apart), strict=True):
            if apart[row, column] < parameters.near * after[row][3]:
                votes[after[row][0], before[column][0]] += 1
    names: dict[str, str] = {}
    for (name, old), _ in votes.most_common():
        if name not in names and old not in names.values():
            names[name] = old
    return names


def _places(part: Part, rows: Sequence[Row]) -> Iterator[tuple[str, float, float, float]]:
    """Yield identity, place and size of the targets that are seen in a frame."""
    identity, found = part.column("identity"), part.column("found")
    assert identity is not None
    assert found is not None
    first = found + 1  # the shape's, or the pose's, x and y; then its size, of a pose the distance
    for row in rows:
        if row[found] == "1":
            x, y, size = (float(each) for each in row[first : first + 3])
            yield row[identity], x, y, size


def _renamed(part: Part, rows: Sequence[Row], frame: int, names: dict[str, str]) -> Iterator[Row]:
    """Yield the rows of a frame with its number and the identities in the whole video."""
    identity = part.column("identity")
    if identity is not None and names:
        changed = [_with_names(part, row, lambda name: names.get(name, name)) for row in rows]
        rows = sorted(changed, key=lambda row: int(row[identity]))
    for row in rows:
        yield [str(frame), *row[1:]]


def _used(part: Part, names: dict[str, str], used: int, begin: float, end: float) -> int:
    """Return how many identities the whole video has used up to the end of what is taken of a stretch."""
    identity = part.column("identity")
    if identity is None:
        return 0
    own = {row[identity] for frame, rows in part.rows.items() if begin <= frame < end for row in rows}
    return max([used, *(int(names.get(each, each)) + 1 for each in own)])


def _next_names(part: Part, cut: Cut, names: dict[str, str], used: int) -> dict[str, str]:
    """Return the identities in the whole video of the targets of the next stretch; new ones get new numbers."""
    identity = part.column("identity")
    if identity is None:
        return {}
    found = {new: names.get(old, old) for new, old in cut.names.items()}
    used = max([used, *(int(each) + 1 for each in found.values())])
    for frame in sorted(part.rows):
        for row in part.rows[frame] if frame >= cut.frame else ():
            if row[identity] not in found:
                found[row[identity]], used = str(used), used + 1
    return found
