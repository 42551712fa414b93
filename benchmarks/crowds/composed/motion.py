"""How the balls of composed crowds move: `bouncing`, `rolling` and `swinging`, each a `Course`."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from benchmarks.crowds.composed.footage import HEIGHT, WIDTH

if TYPE_CHECKING:
    import pymunk  # imported where it is needed: of the `bench` group

Floats = npt.NDArray[np.float64]

STEPS = 240  # a second, in which paths are computed
NEARER = 1.15  # radii of the balls of the nearer of two planes
TURN = 20.0 / 150.0  # of the picture of a ball, rad for each rad that it rolls
LYING = 20.0  # px/s: a ball that is slower lies


class Course(NamedTuple):
    """Where balls are, step by step.

    Parameters
    ----------
    places : array, shape (steps, balls, 4)
        Center x, y, radius, px, and how far it has turned, rad. Out of the picture where it is away.
    depths : array, shape (steps, balls)
        The larger one is nearer.
    floor : float or None
        Height of the floor on which shadows lie, px; None: there is none, or it is the picture.
    """

    places: Floats
    depths: Floats
    floor: float | None


def bouncing(radii: list[float], seconds: float, random: np.random.Generator) -> Course:
    """Balls that are thrown in by turns, bounce on a floor and off each other, leave, and come back.

    One that left at a side is thrown back from there, so that its name can be known. They are in two planes: those of
    one plane hide those of the other, which is farther.

    Parameters
    ----------
    radii : list of float
        Of each ball, px.
    seconds : float
    random : Generator

    Returns
    -------
    Course
    """
    import pymunk

    floor = HEIGHT - random.uniform(25.0, 70.0)
    space = pymunk.Space()
    space.gravity = (0.0, random.uniform(700.0, 1400.0))
    line = pymunk.Segment(space.static_body, (-5000.0, floor + 50.0), (5000.0, floor + 50.0), 50.0)
    line.elasticity, line.friction = 0.9, 0.6
    space.add(line)
    planes = [number % 2 for number in range(len(radii))]
    sizes = [radius * (NEARER if plane else 1.0) for radius, plane in zip(radii, planes, strict=True)]
    bodies = [_body(space, size, plane, 0.85) for size, plane in zip(sizes, planes, strict=True)]
    for number, body in enumerate(bodies):
        body.position = (-1000.0 - 100.0 * number, floor - 400.0)
    due = np.arange(len(radii)) * random.uniform(0.15, 0.3) - 0.3
    away = [True] * len(radii)
    doors = [(1 if random.random() < 0.5 else -1, random.uniform(60.0, 0.6 * floor)) for _ in radii]

    def before(step: int) -> None:
        now = step / STEPS
        for number, (body, size) in enumerate(zip(bodies, sizes, strict=True)):
            if away[number] and now >= due[number]:
                side, y = doors[number]
                x = -size - 5.0 if side > 0 else WIDTH + size + 5.0
                if all(math.dist((x, y), other.position) > 3.0 * size for other in bodies if other is not body):
                    body.position = (x, y)
                    body.velocity = (side * random.uniform(130.0, 420.0), random.uniform(-420.0, 50.0))
                    body.angular_velocity = random.normal(0.0, 4.0)
                    away[number] = False
            elif not away[number] and not -size - 10.0 <= body.position.x <= WIDTH + size + 10.0:
                away[number] = True
                due[number] = now + random.uniform(0.2, 0.8)
                side = 1 if body.position.x < 0.0 else -1
                doors[number] = (side, float(np.clip(body.position.y, 0.0, floor - 2.0 * size)))
                body.position = (-1000.0 - 100.0 * number, floor - 400.0)
            if away[number]:
                body.velocity = (0.0, 0.0)
                body.position = (-1000.0 - 100.0 * number, floor - 400.0)

    return Course(_simulated(space, bodies, sizes, seconds, before), _constant(planes, seconds), floor)


def rolling(radii: list[float], seconds: float, random: np.random.Generator) -> Course:
    """Balls on a table seen from above: they roll, hit each other and the cushions, and one after the other is struck.

    Parameters
    ----------
    radii : list of float
        Of each ball, px.
    seconds : float
    random : Generator

    Returns
    -------
    Course
    """
    import pymunk

    space = pymunk.Space()
    space.damping = random.uniform(0.6, 0.8)
    edge = random.uniform(2.0, 12.0)
    corners = [(edge, edge), (WIDTH - edge, edge), (WIDTH - edge, HEIGHT - edge), (edge, HEIGHT - edge)]
    for begin, end in zip(corners, corners[1:] + corners[:1], strict=True):
        outside = 50.0 * np.sign(np.add(begin, end) / 2.0 - (WIDTH / 2.0, HEIGHT / 2.0))
        cushion = pymunk.Segment(space.static_body, tuple(begin + outside), tuple(end + outside), 50.0)
        cushion.elasticity, cushion.friction = 0.85, 0.1
        space.add(cushion)
    bodies: list[pymunk.Body] = []
    for size in radii:
        body = _body(space, size, 0, 0.95)
        while True:
            x, y = (float(random.uniform(edge + size, most - edge - size)) for most in (WIDTH, HEIGHT))
            if all(math.dist((x, y), other.position) > 2.1 * max(radii) for other in bodies):
                break
        body.position = (x, y)
        bodies.append(body)
    between = random.uniform(0.5, 1.0)

    def before(step: int) -> None:
        if step % round(between * STEPS) == 0:
            struck, aim = random.choice(len(bodies), 2, replace=False) if len(bodies) > 1 else (0, 0)
            way = np.subtract(bodies[aim].position, bodies[struck].position) + random.normal(0.0, 8.0, 2)
            speed = random.uniform(350.0, 900.0) * way / max(float(np.linalg.norm(way)), 1.0)
            bodies[struck].velocity = (float(speed[0]), float(speed[1]))
        for body in bodies:
            if body.velocity.length < LYING:
                body.velocity = (0.0, 0.0)
            body.angular_velocity = body.velocity.length / 40.0

    return Course(_simulated(space, bodies, radii, seconds, before), _constant([0] * len(radii), seconds), None)


def swinging(radii: list[float], seconds: float, random: np.random.Generator) -> Course:
    """Balls on ellipses that lie in the view, and pendulums: they pass before each other and touch nothing.

    Parameters
    ----------
    radii : list of float
        Of each ball, px, at the middle of its depth.
    seconds : float
    random : Generator

    Returns
    -------
    Course
    """
    times = np.arange(round(seconds * STEPS) + STEPS) / STEPS
    places = np.empty((len(times), len(radii), 4))
    depths = np.empty((len(times), len(radii)))
    for number, radius in enumerate(radii):
        phase = 2.0 * math.pi * (times / random.uniform(1.8, 3.6) + random.random())
        depth = np.full(len(times), 2.0 * number / max(len(radii) - 1, 1) - 1.0)
        if number % 2:
            length, swing = random.uniform(300.0, 520.0), random.uniform(0.35, 0.9)
            pivot = random.uniform(0.2, 0.8) * WIDTH, random.uniform(-150.0, -30.0)
            angle = swing * np.sin(phase)
            x, y = pivot[0] + length * np.sin(angle), pivot[1] + length * np.cos(angle)
        else:
            depth = np.sin(phase)
            x = WIDTH * (random.uniform(0.35, 0.65) + random.uniform(0.2, 0.45) * np.cos(phase))
            y = HEIGHT * (
                random.uniform(0.3, 0.7) + random.uniform(0.08, 0.3) * np.sin(phase + random.normal(0.0, 0.5))
            )
        places[:, number] = np.stack((x, y, radius * (1.0 + 0.15 * depth), TURN * 30.0 * np.sin(phase)), axis=1)
        depths[:, number] = depth
    return Course(places, depths, None)


def _body(space: "pymunk.Space", size: float, plane: int, elasticity: float) -> "pymunk.Body":
    import pymunk

    mass = (size / 20.0) ** 2
    body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0.0, size))
    shape = pymunk.Circle(body, size)
    shape.elasticity, shape.friction = elasticity, 0.3
    shape.filter = pymunk.ShapeFilter(categories=2 << plane, mask=pymunk.ShapeFilter.ALL_MASKS() ^ (4 >> plane))
    space.add(body, shape)
    return body


def _simulated(
    space: "pymunk.Space",
    bodies: "list[pymunk.Body]",
    sizes: list[float],
    seconds: float,
    before: Callable[[int], None],
) -> Floats:
    places = np.empty((round(seconds * STEPS) + STEPS, len(bodies), 4))
    for step in range(len(places)):
        before(step)
        places[step] = [(*body.position, size, TURN * body.angle) for body, size in zip(bodies, sizes, strict=True)]
        space.step(1.0 / STEPS)
    return places


def _constant(depths: list[int], seconds: float) -> Floats:
    return np.tile(np.array(depths, float), (round(seconds * STEPS) + STEPS, 1))
