"""Follow a shape from frame to frame: `Tracker` (Epstein & Feldman, Alg. 1 and 3)."""

import math
from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.shape import Shape, finds_itself
from matchset.tracking.begin import begin_near
from matchset.tracking.detect import MOVING, Finder, channels_last
from matchset.tracking.doubt import BETTER, DRAWN, SURELY, alternatives, drawn_out, worth
from matchset.tracking.judge import Judge, Prior
from matchset.tracking.look import Look
from matchset.tracking.matcher import Matcher
from matchset.tracking.memory import EVIDENCE, SEEN, SPEED, SURPRISE, TIME
from matchset.tracking.palette import suited
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.place import place_of
from matchset.tracking.step import NEVER
from matchset.tracking.track import Lost, Track
from matchset.tracking.verdict import is_near, missing
from matchset.tracking.voting import Searcher
from matchset.tracking.warm_up import warm_up

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

FAINT, CLEAR = 0.4, 0.5  # evidence below which a shape is seen faintly, and from which clearly again
PATIENCE = 5  # frames in which a shape may be seen faintly before it counts as lost
FAR = 3.0  # half-widths from its prediction beyond which nothing speaks for a sighting but itself
AGAIN = 3  # every so many frames a shape that is confirmed and doubtful is looked at again; circles always are
TEACH = 3  # every so many frames the color may learn: light changes slowly


class Tracker(Generic[S]):
    """Follows one shape; a tracker belongs to one thread, any number of them may run side by side.

    Parameters
    ----------
    family : type
        The family of shapes: `Circle`, `Rectangle`, ...
    color : ColorModel
        What the target looks like; the tracker adapts a copy of its own, `tracker.color`.
    points : int
        Size of the match-set: the number of lines across the outline. More is more exact and slower.
    start : tuple of float, optional
        A point (x, y), px: the first search prefers the candidate that holds it.
    parameters : TrackerParameters, optional

    Raises
    ------
    ValueError
        If there are fewer than 16 or more than 4096 points, or the start is not finite.

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> rows, columns = np.indices((120, 160))
    >>> image = np.full((120, 160, 3), 90, np.uint8)
    >>> image[np.hypot(columns - 70, rows - 50) < 25] = (200, 60, 30)
    >>> tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 70, 50))
    >>> track = tracker.update(ms.Frame(image, 0.0, 0))
    >>> round(track.shape.x), round(track.shape.y), round(track.shape.radius)
    (70, 50, 25)
    """

    def __init__(
        self,
        family: type[S],
        color: ColorModel,
        points: int = 64,
        start: tuple[float, float] | None = None,
        parameters: TrackerParameters | None = None,
    ) -> None:
        if not 16 <= points <= 4096:
            raise ValueError(f"a match-set needs 16 to 4096 points, got {points}")
        if start is not None and not all(math.isfinite(value) for value in start):
            raise ValueError(f"start must be finite, got {start}")
        self.parameters = parameters or TrackerParameters()
        self.color = color.copy()
        self._learned = self.color.log_odds.copy()
        self._begun: S | None = None
        self._family = family
        self._matcher: Matcher[S] = Matcher(family, points, self.parameters)
        if color.gray == "edges":
            self._matcher.ignore_color()
        self._doubts = AGAIN if finds_itself(family) else 1
        self._judge = Judge()
        self._wish, self._follows = start, False
        self._finder: Finder[S] | None = None
        self._kind: tuple[int, ...] | None = None
        self._time, self._interval = -math.inf, 1.0 / 30.0
        self._frames, self._faint = 0, 0
        warm_up(family, color.table.size, color.channels)

    def start(self, shape: S) -> None:
        """Begin at this shape in the next frame, without a search.

        Parameters
        ----------
        shape : S
            Where the shape is, roughly.

        Raises
        ------
        ValueError
            If it is not of the family that is followed.
        """
        if not isinstance(shape, self._family):
            raise ValueError(f"this tracker follows {self._family.__name__}, got {shape!r}")
        self._matcher.begin(shape.state, self._time, 3.0 + 0.1 * self._family.half_width(shape.state))
        self._matcher.describe_like(shape)
        self._begun = shape
        self._follows = True

    def update(self, frame: Frame) -> Track[S] | Lost[S]:
        """Follow the shape into `frame`: predict, match, fit; search the whole frame only when lost.

        Parameters
        ----------
        frame : Frame
            The next picture, later than the one before.

        Returns
        -------
        Track or Lost
            A `Track` only if this frame's own pixels confirm it; while the shape is not seen a `Lost` that says why,
            and for a while where the motion would have it.

        Raises
        ------
        ValueError
            If the time does not run forward, the size or the channels of the picture changed on the way, or the
            color was learned on another kind of picture.
        """
        image = self._admit(frame)
        if self._begun is not None or (not self._follows and self.color.gray):
            self._adopt(image)
        if not self._follows:
            return self._search(image, "nothing of this color and shape is in the picture")
        found = self._matcher.advance(image, self.color, self._learned, frame.time, self._interval, self._turn())
        if isinstance(found, int):
            reason = self._recover(image, self._judge.words(self._matcher, found))
            if reason:
                return self._search(image, reason)
            found = self._matcher.take_in(frame.time)
            self._matcher.learn(image, self.color, self._learned, self._turn())
        return found

    def _admit(self, frame: Frame) -> Image:
        """Check a frame against those before it; its picture as (h, w, channels)."""
        image, time = frame.image, frame.time
        if image.shape != self._kind:
            self._accept(frame)
        if not time > self._time:
            raise ValueError(
                f"time must run forward: frame {frame.index} is at {time} s, the one before at {self._time} s"
            )
        if self._frames:
            passed = time - self._time
            self._interval = passed if passed < 1.0 else 1.0
        self._time = time
        self._frames += 1
        return channels_last(image)

    def _accept(self, frame: Frame) -> None:
        """Take the first frame's size and channels; refuse a change on the way."""
        if self._kind is not None:
            raise ValueError(
                f"frame {frame.index} has shape {frame.image.shape}, the frames before it had {self._kind}"
            )
        self.color.check(frame.image)
        self._kind = frame.image.shape

    def _missed(self) -> float:
        """How many frames have passed since the last sighting, at least 1."""
        return max((self._time - self._matcher.clock(TIME)) / self._interval, 1.0)

    def _recover(self, image: Image, reason: str) -> str:
        """Look again where the first look was not enough; why that failed too, empty if it did not.

        Wider, if the first look found nothing; at the shapes around it, if it is doubtful; and with the evidence of a
        first sight, if it is far from where it was expected.
        """
        limits, matcher = self.parameters, self._matcher
        missed, expected = self._missed(), matcher.parts.expected
        speed, surprise = self._interval * matcher.clock(SPEED), matcher.clock(SURPRISE)
        if reason and limits.least_reach + 2.0 * surprise * missed < limits.most_reach:
            reason = self._try(image, expected, Look(limits.most_reach, speed))
        if matcher.is_doubtful and (reason or self._frames % self._doubts == 0):
            reason = self._look_again(image, reason, speed)
        here, there = place_of(self._family, expected), place_of(self._family, matcher.state)
        if not reason:
            reason = self._faintly()
        if not reason and not is_near(matcher.state, there.size, expected, here.size, surprise):
            reason = self._judge.first_sight(matcher)
            if not reason and not here.reachable(there, missed, limits):
                reason = "it would have jumped or changed its size faster than it can"
        return reason

    def _faintly(self) -> str:
        """Why a shape that speaks faintly for itself is given up, empty if it is not: that cannot go on for long."""
        evidence = self._matcher.fit(EVIDENCE)
        if evidence < FAINT:
            self._faint += 1
        elif evidence > CLEAR:
            self._faint = 0
        return "hardly anything has spoken for it for a while" if self._faint > PATIENCE else ""

    def _try(self, image: Image, state: Floats, look: Look) -> str:
        """Fit near a state; why it is not confirmed, empty if it is."""
        matcher = self._matcher
        if not matcher.settle(image, self.color, state, look):
            return self._judge.words(matcher, missing(matcher.fit(SEEN), matcher.points))
        return self._judge.following(matcher)

    def _look_again(self, image: Image, reason: str, speed: float) -> str:
        """Go on with the best of the shapes around a doubtful one; why it is not confirmed, empty if it is."""
        matcher = self._matcher
        best, most = matcher.state.copy(), -math.inf if reason else worth(matcher, image, self.color) + BETTER
        drawn, starts = drawn_out(matcher), list(alternatives(matcher, image, self.color))
        if drawn is not None:
            least = max(matcher.fit(EVIDENCE) + DRAWN, SURELY)
            matcher.trust_modes()
            if not self._try(image, drawn, Look(5.0, speed)) and matcher.fit(EVIDENCE) > least:
                return ""
        for start in starts:
            lost = self._try(image, start, Look(5.0, speed, 2.0))
            if not lost and (value := worth(matcher, image, self.color)) > most:
                best, most = matcher.state.copy(), value
        return self._try(image, best, Look(3.0, speed, 1.0))

    def _can_be(self, state: Floats, expected: Floats, missed: float) -> bool:
        """Whether a sighting can be the lost shape: near its prediction, or farther off with full evidence."""
        here, there = place_of(self._family, expected), place_of(self._family, state)
        if here.about(there):
            return True
        lone = math.hypot(there.x - here.x, there.y - here.y) > FAR * max(here.size, there.size)
        prior = Prior.NONE if lone else Prior.PRESENT
        return not self._judge.first_sight(self._matcher, prior) and here.reachable(there, missed, self.parameters)

    def _turn(self) -> int:
        """Which quarter of the outline's surroundings teaches the color in this frame."""
        return NEVER if self._frames % TEACH or self.color.gray == "edges" else self._frames // TEACH % 4

    def _adopt(self, image: Image) -> None:
        """Take the model as it suits this picture, and the shape that was said to be in it."""
        said, self._begun = self._begun, None
        if self.color.gray:
            self.color = suited(self.color, image, said)
            self._learned = self.color.log_odds.copy()
        if said is not None and self._doubts > 1:
            state, spread = begin_near(image, self.color, self._matcher, said)
            self._matcher.begin(state, -math.inf, spread)

    def _search(self, image: Image, reason: str) -> Track[S] | Lost[S]:
        """Look through the whole frame; while coasting only what can be the lost shape counts."""
        matcher = self._matcher
        self._follows = self._follows and self._time - matcher.clock(TIME) <= self.parameters.coast
        expected = matcher.predict(self._time, 1.0).copy() if self._follows else None
        if expected is not None and self._family.half_width(expected) == 0.0:  # the motion would turn it inside out
            self._follows, expected = False, None
        best = self._choose(image, expected) if self.parameters.search.whole_frame else None
        if best is None:
            return Lost(reason, self._time, None if expected is None else matcher.shape_of(expected))
        lone = expected is None and self._wish is None
        self._try(image, matcher.alike(best), Look(4.0, MOVING if lone else 0.0, blind=True))
        refuted = self._judge.first_sight(matcher, self._prior(expected))
        if refuted or not self._family.half_width(matcher.state) > 0.0:  # the second fit ran away
            return Lost(refuted or reason, self._time, None if expected is None else matcher.shape_of(expected))
        if expected is None:
            matcher.begin(matcher.state, self._time, 0.25 * self._family.half_width(best))
        self._follows, self._wish = True, None
        if matcher.fit(EVIDENCE) > CLEAR:
            self._faint = 0
        found = matcher.take_in(self._time)
        matcher.learn(image, self.color, self._learned, self._turn())
        return found

    def _prior(self, expected: Floats | None) -> Prior:
        """Say what is known beforehand of a sighting."""
        return Prior.HERE if expected is not None else Prior.PRESENT if self._wish is not None else Prior.NONE

    def _choose(self, image: Image, expected: Floats | None) -> Floats | None:
        """State of the sighting to go on with, or None."""
        if self._finder is None:
            self._finder = Finder(
                self._matcher, self._judge, Searcher(image.shape[1], image.shape[0], self.parameters.search)
            )
        missed, best, most = self._missed() if expected is not None else 1.0, None, 0.0
        for state, merit in self._finder.sightings(image, self.color, self._prior(expected)):
            if expected is not None and not self._can_be(state, expected, missed):
                continue
            if expected is None and self._wish is not None:
                far = math.hypot(state[0] - self._wish[0], state[1] - self._wish[1])
                merit += 2.0 * (far < self._family.half_width(state))
            if merit > most:
                best, most = state, merit
        return best
