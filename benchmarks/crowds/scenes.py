"""Rendered crowds of equal balls: `juggling`, `billiards` and `swarm`, each a `Crowd` with its truth."""

import itertools
import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

import matchset as ms
from matchset.sim.clips.multi_ball_clip import MultiBallClip, PositionFunction
from matchset.sim.clips.truth import sphere_outline

Floats = npt.NDArray[np.float64]

CAMERA = ms.CameraModel.from_fov(640, 480, 1.25)
RADIUS = 0.14  # m, of every balloon
STEPS = 240  # a second, in which paths with collisions are computed
GRAVITY = 9.81  # m/s^2
DEPTH = 3.2  # m, of a swarm's middle


class Seen(NamedTuple):
    """A ball in a frame.

    Parameters
    ----------
    identity : int
        Its number in the scene.
    circle : Circle
        Its outline, px, also where others hide it.
    visible : float
        Share of its disc that is in the picture and not behind a nearer ball.
    """

    identity: int
    circle: ms.Circle
    visible: float


class Crowd:
    """A scene: frames, and what is in each.

    Parameters
    ----------
    paths : list of callables
        As of `MultiBallClip`.
    frames : int
    seed : int
        Decides room and noise.
    preset : str
        "clean", "typical" or "bad".
    """

    def __init__(self, paths: list[PositionFunction], frames: int, seed: int, preset: str = "typical") -> None:
        unmarked = [False] * len(paths)
        self._clip = MultiBallClip(
            camera=CAMERA, paths=paths, marked=unmarked, frames=frames, seed=seed, preset=preset
        )

    def __iter__(self) -> Iterator[tuple[ms.Frame, list[Seen]]]:
        for frame in self._clip:
            yield frame, self.truth(frame.time)

    def truth(self, time: float) -> list[Seen]:
        """What is there at a time, s, in the order of the identities."""
        places = [path(time) for path in self._clip.paths]
        there = [(number, np.array(place)) for number, place in enumerate(places) if place is not None]
        nearest_first = sorted(there, key=lambda each: float(each[1][2]))
        rows, columns = np.indices((CAMERA.height, CAMERA.width))
        free = np.ones(rows.shape, bool)
        found = []
        for number, place in nearest_first:
            circle = sphere_outline(CAMERA, place, RADIUS).circle()
            inside = np.hypot(columns - circle.x, rows - circle.y) < circle.radius
            area = math.pi * circle.radius**2
            found.append(Seen(number, circle, float((inside & free).sum()) / area))
            free &= ~inside
        return sorted(found)


def juggling(balls: int, seconds: float, seed: int, preset: str = "typical") -> Crowd:
    """Balls that two hands throw to each other; all pass near the same point above the hands."""
    random = np.random.default_rng(seed)
    period = min(0.42 * balls, 2.2)  # s, of a ball: from a hand back to that hand
    flight = period / 2 - 0.16
    speed, width = GRAVITY * flight / 2, 0.5 + 0.08 * random.random()
    phases = np.arange(balls) * period / balls + 0.01 * random.normal(size=balls)
    depths = 3.4 + 0.04 * random.normal(size=balls)
    low = 0.9

    def path(phase: float, depth: float) -> PositionFunction:
        def place(time: float) -> tuple[float, float, float]:
            turns, rest = divmod(time + phase, period / 2)
            begin = width if int(turns) % 2 else -width
            if rest < flight:
                return begin - 2.0 * begin * rest / flight, low - rest * (speed - GRAVITY * rest / 2), depth
            held = (rest - flight) / 0.16 * math.pi  # from where it is caught to where it is thrown
            return -begin - 0.1 * math.copysign(math.sin(held), begin), low + 0.08 * math.sin(held), depth

        return place

    paths = [path(float(phase), float(depth)) for phase, depth in zip(phases, depths, strict=True)]
    return Crowd(paths, round(seconds * 30), seed, preset)


def billiards(balls: int, seconds: float, seed: int, preset: str = "typical") -> Crowd:
    """Balls in a plane across the view that bounce off each other and off its edges, without friction."""
    random = np.random.default_rng(seed)
    depth = 2.2 + 0.09 * balls
    half = np.array((CAMERA.width / CAMERA.fx, CAMERA.height / CAMERA.fy)) * depth / 2 - RADIUS
    places = _apart(random, balls, half)
    speeds = random.normal(0.0, 0.9, (balls, 2))
    courses = np.empty((round(seconds * STEPS) + STEPS, balls, 2))
    for step in range(len(courses)):
        courses[step] = places
        places = places + speeds / STEPS
        outside = (np.abs(places) > half) & (places * speeds > 0.0)
        speeds[outside] *= -1.0
        for one, other in itertools.combinations(range(balls), 2):
            between = places[other] - places[one]
            far = float(np.linalg.norm(between))
            normal = between / far
            closing = float((speeds[one] - speeds[other]) @ normal)
            if far < 2.0 * RADIUS and closing > 0.0:  # equal masses exchange what is along the normal
                speeds[one] -= closing * normal
                speeds[other] += closing * normal
    return Crowd(_along(courses, np.full(balls, depth)), round(seconds * 30), seed, preset)


def swarm(balls: int, seconds: float, seed: int, preset: str = "typical") -> Crowd:
    """Balls that wander in three dimensions, cross before and behind each other, leave the view and come back."""
    random = np.random.default_rng(seed)
    rates, phases = random.uniform(0.08, 0.35, (balls, 3, 3)), random.uniform(0.0, 2 * math.pi, (balls, 3, 3))
    sizes = np.array((0.8, 0.4, 0.6)) * random.uniform(0.5, 1.0, (balls, 3, 3))  # m; three waves, axes x, y, z

    def path(number: int) -> PositionFunction:
        def place(time: float) -> tuple[float, float, float]:
            waves = sizes[number] * np.sin(2 * math.pi * rates[number] * time + phases[number])
            x, y, z = waves.sum(axis=0).tolist()
            return x, y, DEPTH + z

        return place

    return Crowd([path(number) for number in range(balls)], round(seconds * 30), seed, preset)


SCENES: dict[str, Callable[..., Crowd]] = {"juggling": juggling, "billiards": billiards, "swarm": swarm}


def _apart(random: np.random.Generator, balls: int, half: Floats) -> Floats:
    """Places in a plane of which no two touch."""
    places: list[Floats] = []
    while len(places) < balls:
        place = random.uniform(-half, half)
        if all(np.linalg.norm(place - other) > 2.2 * RADIUS for other in places):
            places.append(place)
    return np.array(places)


def _along(courses: Floats, depths: Floats) -> list[PositionFunction]:
    """Paths through places that were computed step by step."""

    def path(number: int) -> PositionFunction:
        def place(time: float) -> tuple[float, float, float]:
            x, y = courses[max(round(time * STEPS), 0), number].tolist()
            return x, y, float(depths[number])

        return place

    return [path(number) for number in range(len(depths))]
