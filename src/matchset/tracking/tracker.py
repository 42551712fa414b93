"""Follow a shape from frame to frame: `Tracker` (Epstein & Feldman, Alg. 1 and 3)."""

import math
from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.image.adapt import adapt_table
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.shape import Shape
from matchset.tracking.detect import Finder, Searcher, channels_last
from matchset.tracking.doubt import BETTER, alternatives, doubtful, worth
from matchset.tracking.judge import Judge
from matchset.tracking.matcher import Matcher
from matchset.tracking.motion import Motion
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.place import Place
from matchset.tracking.track import Lost, Track

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

TEACH = 3  # every so many frames the color may learn: light changes slowly


class Tracker(Generic[S]):
    """Follows one shape; a tracker belongs to one thread, any number of them may run side by side.

    Parameters
    ----------
    family : type
        The family of shapes: `Circle`.
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
        self._family = family
        self._matcher: Matcher[S] = Matcher(family, points)
        self._judge = Judge()
        self._wish = start
        self._motion: Motion | None = None
        self._finder: Finder[S] | None = None
        self._kind: tuple[int, ...] | None = None
        self._time, self._interval = -math.inf, 1.0 / 30.0
        self._frames = 0
        self._usual = 0.0  # half-width over the last well-confirmed frames, px
        self._compile()

    def _compile(self) -> None:
        """Run every kernel once on a small picture of a disc, so that no frame waits for the compiler."""
        color = ColorModel(np.linspace(-4.0, 4.0, self.color.table.size, dtype=np.float32))
        image = np.zeros((64, 64, color.channels), np.uint8)
        cells = np.arange(64) - 31.5
        image[np.hypot(cells[:, None], cells[None, :]) < 20.0] = 255
        matcher: Matcher[S] = Matcher(self._family, 16)
        state = self._family.from_coarse(31.5, 31.5, 20.0).state
        matcher.settle(image, color, state, 6.0)
        self._judge.track(matcher, 0.0)
        motion = Motion(state, 0.0, 1.0, matcher.count)
        motion.correct(state, 1.0)
        matcher.settle(image, color, motion.predict(2.0, 1.0, 1.0), 6.0, 1.0, 1.0, motion.room)
        Searcher(64, 64).candidates(image, color)
        self._adapt(image, matcher, color, 0.0)

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
        spread = 3.0 + 0.1 * self._family.half_width(shape.state)
        self._motion = Motion(shape.state, self._time, spread, self._matcher.count)

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
        if self._motion is None:
            return self._search(image, "nothing of this color and shape is in the picture")
        reason = self._follow(image, self._motion)
        return self._search(image, reason) if reason else self._confirm(image, self._motion)

    def _admit(self, frame: Frame) -> Image:
        """Check a frame against those before it; its picture as (h, w, channels)."""
        if frame.image.shape != self._kind:
            if self._kind is not None:
                raise ValueError(
                    f"frame {frame.index} has shape {frame.image.shape}, the frames before it had {self._kind}"
                )
            self.color.check(frame.image)
            self._kind = frame.image.shape
        if not frame.time > self._time:
            raise ValueError(
                f"time must run forward: frame {frame.index} is at {frame.time} s, the one before at {self._time} s"
            )
        if math.isfinite(self._time):
            self._interval = min(frame.time - self._time, 1.0)
        if self._motion is not None and not math.isfinite(self._motion.time):
            self._motion.time = frame.time - self._interval
        self._time = frame.time
        self._frames += 1
        return channels_last(frame.image)

    def _missed(self, motion: Motion) -> float:
        """How many frames have passed since the last sighting, at least 1."""
        return max((self._time - motion.time) / self._interval, 1.0)

    def _follow(self, image: Image, motion: Motion) -> str:
        """Fit near the prediction; why it failed, empty if it did not."""
        limits, matcher = self.parameters, self._matcher
        missed = self._missed(motion)
        expected = motion.predict(self._time, missed, limits.trust)
        speed, surprise = self._interval * motion.speed, motion.surprise * missed
        reach = min(limits.least_reach + 2.0 * surprise, limits.most_reach)
        reason = self._try(image, expected, reach, speed, max(surprise, 1.0), motion.room)
        if reason and reach < limits.most_reach:
            reason = self._try(image, expected, limits.most_reach, speed)
        if doubtful(matcher):
            reason = self._look_again(image, reason, speed)
        if not reason and not self._place(expected).near(self._place(matcher.state), motion.surprise):
            reason = self._judge.first_sight(matcher)
            if not reason and not self._place(expected).reachable(self._place(matcher.state), missed, limits):
                reason = "it would have jumped or changed its size faster than it can"
        return reason

    def _try(
        self,
        image: Image,
        state: Floats,
        reach: float,
        speed: float,
        sigma: float = 0.0,
        spread: Floats | None = None,
    ) -> str:
        """Fit near a state; why it is not confirmed, empty if it is."""
        matcher = self._matcher
        if not matcher.settle(image, self.color, state, reach, speed, sigma, spread):
            gone = matcher.seen < 0.3 * matcher.points
            return "it left the picture" if gone else "no edges of the target's color where it should be"
        return self._judge.following(matcher)

    def _look_again(self, image: Image, reason: str, speed: float) -> str:
        """Go on with the best of the shapes around a doubtful one; why it is not confirmed, empty if it is."""
        matcher = self._matcher
        best, most = matcher.state, -math.inf if reason else worth(matcher, self._usual) + BETTER
        for start in list(alternatives(matcher)):
            if not self._try(image, start, 5.0, speed, 2.0) and worth(matcher, self._usual) > most:
                best, most = matcher.state, worth(matcher, self._usual)
        return self._try(image, best, 3.0, speed, 1.0)

    def _place(self, state: Floats) -> Place:
        """Center and size of a state."""
        return Place(float(state[0]), float(state[1]), self._family.half_width(state))

    def _can_be(self, state: Floats, expected: Floats, missed: float) -> bool:
        """Whether a sighting can be the lost shape: near its prediction, or farther off with full evidence."""
        here, there = self._place(expected), self._place(state)
        if here.about(there):
            return True
        return not self._judge.first_sight(self._matcher) and here.reachable(there, missed, self.parameters)

    def _confirm(self, image: Image, motion: Motion) -> Track[S]:
        """Take in what the matcher holds, learn the color from it, and answer."""
        matcher, limits = self._matcher, self.parameters
        motion.correct(matcher.state, self._time)
        if matcher.agreement > 0.75:
            size = self._family.half_width(matcher.state)
            self._usual += 0.1 * (size - self._usual) if self._usual > 0.0 else size
        whole = matcher.seen == matcher.points
        good = whole and matcher.confirmed >= limits.adapt_support * matcher.seen
        due = self._frames % TEACH == 0 and limits.adapt_rate > 0.0
        if due and good and matcher.inside >= limits.adapt_inside:
            self._adapt(image, matcher, self.color, limits.adapt_rate)
        return self._judge.track(matcher, self._time)

    def _adapt(self, image: Image, matcher: Matcher[S], color: ColorModel, rate: float) -> None:
        """Teach the color a quarter of the outline's surroundings, another one in every frame."""
        x, y = float(matcher.state[0]), float(matcher.state[1])
        begin = self._frames // TEACH % 4
        adapt_table(
            image,
            color.log_odds,
            self._learned,
            color.table,
            matcher.lines.outline,
            matcher.rays[:, 2],
            x,
            y,
            begin,
            rate,
        )

    def _search(self, image: Image, reason: str) -> Track[S] | Lost[S]:
        """Look through the whole frame; while coasting only what can be the lost shape counts."""
        motion = self._motion
        if motion is not None and self._time - motion.time > self.parameters.coast:
            motion = self._motion = None
        expected = None if motion is None else motion.predict(self._time, 1.0, self.parameters.trust).copy()
        best = self._choose(image, expected)
        if best is not None:
            self._try(image, best, 4.0, 0.0)
            if motion is None:
                spread = 0.25 * self._family.half_width(best)
                self._motion = motion = Motion(self._matcher.state, self._time, spread, self._matcher.count)
            self._wish = None
            return self._confirm(image, motion)
        return Lost(reason, self._time, None if expected is None else self._shape(expected))

    def _shape(self, state: Floats) -> S | None:
        """Shape of an extrapolated state, None where it has shrunk to nothing."""
        try:
            return self._family.from_state(state)
        except ValueError:
            return None

    def _choose(self, image: Image, expected: Floats | None) -> Floats | None:
        """State of the sighting to go on with, or None."""
        if self._finder is None:
            self._finder = Finder(self._matcher, self._judge, Searcher(image.shape[1], image.shape[0]))
        missed = self._missed(self._motion) if self._motion is not None else 1.0
        best, most = None, 0.0
        for state, merit in self._finder.sightings(image, self.color, expected is not None):
            if expected is not None and not self._can_be(state, expected, missed):
                continue
            if expected is None and self._wish is not None:
                far = math.hypot(state[0] - self._wish[0], state[1] - self._wish[1])
                merit += 2.0 * (far < self._family.half_width(state))
            if merit > most:
                best, most = state, merit
        return best
