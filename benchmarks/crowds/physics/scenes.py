"""Scenes of equal balls and a few others: `bouncing`, `billiards`, `box`, `slope`, `juggling`, each a `Stage`."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from benchmarks.crowds.physics.camera import Camera, Lamp
from benchmarks.crowds.physics.surfaces import COLORS, bricks, cloth, marked, paper, wood
from benchmarks.crowds.physics.world import GRAVITY, RATE, Ball, Color, Point, World

PALE = ((205, 200, 190), (190, 200, 205), (215, 205, 180))
WOODS = ((190, 145, 95), (150, 105, 65), (205, 175, 130))
AFTER = 1.0  # s, for which a ball that left stays away at least


class Stage(NamedTuple):
    """A scene, ready to be played.

    Parameters
    ----------
    camera : Camera
    lamp : Lamp
    normal : (float, float, float)
        Of the surface on which shadows fall.
    act : callable
        What people do at a time, s; called before every step.
    before : float
        Time that is played before the first picture, s.
    """

    camera: Camera
    lamp: Lamp
    normal: Point
    act: Callable[[float], None]
    before: float = 0.0


class Turns:
    """Balls that are thrown by turns, and again some time after they left.

    Parameters
    ----------
    world : World
    order : list of Ball
    every : (float, float)
        Least and most time between throws, s.
    throw : callable
    gone : callable
        Whether a ball at a place has left.
    random : Generator
    """

    def __init__(
        self,
        world: World,
        order: list[Ball],
        every: tuple[float, float],
        throw: Callable[[Ball], None],
        gone: Callable[[Point], bool],
        random: np.random.Generator,
    ) -> None:
        self._world, self._every, self._throw, self._gone, self._random = world, every, throw, gone, random
        self._waiting = [(0.0, each) for each in order]
        self._out: list[Ball] = []
        self._next = 0.0

    def __call__(self, time: float) -> None:
        """Throw a ball if it is time, and take those away that left."""
        for ball in list(self._out):
            x, y, z = self._world.center(ball).tolist()
            if self._gone((x, y, z)):
                self._out.remove(ball)
                self._world.put_away(ball)
                self._waiting.append((time + AFTER, ball))
        for _, ball in self._waiting:
            self._world.kick(ball, (0.0, 0.0, 0.0))
        if time >= self._next and self._waiting and time >= self._waiting[0][0]:
            _, ball = self._waiting.pop(0)
            self._throw(ball)
            self._out.append(ball)
            self._next = time + float(self._random.uniform(*self._every))


def bouncing(world: World, balls: int, random: np.random.Generator) -> Stage:
    """Balls that are thrown by turns onto a table, bounce, roll, collide, leave and come in again."""
    table = wood(random, _one(random, WOODS)) if random.random() < 0.5 else paper(random, _one(random, PALE))
    world.sheet((-7.2, -5.0, 0.0), (14.4, 0.0, 0.0), (0.0, 10.4, 0.0), table)
    world.block((0.0, 0.2, -0.25), (7.2, 5.2, 0.25), None, bounce=0.9)
    world.sheet((-40.0, -12.0, -8.0), (80.0, 0.0, 0.0), (0.0, 60.0, 0.0), cloth(random, (75, 72, 70)))
    radius = float(random.uniform(0.26, 0.48))
    name = "orange" if random.random() < 0.7 else str(random.choice(["red", "blue", "green"]))
    others = ["white", "pink", str(random.choice(["purple", "yellow", "brown"]))]
    larger = radius * float(random.choice([0.65, 1.5]))
    crowd = _crowd(world, balls, radius, name, random, bounce=0.78, rolling=0.07)
    distracting = [_other(world, radius, each, random, bounce=0.78, rolling=0.07) for each in others[:2]]
    distracting.append(_other(world, larger, others[2], random, bounce=0.75, rolling=0.07))
    order = _mixed(crowd, distracting, random)

    def throw(ball: Ball) -> None:
        side = int(random.integers(0, 3))
        start = (8.4 * (2 * side - 1), float(random.uniform(-2.5, 3.5)), float(random.uniform(1.0, 4.0)))
        aim = (float(random.uniform(0.0, 5.0)) * (2 * side - 1), float(random.uniform(-2.5, 3.0)))
        if side == 2:
            start = (float(random.uniform(-4.0, 4.0)), -6.8, float(random.uniform(0.2, 1.2)))
            aim = (start[0] + float(random.normal(0.0, 2.0)), float(random.uniform(-2.0, 1.5)))
        flight = float(random.uniform(0.45, 0.75))
        across, deep = ((there - here) / flight for there, here in zip(aim, start[:2], strict=True))
        up = GRAVITY * flight / 2.0 - (start[2] - radius) / flight
        spin = tuple(float(each) for each in random.normal(0.0, 8.0, 3))
        world.throw(ball, start, (across, deep, up), (spin[0], spin[1], spin[2]))

    turns = Turns(world, order, (0.2, 0.55), throw, lambda at: at[2] < -7.0 or abs(at[0]) > 30.0, random)
    next_poke = [3.0]

    def act(time: float) -> None:
        turns(time)
        if time >= next_poke[0]:
            poked = order[int(random.integers(len(order)))]
            if world.there(poked) and world.center(poked)[2] < 2.0 * radius:
                angle, speed = float(random.uniform(0.0, math.tau)), float(random.uniform(6.0, 18.0))
                world.kick(poked, (speed * math.cos(angle), speed * math.sin(angle), float(random.uniform(0.0, 12.0))))
            next_poke[0] = time + float(random.uniform(0.5, 1.5))

    far = float(random.uniform(0.95, 1.1))
    eye = (float(random.uniform(-1.5, 1.5)), -10.5 * far, float(random.uniform(7.5, 10.0)) * far)
    return Stage(Camera(eye, (0.0, 0.3, 0.6), 640.0), _lamp(random, 14.0), (0.0, 0.0, 1.0), act, 2.0)


def billiards(world: World, balls: int, random: np.random.Generator) -> Stage:
    """Billiard balls on cloth, seen obliquely; every other second one is struck."""
    wide, deep = 9.0, 6.0
    color = _one(random, ((25, 105, 60), (20, 95, 85), (40, 120, 55)))
    world.sheet((-wide, -deep, 0.0), (2 * wide, 0.0, 0.0), (0.0, 2 * deep, 0.0), cloth(random, color))
    world.block((0.0, 0.0, -0.5), (wide + 1.0, deep + 1.0, 0.5), None, bounce=0.5)
    darker = cloth(random, (color[0] // 2, int(0.7 * color[1]), color[2] // 2))
    rim = wood(random, (95, 55, 30), 2)
    for sign in (-1.0, 1.0):
        world.block((sign * (wide + 0.2), 0.0, 0.2), (0.2, deep + 0.4, 0.2), darker)
        world.block((0.0, sign * (deep + 0.2), 0.2), (wide, 0.2, 0.2), darker)
        world.block((sign * (wide + 0.9), 0.0, 0.2), (0.5, deep + 1.4, 0.25), rim)
        world.block((0.0, sign * (deep + 0.9), 0.2), (wide + 0.4, 0.5, 0.25), rim)
    world.sheet((-40.0, -12.0, -8.0), (80.0, 0.0, 0.0), (0.0, 60.0, 0.0), cloth(random, (90, 60, 50)))
    radius = float(random.uniform(0.3, 0.42))
    name = "red" if random.random() < 0.6 else str(random.choice(["yellow", "blue", "white"]))
    others = [each for each in ("white", "yellow", "blue", "black", "brown", "pink") if each != name][:4]
    crowd = _crowd(world, balls, radius, name, random, bounce=0.95, rolling=0.006, marks=1)
    distracting = [_other(world, radius, each, random, bounce=0.95, rolling=0.006) for each in others]
    everyone = crowd + distracting
    for ball, (x, y) in zip(everyone, _spread(random, len(everyone), wide - 1.0, deep - 1.0, radius), strict=True):
        world.throw(ball, (x, y, radius), (float(random.normal(0.0, 6.0)), float(random.normal(0.0, 6.0)), 0.0))
    next_stroke = [0.0]

    def act(time: float) -> None:
        if time >= next_stroke[0]:
            angle, speed = random.uniform(0.0, math.tau), random.uniform(14.0, 32.0)
            struck = everyone[int(random.integers(len(everyone)))]
            world.kick(struck, (speed * math.cos(angle), speed * math.sin(angle), 0.0))
            next_stroke[0] = time + float(random.uniform(0.7, 1.8))

    turned = float(random.uniform(-0.6, 0.6))
    eye = (16.0 * math.sin(turned), -16.0 * math.cos(turned), float(random.uniform(7.0, 11.0)))
    return Stage(Camera(eye, (0.0, 0.2, 0.0), 620.0), _lamp(random, 16.0), (0.0, 0.0, 1.0), act)


def box(world: World, balls: int, random: np.random.Generator) -> Stage:
    """Balls in a box that is shaken: the camera moves with it, so gravity swings instead."""
    wide, deep, high = 5.2, 3.9, 1.3
    floor = wood(random, _one(random, WOODS), 3) if random.random() < 0.5 else cloth(random, (70, 75, 95))
    side = wood(random, _one(random, WOODS), 2)
    world.sheet((-wide, -deep, 0.0), (2 * wide, 0.0, 0.0), (0.0, 2 * deep, 0.0), floor)
    world.block((0.0, 0.0, -0.5), (wide + 1.0, deep + 1.0, 0.5), None, bounce=0.6)
    for sign in (-1.0, 1.0):
        world.block((sign * (wide + 0.2), 0.0, high / 2), (0.2, deep + 0.4, high / 2), side)
        world.block((0.0, sign * (deep + 0.2), high / 2), (wide, 0.2, high / 2), side)
        world.block((sign * (wide + 1.2), 0.0, 10.0), (1.0, deep + 2.0, 10.0), None)
        world.block((0.0, sign * (deep + 1.2), 10.0), (wide + 2.0, 1.0, 10.0), None)
    world.sheet((-20.0, -15.0, -2.0), (40.0, 0.0, 0.0), (0.0, 30.0, 0.0), paper(random, (150, 140, 130)))
    radius = float(random.uniform(0.3, 0.42 if balls > 10 else 0.5))
    name = str(random.choice(["orange", "yellow", "green", "blue", "red", "white"]))
    others = [each for each in ("pink", "purple", "white", "brown") if each != name][:3]
    crowd = _crowd(world, balls, radius, name, random, bounce=0.75)
    distracting = [
        _other(world, radius * float(random.uniform(0.7, 1.2)), each, random, bounce=0.75) for each in others
    ]
    everyone = crowd + distracting
    for ball, (x, y) in zip(everyone, _spread(random, len(everyone), wide - 0.7, deep - 0.7, radius), strict=True):
        world.throw(ball, (x, y, 1.2 * radius), (0.0, 0.0, 0.0))
    rates, phases, swing = random.uniform(0.4, 1.3, 4), random.uniform(0.0, math.tau, 4), random.uniform(0.2, 0.5, 4)

    def act(time: float) -> None:
        pull = GRAVITY * swing * np.sin(math.tau * rates * time + phases)
        lift = 0.5 * max(math.sin(math.tau * 0.7 * time + phases[0]) - 0.6, 0.0)
        world.pull((float(pull[0] + pull[1]), float(pull[2] + pull[3]), GRAVITY * (lift - 1.0)))

    eye = (float(random.uniform(-2.0, 2.0)), float(random.uniform(-7.0, -4.0)), 11.0)
    return Stage(Camera(eye, (0.0, 0.0, 0.0), 620.0), _lamp(random, 14.0), (0.0, 0.0, 1.0), act, 0.5)


def slope(world: World, balls: int, random: np.random.Generator) -> Stage:
    """Marbles that roll down a slope between pegs, one after the other; the slope is level and gravity oblique."""
    tilt = math.radians(float(random.uniform(14.0, 24.0)))
    world.pull((0.0, -GRAVITY * math.sin(tilt), -GRAVITY * math.cos(tilt)))
    wide, deep = 6.0, 6.0
    board = paper(random, _one(random, PALE)) if random.random() < 0.5 else wood(random, _one(random, WOODS), 4)
    world.sheet((-wide, -deep, 0.0), (2 * wide, 0.0, 0.0), (0.0, 2 * deep, 0.0), board)
    world.block((0.0, 0.0, -0.5), (wide, deep + 6.0, 0.5), None, bounce=0.4)
    for sign in (-1.0, 1.0):
        world.block((sign * (wide + 0.2), 0.0, 0.4), (0.2, deep, 0.4), wood(random, (110, 75, 45), 1))
        world.block((sign * (wide + 0.2), 0.0, 6.0), (0.2, deep + 6.0, 6.0), None)
    world.sheet((-40.0, -20.0, -6.0), (80.0, 0.0, 0.0), (0.0, 60.0, 0.0), cloth(random, (85, 85, 80)))
    radius = float(random.uniform(0.28, 0.42))
    apart = 4.6 * radius + float(random.uniform(0.2, 0.5))
    metal = _one(random, ((120, 120, 125), (60, 60, 65), (165, 150, 110)))
    for row in range(int(2 * (deep - 1.0) / apart)):
        for column in range(-6, 7):
            x, y = (column + 0.5 * (row % 2)) * apart, deep - 1.5 - row * apart
            if abs(x) < wide - 0.3:
                world.peg((x, y, 0.35), 0.13, 0.7, metal)
    name = str(random.choice(["blue", "green", "red", "orange", "yellow"]))
    others = [each for each in ("white", "purple", "black", "pink") if each != name][:3]
    crowd = _crowd(world, balls, radius, name, random, bounce=0.6, rolling=0.01)
    distracting = [_other(world, radius, each, random, bounce=0.6, rolling=0.01) for each in others]

    def throw(ball: Ball) -> None:
        start = (float(random.uniform(-4.5, 4.5)), deep + 1.5, radius)
        world.throw(ball, start, (float(random.normal(0.0, 3.0)), -3.0, 0.0))

    order = _mixed(crowd, distracting, random)
    turns = Turns(world, order, (0.1, 0.4), throw, lambda at: at[1] < -deep - 3.0 or at[2] < -3.0, random)
    eye = (float(random.uniform(-2.0, 2.0)), float(random.uniform(-9.0, -7.0)), 11.5)
    return Stage(Camera(eye, (0.0, -0.3, 0.0), 640.0), _lamp(random, 14.0), (0.0, 0.0, 1.0), turns, 1.5)


def juggling(world: World, balls: int, random: np.random.Generator) -> Stage:
    """Balls that two hands throw up in arcs that cross, before a wall; one ball of another color is among them."""
    name = str(random.choice(["orange", "red", "yellow", "green", "blue", "white"]))
    tone = (
        (70, 62, 60) if name in ("white", "yellow") else _one(random, ((165, 90, 70), (175, 165, 150), (130, 135, 120)))
    )
    wall = bricks(random, tone) if random.random() < 0.6 else wood(random, tone, 7)
    world.sheet((-14.0, 5.0, -12.0), (28.0, 0.0, 0.0), (0.0, 0.0, 28.0), wall)
    radius = float(random.uniform(0.38, 0.6))
    order = _crowd(world, balls, radius, name, random, bounce=0.5)
    order.insert(int(random.integers(balls + 1)), _other(world, radius, "pink", random, bounce=0.5))
    world.no_touch()
    many = len(order)
    flight, hold = float(random.uniform(0.85, 0.98)), 0.24
    beat = (flight + hold) / many  # between throws of any hand
    hold = min(hold, 1.4 * beat) if many > 2 else hold
    beat = (flight + hold) / many
    skin = marked(random, (205, 150, 120), 0)
    sleeve = cloth(random, _one(random, ((60, 60, 80), (110, 40, 40), (50, 80, 60))))
    hands = [(world.limb(0.55, 1.3, skin), world.limb(0.5, 5.0, sleeve)) for _ in range(2)]
    offsets = random.normal(0.0, 0.25, (4096, 3)) * (1.0, 1.2, 0.3)

    def thrown_from(number: int) -> Point:
        sign = 2 * (number % 2) - 1
        x, y, z = offsets[number]
        return (sign * 1.3 + x, y, -4.4 + z)

    def caught_at(number: int) -> Point:
        """Where the hand is that catches what it throws in a beat."""
        sign = 2 * (number % 2) - 1
        x, y, z = offsets[number + 2048]
        return (sign * 3.2 + x, y, -4.2 + z)

    def hand(side: int, time: float) -> Point:
        number = math.ceil((time / beat - side) / 2.0) * 2 + side  # its next throw
        to_throw, caught = number * beat - time, number * beat - hold
        if time >= caught:
            share, begin, end = 1.0 - to_throw / hold, caught_at(number), thrown_from(number)
        else:
            share = (time - (number - 2) * beat) / max(2.0 * beat - hold, 1e-6)
            begin, end = thrown_from(number - 2), caught_at(number)
        smooth = share * share * (3.0 - 2.0 * share)
        x, y, z = (a + (b - a) * smooth for a, b in zip(begin, end, strict=True))
        return (x, y, z - 0.8 * math.sin(math.pi * share) * (time >= caught))

    flying: dict[int, int] = {}
    began = 2 * many * beat

    def act(time: float) -> None:
        time += began
        for side, (palm, arm) in enumerate(hands):
            x, y, z = hand(side, time)
            world.place(palm, (x, y - 0.1, z - 0.75), (0.0, 1.4, 0.0))
            world.place(arm, (x * 1.25, y - 0.3, z - 3.2), (0.0, -0.2 * (2 * side - 1), 0.0))
        for slot, ball in enumerate(order):
            number = math.ceil((time / beat - slot) / many - 1e-9) * many + slot  # its next throw
            caught = number * beat - hold
            if time >= caught:
                x, y, z = hand(number % 2, time)
                world.throw(ball, (x, y, z), (0.0, 0.0, 0.0))
                flying.pop(slot, None)
            elif flying.get(slot) != number:
                flying[slot] = number
                begin, end, passed = thrown_from(number - many), caught_at(number), time - (number - many) * beat
                speed = [(b - a) / flight for a, b in zip(begin, end, strict=True)]
                speed[2] += GRAVITY * flight / 2.0
                where = [a + each * passed for a, each in zip(begin, speed, strict=True)]
                where[2] -= GRAVITY * passed**2 / 2.0
                up = speed[2] - GRAVITY * passed + GRAVITY / (2.0 * RATE)
                spin = tuple(float(each) for each in random.normal(0.0, 5.0, 3))
                world.throw(ball, (where[0], where[1], where[2]), (speed[0], speed[1], up), (spin[0], spin[1], spin[2]))

    eye = (float(random.uniform(-2.0, 2.0)), -19.0, float(random.uniform(0.0, 2.5)))
    lamp = _lamp(random, 12.0)._replace(place=(float(random.uniform(-8.0, 8.0)), -14.0, 14.0), beam=(0.0, 3.0, 2.0))
    return Stage(Camera(eye, (0.0, 0.0, 1.0), 640.0), lamp, (0.0, -1.0, 0.0), act)


Scene = Callable[[World, int, np.random.Generator], Stage]
STAGES: dict[str, Scene] = {
    "bouncing": bouncing,
    "billiards": billiards,
    "box": box,
    "slope": slope,
    "juggling": juggling,
}


def _crowd(
    world: World,
    balls: int,
    radius: float,
    name: str,
    random: np.random.Generator,
    *,
    bounce: float,
    rolling: float = 0.004,
    marks: int = 2,
) -> list[Ball]:
    """Add equal balls, of a shade that the seed decides."""
    shade = random.uniform(0.88, 1.06) + random.normal(0.0, 0.025, 3)
    red, green, blue = (int(np.clip(each * part, 0, 255)) for each, part in zip(COLORS[name], shade, strict=True))
    shine = float(random.uniform(0.0, 0.6))
    made = []
    for _ in range(balls):
        skin = marked(random, (red, green, blue), int(random.integers(0, marks + 1)))
        made.append(world.ball(radius, skin, equal=True, bounce=bounce, rolling=rolling, shine=shine))
    return made


def _other(
    world: World, radius: float, name: str, random: np.random.Generator, *, bounce: float, rolling: float = 0.004
) -> Ball:
    """Add a ball that is not one of the crowd."""
    skin = marked(random, COLORS[name], 1)
    return world.ball(radius, skin, equal=False, bounce=bounce, rolling=rolling)


def _mixed(crowd: list[Ball], others: list[Ball], random: np.random.Generator) -> list[Ball]:
    """Put others among the crowd, which begins."""
    order = list(crowd)
    for each in others:
        order.insert(int(random.integers(1, len(order) + 1)), each)
    return order


def _spread(
    random: np.random.Generator, many: int, wide: float, deep: float, radius: float
) -> list[tuple[float, float]]:
    """Draw places that do not touch."""
    places: list[tuple[float, float]] = []
    while len(places) < many:
        x, y = float(random.uniform(-wide, wide)), float(random.uniform(-deep, deep))
        if all(math.hypot(x - u, y - v) > 2.5 * radius for u, v in places):
            places.append((x, y))
    return places


def _one(random: np.random.Generator, colors: tuple[Color, ...]) -> Color:
    return colors[int(random.integers(len(colors)))]


def _lamp(random: np.random.Generator, high: float) -> Lamp:
    place = (float(random.uniform(-9.0, 9.0)), float(random.uniform(-6.0, 8.0)), high)
    beam = (float(random.uniform(-6.0, 6.0)), float(random.uniform(-4.0, 5.0)), 0.0)
    direct, reach = float(random.uniform(0.4, 0.65)), float(random.uniform(7.0, 14.0))
    return Lamp(place, float(random.uniform(0.3, 2.0)), direct, reach, beam)
