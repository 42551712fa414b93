"""Two equal balls, one of which hides the other for a second: `hidden_pair`."""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from benchmarks.crowds.crowd import CAMERA, FPS, MIN_VISIBLE, RADIUS, Crowd, shared_area
from matchset.sim.clips.multi_ball_clip import PositionFunction

SECONDS = 5.0  # s, of the scene; its middle is that of the second
HIDDEN = 1.0  # s, for which less of the farther ball is seen than counts
TURNS_BACK = 3  # of so many seeds, one in which the farther ball comes out where it went in

Flat = tuple[float, float]


def hidden_pair(seed: int, preset: str = "typical") -> Crowd:
    """Two equal balls; the nearer one hides the other for a second, and both come out.

    Both fly at constant velocity across the view; the farther one comes out on the other side. Every third seed, it
    turns back while it is hidden, at constant acceleration, and comes out on the side on which it went in.
    """
    random = np.random.default_rng(seed)
    while True:
        near = random.uniform(1.6, 2.4)
        far = near + random.uniform(0.3, 0.9)
        radii = CAMERA.fx * RADIUS / near, CAMERA.fx * RADIUS / far
        apart = _apart(*radii)
        direction = random.uniform(0.0, 2.0 * math.pi)
        relative = _turning(apart, random) if seed % TURNS_BACK == 0 else _passing(apart, random)
        middle, speed = random.uniform(-80.0, 80.0, 2), random.uniform(-45.0, 45.0, 2)
        nearer = _course(middle, speed, 0.0, lambda _: (0.0, 0.0))
        farther = _course(middle, speed, direction, relative)
        ends = (-SECONDS / 2.0, 0.0, SECONDS / 2.0)
        if all(_in_view(course(time), radii[0]) for course in (nearer, farther) for time in ends):
            paths = [_at_depth(nearer, near), _at_depth(farther, far)]
            return Crowd(paths[:: 1 if random.integers(2) else -1], round(SECONDS * FPS), seed, preset)


def _apart(near: float, far: float) -> float:
    """Distance of the centers from which the farther ball counts as hidden, px."""
    area = math.pi * far * far
    return float(brentq(lambda apart: shared_area(near, far, apart) / area - 1.0 + MIN_VISIBLE, 0.0, near + far))


def _passing(apart: float, random: np.random.Generator) -> Callable[[float], Flat]:
    """Pass along a line past the middle of the nearer ball, at constant velocity; s to px."""
    beside = random.uniform(-0.5, 0.5) * apart
    speed = 2.0 * math.sqrt(apart**2 - beside**2) / HIDDEN
    return lambda time: (speed * time, beside)


def _turning(apart: float, random: np.random.Generator) -> Callable[[float], Flat]:
    """Go behind the nearer ball and back, at constant acceleration while it is hidden; s to px."""
    least = random.uniform(0.1, 0.5) * apart
    half = HIDDEN / 2.0

    def relative(time: float) -> Flat:
        inside = min(abs(time), half)
        beyond = abs(time) - inside
        return least + (apart - least) * ((inside / half) ** 2 + 2.0 * beyond / half), 0.0

    return relative


def _course(
    middle: np.ndarray, speed: np.ndarray, direction: float, relative: Callable[[float], Flat]
) -> Callable[[float], Flat]:
    """Return a place in the picture by the time from the middle of the scene; px from the camera's axis."""
    c, s = math.cos(direction), math.sin(direction)

    def place(time: float) -> Flat:
        x, y = (middle + speed * time).tolist()
        along, across = relative(time)
        return x + c * along - s * across, y + s * along + c * across

    return place


def _in_view(place: Flat, radius: float) -> bool:
    return abs(place[0]) < CAMERA.width / 2.0 - radius - 4.0 and abs(place[1]) < CAMERA.height / 2.0 - radius - 4.0


def _at_depth(course: Callable[[float], Flat], depth: float) -> PositionFunction:
    def place(time: float) -> tuple[float, float, float]:
        x, y = course(time - SECONDS / 2.0)
        return x / CAMERA.fx * depth, y / CAMERA.fy * depth, depth

    return place
