"""Rendered crowds of equal balls: `juggling`, `billiards`, `swarm` and `crossing`, each a `Crowd` with its truth."""

import itertools
import math
from collections.abc import Callable

import numpy as np

from benchmarks.crowds.crowd import CAMERA, FPS, RADIUS, Crowd, Floats
from benchmarks.crowds.juggling import juggling
from matchset.sim.clips.multi_ball_clip import PositionFunction

STEPS = 240  # a second, in which paths with collisions are computed
FINER = 4  # steps of billiards in each of those
DEPTH = 3.2  # m, of a swarm's middle
HALF = np.array((CAMERA.width / CAMERA.fx, CAMERA.height / CAMERA.fy)) / 2.0  # of the picture, at 1 m
PULL = 3.0  # rad/s, of the spring between a ball of a swarm and its aim
PUSH = 6000.0  # 1/s^2, between balls of a swarm that would touch
EVERY = 2.0  # s, between crossings


def billiards(balls: int, seconds: float, seed: int, preset: str = "typical") -> Crowd:
    """Balls in a plane across the view that bounce off each other and off its edges, without friction."""
    random = np.random.default_rng(seed)
    depth = 2.2 + 0.09 * balls
    half = HALF * depth - RADIUS
    places = _apart(random, balls, half)
    speeds = random.normal(0.0, 0.9, (balls, 2))
    courses = np.empty((round(seconds * STEPS) + STEPS, balls, 3))
    courses[:, :, 2] = depth
    for step in range(FINER * len(courses)):
        courses[step // FINER, :, :2] = places
        places = places + speeds / (FINER * STEPS)
        outside = (np.abs(places) > half) & (places * speeds > 0.0)
        speeds[outside] *= -1.0
        for one, other in _touching(places):
            normal = (places[other] - places[one]) / np.linalg.norm(places[other] - places[one])
            closing = float((speeds[one] - speeds[other]) @ normal)
            if closing > 0.0:  # equal masses exchange what is along the normal
                speeds[one] -= closing * normal
                speeds[other] += closing * normal
    return Crowd(_along(courses), round(seconds * FPS), seed, preset)


def swarm(balls: int, seconds: float, seed: int, preset: str = "typical") -> Crowd:
    """Balls that wander in three dimensions, pass before and behind each other, leave the view and come back.

    Each is drawn to an aim of its own, a sum of three waves along each axis, and pushed from others before they touch.
    """
    random = np.random.default_rng(seed)
    rates, phases = random.uniform(0.06, 0.28, (balls, 3, 3)), random.uniform(0.0, 2 * math.pi, (balls, 3, 3))
    sizes = np.array((1.0, 0.65, 0.6)) * random.uniform(0.5, 1.0, (balls, 3, 3))  # m; three waves, axes x, y, z
    courses = np.empty((round(seconds * STEPS) + STEPS, balls, 3))
    places, speeds = np.zeros((balls, 3)), np.zeros((balls, 3))
    for step in range(-3 * STEPS, len(courses)):
        aims = (sizes * np.sin(2 * math.pi * rates * step / STEPS + phases)).sum(axis=1)
        if step == -3 * STEPS:
            places = aims
        between = places[:, np.newaxis] - places
        far = np.maximum(np.sqrt((between**2).sum(axis=2)), 1e-9)
        np.fill_diagonal(far, np.inf)
        push = (PUSH * np.maximum(2.4 * RADIUS - far, 0.0) / far)[:, :, np.newaxis] * between
        speeds += (PULL**2 * (aims - places) - PULL * speeds + push.sum(axis=1)) / STEPS
        places = places + speeds / STEPS
        courses[max(step, 0)] = places
    return Crowd(_along(courses + np.array((0.0, 0.0, DEPTH))), round(seconds * FPS), seed, preset)


def crossing(balls: int, seconds: float, seed: int, preset: str = "typical") -> Crowd:
    """Balls that swing through the middle of the view along lines of their own: every 2 s all of them cross there.

    They pass it within some tenths of a second of each other, at depths so different that none touches another. At most
    16 are told from each other there.

    Raises
    ------
    ValueError
        If so many cannot cross without touching.
    """
    random = np.random.default_rng(seed)
    turn, times = random.uniform(0.0, math.pi), np.arange(0.0, 2.0 * EVERY, 1.0 / 120.0)
    lines = _far_apart(balls)
    paths: list[PositionFunction] = []
    courses: list[Floats] = []
    for _ in range(100 * balls):
        rank = len(paths)
        if rank == balls:
            break
        depth = max(3.2 - 0.08 * (balls - 1), 2.2) + 0.17 * rank
        angle = turn + math.pi * (lines[rank] + random.uniform(-0.2, 0.2)) / balls
        late = (0.1 if rank % 2 else -0.1) + 0.03 * random.standard_normal()
        path = _swing(depth, angle, late, 0.1 * random.standard_normal(), lines[rank] % 2)
        course = np.array([path(time) for time in times])
        if all(np.linalg.norm(course - other, axis=1).min() > 2.0 * RADIUS for other in courses):
            paths.append(path)
            courses.append(course)
    if len(paths) < balls:
        raise ValueError(f"{balls} balls cannot cross without touching")
    return Crowd([paths[at] for at in random.permutation(balls)], round(seconds * FPS), seed, preset)


def _far_apart(balls: int) -> list[int]:
    """Order of lines through one point in which lines that follow each other are far from parallel."""
    half = (balls + 1) // 2
    pairs = itertools.zip_longest(range(half), range(half, balls))
    return [each for pair in pairs for each in pair if each is not None]


def _swing(depth: float, angle: float, late: float, beside: float, end: int) -> PositionFunction:
    """Swing through the middle of the picture that begins at one end of its line."""
    far = 0.8 * float(HALF[1]) * depth
    along, across = np.array((math.cos(angle), math.sin(angle))), np.array((-math.sin(angle), math.cos(angle)))

    def place(time: float) -> tuple[float, float, float]:
        swing = far * math.cos(math.pi * ((time - late) / EVERY + end))
        x, y = (swing * along + beside * across).tolist()
        return x, y, depth

    return place


SCENES: dict[str, Callable[..., Crowd]] = {
    "juggling": juggling,
    "billiards": billiards,
    "swarm": swarm,
    "crossing": crossing,
}


def _apart(random: np.random.Generator, balls: int, half: Floats) -> Floats:
    """Places in a plane of which no two touch."""
    places: list[Floats] = []
    while len(places) < balls:
        place = random.uniform(-half, half)
        if all(np.linalg.norm(place - other) > 2.2 * RADIUS for other in places):
            places.append(place)
    return np.array(places)


def _touching(places: Floats) -> list[tuple[int, int]]:
    """Pairs of balls that touch."""
    between = places[:, np.newaxis] - places
    near = np.argwhere(np.triu((between**2).sum(axis=2) < (2.0 * RADIUS) ** 2, 1))
    return [(int(one), int(other)) for one, other in near]


def _along(courses: Floats) -> list[PositionFunction]:
    """Paths through places that were computed step by step, (steps, balls, 3), m."""

    def path(number: int) -> PositionFunction:
        def place(time: float) -> tuple[float, float, float]:
            x, y, z = courses[max(round(time * STEPS), 0), number].tolist()
            return x, y, z

        return place

    return [path(number) for number in range(courses.shape[1])]
