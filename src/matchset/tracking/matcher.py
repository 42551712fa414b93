"""Fits shapes of one family to pictures: `Matcher`, the working memory of a tracker and its compiled steps."""

import math
from typing import Generic, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.numeric.jit import compile_user_function, plain
from matchset.shapes.family_check import check_family
from matchset.shapes.shape import Shape, corners, nearest, places, slopes, steady
from matchset.tracking import memory, motion
from matchset.tracking.look import Look
from matchset.tracking.match_set import MatchParameters
from matchset.tracking.memory import START, STEADY
from matchset.tracking.parameters import TRUST, TrackerParameters
from matchset.tracking.step import FOLLOW, FREE, HELD, LEARN, NEVER, TAKE_IN, TELL, make_step
from matchset.tracking.track import Track
from matchset.tracking.verdict import DOUBT, MOST_CORNERS, MOST_HOLLOW, SIDE_DOUBT, SURE, is_doubtful

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Image = npt.NDArray[np.uint8]
S = TypeVar("S", bound=Shape)

INNER = 0.88  # how far out the inside is looked at, in half-widths: beyond it blur mixes with the background
FIRST_GRAIN = 2.0  # noise that is assumed before the first look, gray levels
NOTHING = np.zeros((1, 1, 3), np.uint8)
NO_COLOR = np.zeros(256, np.int8), np.zeros(256, np.float32), np.zeros(256, np.float32)
NO_ANSWER = np.zeros((0, 2)), np.zeros((0, 0))
LEAST_FREE, MOST_FREE = 5, 8  # numbers of a state with which a side can move alone, and nothing else is free
PLAIN_DOUBT = 0.85  # agreement below which a fit is looked at again where no color tells the target
GOLDEN = 0.6180339887  # spreads the places inside evenly


# places of the parameters in `Views.match`
_PLACES = {name: place for place, name in enumerate(MatchParameters.__struct_fields__)}
SIDE_START = _PLACES["side_start"]
assert _PLACES["start"] == START


class Matcher(Generic[S]):
    """Fits shapes of one family to pictures; the working memory of a tracker.

    Parameters
    ----------
    family : type
        The family of shapes, `Circle` for one.
    points : int
        Number of lines across the outline: the size of the match-set.
    parameters : TrackerParameters, optional

    Attributes
    ----------
    state : ndarray of shape (s,), float64
        The state that the last fit reached; overwritten by the next one.
    last : Shape or None
        The last answer.
    has_corners : bool
        Whether the family's shapes have corners.
    knows_color : bool
        Whether a color tells the target from what is around it.
    sides_move : bool
        Whether one of its sides can move without the others, as that of a rectangle can and that of a template cannot.
    """

    def __init__(
        self,
        family: type[S],
        points: int,
        parameters: TrackerParameters | None = None,
    ) -> None:
        check_family(family)
        self.family, self.points = family, points
        shape = family.from_coarse(0.0, 0.0, 1.0)
        where = places(family, points)
        held = memory.Memory(points, len(shape.state), len(family.parameters), where.shape[1])
        self.parts, self._block = parts, _ = held.parts, held.block
        self._step = make_step(compile_user_function(family.trace), compile_user_function(family.half_width))
        parts.rays[:] = np.column_stack((where, INNER * np.sqrt((np.arange(points) * GOLDEN) % 1.0)))
        self.state = parts.state
        self.parameters = chosen = parameters or TrackerParameters()
        for place, each in ((parts.match, chosen.match), (parts.judge, chosen.validation), (parts.track, chosen)):
            numbers = [value for value in msgspec.structs.astuple(each) if not isinstance(value, msgspec.Struct)]
            place[: len(numbers)] = numbers
        self.has_corners = corners(shape) is not None
        if self.has_corners:
            parts.judge[MOST_CORNERS] = math.inf  # corners speak against round shapes only
            parts.judge[MOST_HOLLOW] = math.inf  # and a printed mark has another color inside
            parts.match[START] = parts.match[SIDE_START]
        self.sides_move = self.has_corners and LEAST_FREE <= len(shape.state) <= MOST_FREE
        if not self.sides_move:
            parts.judge[SIDE_DOUBT] = -math.inf
        parts.track[STEADY] = steady(family)
        self.knows_color = True
        self._translates = slopes(shape) is not None
        self.last: S | None = None
        self._points_shape, self._wide_shape = (points, 2), (len(family.parameters),) * 2
        self.forget()

    def settle(self, image: Image, color: ColorModel, start: Floats, look: Look) -> bool:
        """Fit the shape near a state.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        start : ndarray of shape (s,), float64
            Where to begin.
        look : Look

        Returns
        -------
        bool
            Whether there are edge points to fit at all; whether they are enough is for the caller to judge.
        """
        self.state[:] = start
        reach, speed, sigma, free, least, blind = look
        self.parts.look[:] = reach, speed, sigma or max(reach / 3.0, 1.0), least, blind
        colors = color.table, color.log_odds, color.log_odds
        verdict, _, _ = self._step(image, *colors, *NO_ANSWER, self._block, FREE if free else HELD, 0.0, 1.0, NEVER)
        return verdict == SURE

    def advance(
        self, image: Image, color: ColorModel, first: Singles, time: float, passed: float, turn: int = NEVER
    ) -> Track[S] | int:
        """Follow the shape into a frame, and learn the color from it.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        first : ndarray of shape (32768,) or (256,), float32
            Its log-odds as they were at first.
        time, passed : float
            Of the frame, s, and since the frame before.
        turn : int
            Which quarter of the outline's surroundings teaches the color, if it is whole and well confirmed; `NEVER`.

        Returns
        -------
        Track or int
            Where all is well the answer, taken in; otherwise the `verdict` on this first look.
        """
        points, wide = np.empty(self._points_shape), np.empty(self._wide_shape)
        verdict, support, count = self._step(
            image, color.table, color.log_odds, first, points, wide, self._block, FOLLOW, time, passed, turn
        )
        if verdict:
            return verdict
        return self._answer(support, points, count, wide, time)

    def predict(self, time: float, missed: float) -> Floats:
        """Extrapolate the motion to a time, s, `missed` frames after the last sighting; the state, (s,), expected."""
        plain(motion.predict)(self.parts, time, missed, self.parts.track[TRUST])  # seldom: not worth compiling
        return self.parts.expected

    def begin(self, state: Floats, time: float, spread: float) -> None:
        """Begin to follow at a state, see `motion.begin`."""
        motion.begin(self.parts, state, time, spread)

    def take_in(self, time: float) -> Track[S]:
        """Correct the motion with what was fitted in the frame of a time, s, and answer with it."""
        return self._tell(TAKE_IN, time)

    def track(self, time: float) -> Track[S]:
        """Answer with what was fitted in the frame of a time, s."""
        return self._tell(TELL, time)

    def _tell(self, way: int, time: float) -> Track[S]:
        """Answer with what was fitted, taken in or not."""
        points, wide = np.empty(self._points_shape), np.empty(self._wide_shape)
        _, support, count = self._step(NOTHING, *NO_COLOR, points, wide, self._block, way, time, 1.0, NEVER)
        return self._answer(support, points, count, wide, time)

    def _answer(self, support: float, points: Floats, count: int, wide: Floats, time: float) -> Track[S]:
        """Describe the state by the family's parameters, as the last one was described."""
        self.last = shape = self.family.from_state(self.state, self.last)
        if self._translates and (by := slopes(shape)) is not None:
            wide = by @ wide @ by.T
        return Track(shape, wide, support, points if count == self.points else points[:count], time)

    def learn(self, image: Image, color: ColorModel, first: Singles, turn: int) -> None:
        """Learn the color from what was fitted, see `advance`."""
        if turn != NEVER:
            self._step(image, color.table, color.log_odds, first, *NO_ANSWER, self._block, LEARN, 0.0, 1.0, turn)

    def describe_like(self, shape: S) -> None:
        """Describe the next answer as this shape is: a square has four angles."""
        self.last = shape

    def shape_of(self, state: Floats) -> S | None:
        """Shape of an extrapolated state, None where it has shrunk to nothing."""
        try:
            return self.family.from_state(state, self.last)
        except ValueError:
            return None

    def alike(self, state: Floats) -> Floats:
        """Of the states with the same outline the one nearest to the last one that was seen."""
        return nearest(self.family, state, self.parts.seen)

    def forget(self) -> None:
        """Begin anew: nothing is left of earlier pictures."""
        fit = self.parts.fit
        fit[:] = 0.0
        self.last = None
        fit[memory.GRAIN] = FIRST_GRAIN

    def ignore_color(self) -> None:
        """Judge by edges alone: no color tells the target from what is around it."""
        self.knows_color = False
        self.parts.judge[SIDE_DOUBT], self.parts.judge[DOUBT] = -math.inf, PLAIN_DOUBT

    def trust_modes(self) -> None:
        """Let the next fit go where the edge points ask it to: the noise of a fit that failed holds modes to zero."""
        self.parts.fit[memory.NOISE] = 0.0

    def fit(self, place: int) -> float:
        """Look up what is known of the last fit: the number at a place of `Views.fit`."""
        return self.parts.fit.item(place)

    def clock(self, place: int) -> float:
        """Look up what is known of the motion: the number at a place of `Views.clock`."""
        return self.parts.clock.item(place)

    @property
    def is_doubtful(self) -> bool:
        """Whether the last fit should be looked at again."""
        return is_doubtful(self.parts.fit, self.parts.judge, self.points)

    @property
    def size(self) -> float:
        """Half-width of the last fit, px."""
        return self.parts.fit.item(memory.SIZE)
