"""Balls of several kinds in one composed crowd: `Table`, and its `Kind`s."""

from typing import NamedTuple

import numpy as np

from benchmarks.crowds.composed.coding import CODINGS
from benchmarks.crowds.composed.footage import (
    BALLS,
    REPORTED_BACKGROUNDS,
    TUNED_BACKGROUNDS,
    cutouts,
)
from benchmarks.crowds.composed.motion import bouncing, rolling, swinging
from benchmarks.crowds.composed.picture import Look
from benchmarks.crowds.composed.scenes import FIRST_REPORTED, RATES, Composed
from benchmarks.crowds.crowd import Seen

MOTIONS = (rolling, bouncing, swinging)
LEAST, MOST = 15.0, 24.0  # px, of the radius of large balls


class Kind(NamedTuple):
    """Balls of one color and size.

    Parameters
    ----------
    label : str
        Of the color.
    ball : str
        Which real ball is shown.
    channels : tuple of int
        In which order its blue, green and red are taken: other colors than it has.
    size : float
        Radius, of that of the large balls.
    balls : int
    """

    label: str
    ball: str
    channels: tuple[int, int, int]
    size: float
    balls: int


TUNED = (
    Kind("brown", "marbled", (0, 2, 1), 1.0, 3),
    Kind("brown", "marbled", (0, 2, 1), 0.5, 3),
    Kind("yellow", "yellow", (0, 1, 2), 0.7, 3),
    Kind("blue", "dull", (1, 0, 2), 1.0, 3),
)
REPORTED = (
    Kind("lime", "tennis", (0, 1, 2), 1.0, 3),
    Kind("lime", "tennis", (0, 1, 2), 0.5, 3),
    Kind("red", "bagged", (0, 1, 2), 0.7, 3),
    Kind("violet", "tennis", (1, 0, 2), 1.0, 3),
)


class Table(Composed):
    """A composed crowd of several kinds; all of its balls are in the truth.

    Parameters
    ----------
    seconds : float
    seed : int
        Decides all else; from `FIRST_REPORTED` on with balls and backgrounds that no other seed shows.
    """

    def __init__(self, seconds: float, seed: int) -> None:
        self.seed = seed
        random = np.random.default_rng((seed, 3))
        reported = seed >= FIRST_REPORTED
        self.kinds = [kind for kind in (REPORTED if reported else TUNED) for _ in range(kind.balls)]
        self.balls, self.another_size = len(self.kinds), False
        listed = REPORTED_BACKGROUNDS if reported else TUNED_BACKGROUNDS
        colors = {BALLS[kind.ball].color for kind in self.kinds}
        backgrounds = [each for each in listed if not colors & set(each.without)]
        self.background = backgrounds[int(random.integers(len(backgrounds)))]
        self.fps = RATES[int(random.integers(len(RATES)))]
        self.frames = round(seconds * self.fps)
        radius = float(random.uniform(LEAST, MOST))
        self.shown = [kind.ball for kind in self.kinds]
        self.course = MOTIONS[seed % len(MOTIONS)]([kind.size * radius for kind in self.kinds], seconds, random)
        self._gains = {name: BALLS[name].gain * float(random.uniform(0.85, 1.15)) for name in sorted(set(self.shown))}
        self.shutter = float(random.uniform(0.1, 0.6))
        self.softness, self.shade = float(random.uniform(0.45, 0.9)), float(random.uniform(0.25, 0.6))
        self.coding, self.quality = CODINGS[int(random.integers(len(CODINGS)))], float(random.random())
        self._turns = random.uniform(0.0, 2.0, len(self.kinds))
        self._cut = [random.choice(len(BALLS[name].frames), 2, replace=False) for name in self.shown]

    def look(self, number: int) -> Look:
        """Say what a ball looks like."""
        one, other = self._cut[number]
        kind = self.kinds[number]
        cut = [np.ascontiguousarray(each[:, :, kind.channels]) for each in cutouts(kind.ball)]
        return Look((cut[one], cut[other]), self._gains[kind.ball])

    def seen_of(self, seen: list[Seen], label: str, size: float) -> list[Seen]:
        """Balls of a color; those of another size count neither for nor against."""
        of_color = [each for each in seen if self.kinds[each.identity].label == label]
        return [each if self.kinds[each.identity].size == size else each._replace(visible=0.0) for each in of_color]
