"""Jugglers with up to five balls each: `juggling`; their hands hide the balls that they hold."""

import bisect
import itertools
import math
from functools import partial
from typing import NamedTuple

import numpy as np

from benchmarks.crowds.crowd import FPS, Crowd, Limb, LimbFunction, Point
from matchset.sim.clips.multi_ball_clip import PositionFunction

GRAVITY = 9.81  # m/s^2
EACH = 5  # balls of a juggler
BALL = 0.08  # m, radius
FLIGHT = 0.85  # s, of a throw; 0.9 m high
HELD = 0.32  # s, for which a hand holds a ball
LEG = FLIGHT + HELD  # s, from throw to throw of a ball
INSIDE, OUTSIDE = 0.16, 0.38  # m, beside the juggler's middle: where balls are thrown, and where they are caught
LOW = 0.52  # m, below the camera's axis: the hands
LANE = 0.14  # m, by which throws of one hand are nearer, and those of the other farther: they do not collide
DIP = 0.09  # m, by which a hand goes down while it holds a ball


class Throw(NamedTuple):
    """A ball from hand to hand: times, s, and places, m."""

    begin: float
    thrown: Point
    end: float
    caught: Point
    lane: float

    def at(self, time: float) -> Point:
        """Where the ball is while it flies."""
        since, whole = time - self.begin, self.end - self.begin
        share = since / whole
        x, y, z = (a + share * (b - a) for a, b in zip(self.thrown, self.caught, strict=True))
        return x, y - GRAVITY * since * (whole - since) / 2.0, z + self.lane * math.sin(math.pi * share)


class Hold(NamedTuple):
    """A ball in a hand: times, s, and places, m."""

    begin: float
    caught: Point
    end: float
    thrown: Point

    def at(self, time: float) -> Point:
        """Where the ball is while it is held."""
        return _swung(self.caught, self.thrown, (time - self.begin) / (self.end - self.begin), DIP)


class Juggler:
    """One person's balls and hands.

    Parameters
    ----------
    balls : int
        1 ... `EACH`.
    middle : tuple of (float, float)
        To the right of the camera's axis, and depth, m.
    seconds : float
        For which it juggles.
    random : Generator
        Decides when it begins, and how exact the throws are.
    """

    def __init__(self, balls: int, middle: tuple[float, float], seconds: float, random: np.random.Generator) -> None:
        self._middle = middle
        legs = math.ceil(seconds / LEG) + 4
        start = -2.0 * LEG * (1.0 + random.random())
        self._throws = [
            self._ball(start + 2.0 * LEG * number / balls + 0.01 * random.standard_normal(), legs, random)
            for number in range(balls)
        ]
        self._holds: list[list[Hold]] = [[], []]
        for throws in self._throws:
            for leg, (one, other) in enumerate(itertools.pairwise(throws)):
                self._holds[(leg + 1) % 2].append(Hold(one.end, one.caught, other.begin, other.thrown))
        for holds in self._holds:
            holds.sort()

    def _ball(self, start: float, legs: int, random: np.random.Generator) -> list[Throw]:
        x, z = self._middle
        throws = []
        for leg in range(legs):
            side = -1.0 if leg % 2 else 1.0
            late, off = np.clip(random.standard_normal(2), -2.0, 2.0).tolist()
            begin = start + leg * LEG
            thrown = (x + side * (INSIDE + 0.015 * random.standard_normal()), LOW, z)
            caught = (x - side * (OUTSIDE + 0.03 * off), LOW, z)
            throws.append(Throw(begin, thrown, begin + FLIGHT + 0.03 * late, caught, side * LANE))
        return throws

    def paths(self) -> list[PositionFunction]:
        """Where each ball is at a time."""
        return [partial(self._place, number) for number in range(len(self._throws))]

    def _place(self, number: int, time: float) -> Point:
        throws = self._throws[number]
        leg = max(bisect.bisect_right(throws, time, key=lambda throw: throw.begin) - 1, 0)
        throw = throws[leg]
        if time < throw.end:
            return throw.at(time)
        return Hold(throw.end, throw.caught, throws[leg + 1].begin, throws[leg + 1].thrown).at(time)

    def hands(self) -> list[LimbFunction]:
        """Return the limbs of both hands at a time."""
        return [partial(self._limbs, side) for side in range(2)]

    def _limbs(self, side: int, time: float) -> list[Limb]:
        """Forearm, palm and fingers, between the camera and the ball that is held."""
        before = 1.0 - 1.5 * BALL / self._middle[1]  # toward the camera, on the ray to the ball
        x, y, z = (before * each for each in self._palm(side, time))
        out = 1.0 if side == 0 else -1.0
        wrist = (x + 0.02 * out, y + 0.09, z)
        limbs = [
            Limb((x, y - 0.012, z), 0.058, (x, y + 0.045, z), 0.048),
            Limb(wrist, 0.03, (x + 0.3 * out, y + 1.5, z + 0.1), 0.08),
        ]
        for finger in range(4):
            along = -0.045 + 0.03 * finger
            limbs.append(Limb((x + along, y - 0.02, z), 0.018, (x + 1.15 * along, y - 0.072, z), 0.015))
        return limbs

    def _palm(self, side: int, time: float) -> Point:
        """Where a hand is: at the ball that it holds, or on its way to the next one."""
        holds = self._holds[side]
        after = bisect.bisect_right(holds, time, key=lambda hold: hold.begin)
        if after == 0:
            return holds[0].caught
        last = holds[after - 1]
        if time < last.end or after == len(holds):
            return last.at(min(time, last.end))
        following = holds[after]
        return _swung(last.thrown, following.caught, (time - last.end) / (following.begin - last.end), 0.02)


def juggling(balls: int, seconds: float, seed: int, preset: str = "typical") -> Crowd:
    """Balls that jugglers throw from hand to hand, up to five each, beside each other."""
    random = np.random.default_rng(seed)
    persons = math.ceil(balls / EACH)
    depth = 1.9 if persons < 3 else 0.75 * persons
    jugglers = []
    for person in range(persons):
        own = balls // persons + (person < balls % persons)
        x = (person - (persons - 1) / 2.0) * (1.2 if persons < 3 else 1.06) + 0.03 * random.standard_normal()
        jugglers.append(Juggler(own, (x, depth + 0.05 * random.standard_normal()), seconds, random))
    paths = [path for each in jugglers for path in each.paths()]
    hands = [hand for each in jugglers for hand in each.hands()]
    return Crowd(paths, round(seconds * FPS), seed, preset, hands=hands, radius=BALL)


def _swung(begin: Point, end: Point, share: float, dip: float) -> Point:
    """Go from one place to another, down an arc that begins and ends slowly."""
    eased = share * share * (3.0 - 2.0 * share)
    x, y, z = (a + eased * (b - a) for a, b in zip(begin, end, strict=True))
    return x, y + dip * math.sin(math.pi * share), z
