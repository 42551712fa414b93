"""Two balls of one color that cross: none of them takes the other one's name (`Crossing`)."""

import itertools
import math
from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

import msgspec

from matchset.live.wire.state import TargetState


class CrossingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """When two targets are one ball.

    Parameters
    ----------
    apart : float
        Distance of the middles of two circles that are one, radii. More: also where one tracker is not settled yet, and
        balls that are nearly hidden are lost earlier. Chosen by hand: two fits of one outline differ by less than a
        pixel.
    alike : float
        Ratio of their radii at most. More: the same. Chosen by hand.
    past : float
        From how long before they met their motion is taken, s. More: less noise, and a curved way is taken for a
        straight one. Chosen by hand.
    """

    apart: float = 0.25
    alike: float = 1.15
    past: float = 0.3


CROSSING = CrossingParameters()
Ball = tuple[float, float, float]


class _Seen(NamedTuple):
    time: float
    x: float
    y: float


class Meeting(NamedTuple):
    """What became of targets that met.

    Attributes
    ----------
    hidden : dict of int to int
        Targets that are hidden, each with the number of the one on whose ball it was found.
    exchanged : list of (int, int)
        Targets that came out as each other.
    """

    hidden: dict[int, int]
    exchanged: list[tuple[int, int]]


def are_one(a: Ball, b: Ball, parameters: CrossingParameters = CROSSING) -> bool:
    """Whether two circles, x, y and radius in px, are one ball."""
    near, far = sorted((a[2], b[2]))
    return math.dist(a[:2], b[:2]) < parameters.apart * near and far < parameters.alike * near


class Crossing:
    """Tells which of two targets that are found on one ball is that ball, by how both moved before they met.

    Parameters
    ----------
    parameters : CrossingParameters, optional
    """

    def __init__(self, parameters: CrossingParameters | None = None) -> None:
        self._parameters = parameters or CrossingParameters()
        self._past: dict[int, deque[_Seen]] = {}
        self._twins: set[tuple[int, int]] = set()

    def meet(self, states: Mapping[int, TargetState], time: float) -> Meeting:
        """Return which targets are hidden, and which were exchanged; only those that were found on one ball can be.

        Parameters
        ----------
        states : mapping of int to TargetState
            What was found, by the numbers of the targets.
        time : float
            Of the picture, s.
        """
        self._past = {number: past for number, past in self._past.items() if number in states}
        balls = {number: state for number, state in states.items() if state.found and "radius" in state.values}
        met, meeting = set[int](), Meeting({}, [])
        for pair in itertools.combinations(balls, 2):
            one, other = pair
            a, b = balls[one], balls[other]
            apart = math.dist(_circle(a)[:2], _circle(b)[:2]) > _circle(a)[2] + _circle(b)[2]
            if are_one(_circle(a), _circle(b), self._parameters):
                self._twins.add(pair)
                lost, stays = sorted(pair, key=lambda number: -self._error(number, balls[number], time))
                meeting.hidden[lost] = stays
            elif pair in self._twins:
                direct = self._error(one, a, time) + self._error(other, b, time)
                if self._error(one, b, time) + self._error(other, a, time) < direct:
                    meeting.exchanged.append(pair)
            if apart:
                self._twins.discard(pair)
            else:
                met |= {one, other}
        for number in balls.keys() - met - {each for pair in meeting.exchanged for each in pair}:
            self._note(number, balls[number], time)
        return meeting

    def expected(self, number: int, time: float) -> tuple[float, float] | None:
        """Return where a target should be by its motion before it met another one, px; None if that is not known."""
        past = self._past.get(number)
        if not past or past[-1].time <= past[0].time:
            return None
        first, last = past[0], past[-1]
        share = (time - last.time) / (last.time - first.time)
        return last.x + share * (last.x - first.x), last.y + share * (last.y - first.y)

    def since(self, number: int, time: float) -> float:
        """Return how long ago a target was seen apart from others, s."""
        past = self._past.get(number)
        return time - past[-1].time if past else 0.0

    def _note(self, number: int, state: TargetState, time: float) -> None:
        past = self._past.setdefault(number, deque())
        if past and not past[-1].time < time <= past[-1].time + self._parameters.past:
            past.clear()
        past.append(_Seen(time, *_circle(state)[:2]))
        while past[0].time < time - self._parameters.past:
            past.popleft()

    def _error(self, number: int, state: TargetState, time: float) -> float:
        expected, (x, y, _) = self.expected(number, time), _circle(state)
        return math.inf if expected is None else math.hypot(x - expected[0], y - expected[1])


def _circle(state: TargetState) -> tuple[float, float, float]:
    return state.values["x"][0], state.values["y"][0], state.values["radius"][0]
