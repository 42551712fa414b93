"""What is seen of a crowd beside what is followed: `DoubtfulBalls`, and for a terminal `CrowdWatch`."""

import math
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TextIO

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.guidance.explain import PARAMETERS as EXPLAINED
from matchset.app.guidance.why_picture import covered, percent
from matchset.app.several.painter import shape_of
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.many.multi_tracker import MultiTracker
from matchset.tracking.many.sightings import is_near_one, place_of
from matchset.tracking.many.target import Target
from matchset.tracking.motion import Gate
from matchset.tracking.track import Track

Doubtful = tuple[Track[Any], ...]


class CrowdParameters(msgspec.Struct, frozen=True, kw_only=True):
    """For how long a person is shown what one search saw. All chosen by hand; nothing that is followed depends on it.

    Parameters
    ----------
    kept : float
        How long something doubtful is shown after a search saw it, s: a place is looked at again after 0.8 to 2.4 s at
        30 frames/s. Longer: more that is none; where the color is gone it ends at once.
    colored : float
        Share of its middle that must still have the color. More: what has moved on goes sooner, and a spotted ball.
    counted : float
        Over which time the largest number of those that were left out counts, s: a search finds some of them. Shorter:
        a number that flickers.
    """

    kept: float = 3.0
    colored: float = 0.4
    counted: float = 0.5


class DoubtfulBalls:
    """What a tracker of several sees beside what it follows, steady enough to look at.

    Parameters
    ----------
    tracker : MultiTracker
    parameters : CrowdParameters, optional

    Attributes
    ----------
    tracks : tuple of Track
        What may be one of the balls, and is not followed.
    left_out : int
        How many more were found lately than are followed.
    """

    def __init__(self, tracker: MultiTracker, parameters: CrowdParameters | None = None) -> None:
        self._tracker, self._parameters = tracker, parameters or CrowdParameters()
        self._left_out = deque[tuple[float, int]]()
        self.tracks: Doubtful = ()
        self.left_out = 0

    def update(self, frame: Frame, targets: Iterable[Target[Any]], left_out: int = 0) -> None:
        """Take note of the frame that the tracker has seen last.

        Parameters
        ----------
        frame : Frame
        targets : iterable of Target
            What it has answered.
        left_out : int
            How many of them are not followed on.
        """
        limits, time = self._parameters, frame.time
        expected = (shape_of(each) for each in targets)  # what is doubtful where one that is lost should be is that one
        taken = [place_of(shape) for shape in expected if shape is not None]
        kept = list[Track[Any]]()
        for each in [*(new for new in self._tracker.doubtful if new.time == time), *self.tracks]:
            place = place_of(each.shape)
            if (
                0.0 <= time - each.time <= limits.kept
                and not is_near_one(place, taken, 1.0)
                and self._is_there(frame, place)
            ):
                kept.append(each)
                taken.append(place)
        self.tracks = tuple(kept)
        if not self._tracker.finds:
            return
        self._left_out.append((time, self._tracker.left_out + left_out))
        while not 0.0 <= time - self._left_out[0][0] <= limits.counted:
            self._left_out.popleft()
        self.left_out = max(count for _, count in self._left_out)

    def at(self, x: float, y: float) -> Track[Any] | None:
        """Return what is doubtful at a point, px; None: nothing."""
        distances = [(math.hypot(each.x - x, each.y - y) / each.half_width) for each in map(place_of, self._shapes)]
        nearest = min(range(len(distances)), key=distances.__getitem__, default=None)
        return None if nearest is None or distances[nearest] > 1.0 else self.tracks[nearest]

    @property
    def _shapes(self) -> list[Any]:
        return [each.shape for each in self.tracks]

    def _is_there(self, frame: Frame, place: Gate) -> bool:
        """Whether something of one of the colors is at a place still."""
        half = max(0.7 * place.half_width, 1.0)
        left, right, top, bottom = (
            max(round(value), 0) for value in (place.x - half, place.x + half, place.y - half, place.y + half)
        )
        part = frame.image[top : bottom + 1, left : right + 1]
        return part.size > 0 and _most_covered(part, self._tracker) >= self._parameters.colored


def _most_covered(image: npt.NDArray[np.uint8], tracker: MultiTracker) -> float:
    """Return the largest share of a picture that one of the colors covers; all of it where only edges count."""
    return max(1.0 if color.gray else covered(image, color) for color in tracker.colors.values())


def watch_of(tracker: MultiTracker, family: type[Any], follows: bool, out: TextIO) -> "CrowdWatch | None":
    """Return what watches the first picture, and prints at once what is in it; None where nothing is searched for."""
    if not tracker.finds:
        return None
    noun = "ball" if family is Circle else family.__name__.lower()
    return CrowdWatch(tracker, noun, follows, lambda words: print(words, file=out, flush=True))


class CrowdWatch:
    """Says how many balls are in the first picture, how many are doubtful there, and how many are left out.

    Parameters
    ----------
    tracker : MultiTracker
    noun : str
        What each of them is: "ball".
    follows : bool
        Whether the tracker itself follows; else it sees the first picture alone, and others like it follow.
    say : callable
        Gets the sentence as soon as it is known.

    Attributes
    ----------
    words : str
        The sentence; empty before the first picture.
    """

    def __init__(self, tracker: MultiTracker, noun: str, follows: bool, say: Callable[[str], None]) -> None:
        self._tracker, self._noun, self._follows, self._say = tracker, noun, follows, say
        self._doubtful = DoubtfulBalls(tracker)
        self.words = ""
        self._first = self._most = 0

    def update(self, frame: Frame, targets: Sequence[Target[Any]]) -> None:
        """Take note of the next frame and of what was found in it."""
        is_first = not self.words
        if is_first and not self._follows:
            targets = self._tracker.update(frame)
        if is_first or self._follows:
            self._doubtful.update(frame, targets)
        if is_first:
            self.words = self._in_words(frame, sum(isinstance(each.track, Track) for each in targets))
            self._say(self.words)
            self._first = self._doubtful.left_out
        self._most = max(self._most, self._doubtful.left_out)

    @property
    def lines(self) -> list[str]:
        """What is said at the end: the sentence again, and how many were left out later."""
        later = f"later up to {self._most} at once left out, since --most is {self._tracker.most}"
        return [self.words, *([later] if self._most > self._first else [])] if self.words else []

    @property
    def doubtful(self) -> Doubtful:
        """What may be one of the balls in the last frame."""
        return self._doubtful.tracks if self._follows else ()

    def _in_words(self, frame: Frame, followed: int) -> str:
        tracker = self._tracker
        doubtful, left_out = len(self._doubtful.tracks), self._doubtful.left_out
        found = followed + left_out
        parts = [f"first picture: {found or 'no'} {self._noun}{'' if found < 2 else 's'} like it"]
        if left_out:
            parts.append(f"{left_out} left out, since --most is {tracker.most}")
        if doubtful:
            parts.append(f"{doubtful} more {'is' if doubtful == 1 else 'are'} doubtful")
        share = _most_covered(frame.image, tracker)
        if EXPLAINED.wide < share and not all(each.gray for each in tracker.colors.values()):
            parts.append(f"the color covers {percent(100.0 * share)} of it: narrow it, unless the {self._noun}s do")
        elif not followed and share == 0.0:
            parts.append("nothing in it has the color")
        return "; ".join(parts)
