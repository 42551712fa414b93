"""Composed crowds with their truth: `Composed`, and `composed_bounce`, `composed_billiards`, `composed_swing`."""

import zlib
from collections.abc import Callable, Iterator

import numpy as np

import matchset as ms
from benchmarks.crowds.composed.coding import CODINGS, coded
from benchmarks.crowds.composed.footage import (
    BALLS,
    REPORTED,
    REPORTED_BACKGROUNDS,
    TUNED,
    TUNED_BACKGROUNDS,
    Bytes,
    backdrop,
    cutouts,
)
from benchmarks.crowds.composed.motion import STEPS, Course, bouncing, rolling, swinging
from benchmarks.crowds.composed.picture import Laid, Look, Painter, shares
from benchmarks.crowds.crowd import Seen

FIRST_REPORTED = 650  # seeds from it on have balls and backgrounds of their own
RATES = (25.0, 30.0)  # frames a second
LEAST, MOST = 8.5, 27.0  # px, of the radius of most balls
LIKE = {"green": ("green", "cyan"), "cyan": ("green", "cyan")}
"""Colors too like one for a ball of them to be a stranger."""
Motion = Callable[[list[float], float, np.random.Generator], Course]


class Composed:
    """A composed crowd: frames, and what is in each.

    Balls of another color are no part of the truth: to answer them is false. One ball of another size, which some
    crowds have, is in the truth with nothing visible: it counts neither for nor against.

    Parameters
    ----------
    motion : callable
        From radii, seconds and a random generator to a course.
    balls : int
        How many equal ones.
    seconds : float
    seed : int
        Decides all else; from `FIRST_REPORTED` on with balls and backgrounds that no other seed shows.

    Raises
    ------
    FileNotFoundError
        If the real clips are not here.
    """

    def __init__(self, motion: Motion, balls: int, seconds: float, seed: int) -> None:
        self.balls, self.seed = balls, seed
        random = np.random.default_rng((seed, zlib.crc32(motion.__name__.encode())))
        reported = seed >= FIRST_REPORTED
        names = REPORTED if reported else TUNED
        self.ball = names[seed % len(names)]
        color = BALLS[self.ball].color
        listed = REPORTED_BACKGROUNDS if reported else TUNED_BACKGROUNDS
        backgrounds = [each for each in listed if color not in each.without]
        self.background = backgrounds[int(random.integers(len(backgrounds)))]
        self.fps = RATES[int(random.integers(len(RATES)))]
        self.frames = round(seconds * self.fps)
        most = min(BALLS[self.ball].most, MOST * min(1.0, (8.0 / balls) ** 0.5))
        radius = float(np.exp(random.uniform(np.log(min(LEAST, 0.8 * most)), np.log(most))))
        others = [name for name in names if BALLS[name].color not in LIKE.get(color, (color,))]
        strangers = [others[int(random.integers(len(others)))] for _ in range(1 + seed % 2)]
        self.another_size = seed % 3 == 0
        self.shown = [self.ball] * (balls + self.another_size) + strangers
        size = radius * (1.6 if radius < 16.0 else 0.6)
        radii = [radius] * balls + [size] * self.another_size
        radii += [min(BALLS[name].most, radius * random.uniform(0.8, 1.25)) for name in strangers]
        self.course = motion(radii, seconds, random)
        self._gains = {name: BALLS[name].gain * float(random.uniform(0.85, 1.15)) for name in sorted(set(self.shown))}
        self.shutter = float(random.uniform(0.1, 0.6))  # share of a frame
        self.softness, self.shade = float(random.uniform(0.45, 0.9)), float(random.uniform(0.25, 0.6))
        self.coding, self.quality = CODINGS[int(random.integers(len(CODINGS)))], float(random.random())
        self._turns = random.uniform(0.0, 2.0, len(radii))
        self._cut = [random.choice(len(BALLS[name].frames), 2, replace=False) for name in self.shown]

    def __iter__(self) -> Iterator[tuple[ms.Frame, list[Seen]]]:
        pictures = coded(self._pictures(), self.coding, self.quality)
        for index, picture in enumerate(pictures):
            yield ms.Frame(picture, index / self.fps, index), self.truth(index / self.fps)

    def truth(self, time: float) -> list[Seen]:
        """Say what is there at a time, s, in the order of the identities."""
        order, places = self._there(time)
        circles = [(float(places[at, 0]), float(places[at, 1]), float(places[at, 2])) for at in order]
        seen = []
        for at, circle, share in zip(order, circles, shares(circles), strict=True):
            if at < self.balls + self.another_size and share > 0.0:
                seen.append(Seen(at, ms.Circle(*circle), share if at < self.balls else 0.0))
        return sorted(seen)

    def look(self, number: int) -> Look:
        """Say what a ball looks like."""
        one, other = self._cut[number]
        cut = cutouts(self.shown[number])
        return Look((cut[one], cut[other]), self._gains[self.shown[number]])

    def _there(self, time: float) -> tuple[list[int], np.ndarray]:
        """Order of the balls, the farthest first, and where they are."""
        places, depths = self._at(self.course.places, time), self._at(self.course.depths, time)
        return [int(at) for at in np.argsort(depths, kind="stable")], places

    @staticmethod
    def _at(steps: np.ndarray, time: float) -> np.ndarray:
        """Between two steps; half a second of the course is before the first frame."""
        step = (time + 0.5) * STEPS
        before = min(int(step), len(steps) - 2)
        part = step - before
        return np.asarray((1.0 - part) * steps[before] + part * steps[before + 1])

    def _pictures(self) -> Iterator[Bytes]:
        painter = Painter(backdrop(self.background), self.softness, self.shade, self.course.floor)
        looks = [self.look(number) for number in range(len(self.shown))]
        for index in range(self.frames):
            time, half = index / self.fps, self.shutter / self.fps / 2.0
            order, places = self._there(time)
            begin, end = (self._at(self.course.places, time + late)[:, :2] for late in (-half, half))
            balls = []
            for at in order:
                x, y, radius, turn = places[at].tolist()
                ends = [_near(each[at].tolist(), (x, y)) for each in (begin, end)]
                balls.append(Laid(looks[at], ends[0], (x, y), ends[1], radius, turn + float(self._turns[at])))
            yield painter.paint(index, balls, np.random.default_rng((self.seed, index)))


def _near(end: list[float], middle: tuple[float, float]) -> tuple[float, float]:
    """Return an end of a streak; the middle if the ball was elsewhere, away, meanwhile."""
    return (end[0], end[1]) if np.hypot(end[0] - middle[0], end[1] - middle[1]) < 100.0 else middle


def composed_bounce(balls: int, seconds: float, seed: int) -> Composed:
    """Balls that are thrown in by turns, bounce on a floor and off each other, leave, and come back."""
    return Composed(bouncing, balls, seconds, seed)


def composed_billiards(balls: int, seconds: float, seed: int) -> Composed:
    """Balls on a table seen from above, with friction and collisions."""
    return Composed(rolling, balls, seconds, seed)


def composed_swing(balls: int, seconds: float, seed: int) -> Composed:
    """Balls on ellipses and pendulums that pass before each other."""
    return Composed(swinging, balls, seconds, seed)


COMPOSED: dict[str, Callable[[int, float, int], Composed]] = {
    "composed_bounce": composed_bounce,
    "composed_billiards": composed_billiards,
    "composed_swing": composed_swing,
}
