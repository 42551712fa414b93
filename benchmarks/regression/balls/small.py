"""Small fast balls that are followed from one click: `measure`.

`python -m benchmarks.regression.balls.small` shows what becomes of each click, picture by picture.
Sixteen scenes of each group: four radii, four speeds. Scenes of `TUNED` may be looked at while something is tuned;
figures are those of `REPORTED`, which nothing was tuned on.
"""

import math
import time
from collections.abc import Iterator
from typing import Annotated, Literal

import cv2
import msgspec
import numpy as np
import typer

import matchset as ms
from benchmarks.common.start import Image
from benchmarks.regression.balls.pictures import Ball, Camera, Color, Path, background
from benchmarks.regression.figures import INFORMATION, MEAN_SHARE, ROW, SOME, Figure
from benchmarks.tracking.trial import circle
from benchmarks.workers import one_thread

SECTION, ALL = "small balls", "all"
TUNED, REPORTED = 1000, 3000
"""Seeds of the first scenes of both groups."""
RADII_PX = (3.0, 4.0, 6.0, 8.0)
SPEEDS = (2.0, 5.0, 8.0, 12.0)
"""In radii a picture."""
SIZES = ((640, 480), (1280, 720))
BESIDE = ("nothing", "sticks", "resting twin", "one that touches it")
"""What has the color of the ball beside it."""
COLORS: tuple[Color, ...] = ((240.0, 240.0, 240.0), (30.0, 130.0, 250.0), (40.0, 230.0, 230.0), (40.0, 40.0, 220.0))
"""White, orange, yellow, red."""
TINTS: tuple[Color, ...] = ((0.8, 0.5, 0.35), (0.45, 0.6, 0.4), (0.55, 0.55, 0.6))
"""A blue table, a green field, gray."""
SHUTTERS = (0.5, 0.1)
"""Shares of the time between two pictures: a ball is a streak, or nearly sharp."""
PICTURES = 80
QUICK = (0, 6, 11, 13)
"""Scenes of the fast part: each radius, each speed, each of `BESIDE`, both motions and shutters, small pictures."""
RIGHT, RIGHT_PX = 0.5, 4.0
"""An answer is right with a center nearer than this to the ball's, in radii or px, whichever is more."""
FAR, FAR_PX = 3.0, 15.0
"""And wrong if it is farther than this."""
NOISE_PERCENT = 2.5
"""Two of 80 pictures."""
Kind = Literal["turns", "bounces"]


class Scene(msgspec.Struct, frozen=True):
    """A ball and what is around it.

    Parameters
    ----------
    seed : int
    radius : float
        px.
    speed : float
        Radii a picture.
    size : (int, int)
        Width and height, px.
    motion : str
        "turns": to and fro, turning round at each end. "bounces": on a floor, and at each end.
    beside : str
        One of `BESIDE`.
    shutter : float
        One of `SHUTTERS`.
    """

    seed: int
    radius: float
    speed: float
    size: tuple[int, int]
    motion: Kind
    beside: str
    shutter: float

    @property
    def name(self) -> str:
        """Its radius, its speed and what is around it."""
        around = "" if self.beside == BESIDE[0] else f", {self.beside}"
        drawn = f"shutter {self.shutter:g}, {self.size[1]} rows"
        return f"r {self.radius:g} px, {self.speed:g} r a picture, {self.motion}{around}, {drawn}"


class Outcome(msgspec.Struct, frozen=True):
    """What became of a click.

    Parameters
    ----------
    states : str
        A letter for each picture: "1" right, "o" neither right nor far, "x" far off, "." no answer.
    times : list of float
        Of the updates, s.
    """

    states: str
    times: list[float]


def scenes(first: int) -> list[Scene]:
    """List the scenes of a group: each radius with each speed, all else balanced over both.

    Parameters
    ----------
    first : int
        Seed of the first one: `TUNED` or `REPORTED`.
    """
    found: list[Scene] = []
    for i, radius in enumerate(RADII_PX):
        for j, speed in enumerate(SPEEDS):
            seed = first + len(found)
            size = SIZES[(i >> 1 ^ j) & 1]
            motion: Kind = "turns" if (i ^ j >> 1) & 1 == 0 else "bounces"
            shutter = SHUTTERS[(i ^ i >> 1 ^ j) & 1]
            found.append(Scene(seed, radius, speed, size, motion, BESIDE[i ^ j], shutter))
    return found


def there_and_back(way: float, length: float) -> float:
    """Place on a line after a way along it, turning round at its ends."""
    past = way % (2.0 * length)
    return min(past, 2.0 * length - past)


def path_of(scene: Scene, generator: np.random.Generator) -> Path:
    """Draw the path of a scene's ball."""
    width, height = scene.size
    speed_px, phase = scene.radius * scene.speed, float(generator.uniform(0.1, 0.6))
    left, across = 0.1 * width, 0.8 * width
    begin = phase * across
    middle, swing = height * float(generator.uniform(0.4, 0.6)), 0.08 * height

    def turning(time: float) -> tuple[float, float]:
        along = there_and_back(begin + speed_px * time, across)
        return left + along, middle + swing * math.cos(2.0 * math.pi * along / across)

    level, upward = 0.6 * speed_px, 0.8 * speed_px  # at the floor it has its full speed
    top = min(0.35 * height, 10.0 * upward)
    gravity, floor = 0.5 * upward**2 / top, 0.8 * height
    period = 2.0 * upward / gravity

    def bouncing(time: float) -> tuple[float, float]:
        along = there_and_back(begin + level * time, across)
        since = (time + phase * period) % period
        return left + along, floor - upward * since + 0.5 * gravity * since**2

    return turning if scene.motion == "turns" else bouncing


def touching(path: Path, radius: float, when: float) -> Path:
    """Return the path of a second ball, which comes toward the first one and touches it once.

    It is the first path turned by half a circle about the place where they meet, slower, and two radii beside.
    """
    before, meeting, after = (np.array(path(when + step)) for step in (-0.5, 0.0, 0.5))
    along = (after - before) / max(float(np.hypot(*(after - before))), 1e-9)
    aside = 2.0 * radius * np.array((-along[1], along[0]))

    def second(time: float) -> tuple[float, float]:
        x, y = meeting + aside - 0.6 * (np.array(path(time)) - meeting)
        return float(x), float(y)

    return second


def pictures(scene: Scene) -> Iterator[tuple[Image, tuple[float, float]]]:
    """Yield the pictures of a scene and where its ball is, px."""
    generator = np.random.default_rng(scene.seed)
    width, height = scene.size
    color, tint = COLORS[scene.seed % len(COLORS)], TINTS[scene.seed % len(TINTS)]
    image = background(generator, width, height, tint)
    path = path_of(scene, generator)
    balls = [Ball(path, scene.radius, color)]
    if scene.beside == "sticks":
        _lay_sticks(image, scene, generator, path(0.0)[1])
    elif scene.beside == "resting twin":
        place = _free(generator, width, path(0.0)[0]), _free(generator, height, path(0.0)[1])
        balls.append(Ball(lambda _: place, scene.radius, color))
    elif scene.beside == "one that touches it":
        balls.append(Ball(touching(path, scene.radius, float(generator.integers(25, 45))), scene.radius, color))
    camera = Camera(image, generator, exposure=scene.shutter)
    for number in range(PICTURES):
        yield camera.take(float(number), balls), path(float(number))


def _free(generator: np.random.Generator, length: int, taken: float) -> float:
    """Draw a place along a side of the picture, a tenth of the side from a place where the click will be."""
    while True:
        place = float(generator.uniform(0.2, 0.8)) * length
        if abs(place - taken) > 0.1 * length:
            return place


def _lay_sticks(image: Image, scene: Scene, generator: np.random.Generator, clicked: float) -> None:
    """Draw lines of a ball's color across a background: one down, one across, and short ones.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
    scene : Scene
    generator : Generator
    clicked : float
        Row of the click, px: the line across does not lie there.
    """
    width, height = scene.size
    color, thick = COLORS[scene.seed % len(COLORS)], max(2, round(1.2 * scene.radius))
    down, across = int(generator.uniform(0.75, 0.85) * width), int(_free(generator, height, clicked))
    cv2.line(image, (down, 0), (down, height), color, thick)
    cv2.line(image, (0, across), (width, across), color, thick)
    for _ in range(6):
        x, y = int(generator.integers(0, width)), int(generator.integers(0, height))
        angle, length = generator.uniform(0.0, math.pi), scene.radius * generator.uniform(4.0, 12.0)
        end = round(x + length * math.cos(angle)), round(y + length * math.sin(angle))
        cv2.line(image, (x, y), end, color, thick)


def follow(scene: Scene) -> Outcome:
    """Click at the ball in the first picture, and follow it to the last."""
    states, times, tracker = "", list[float](), None
    for number, (image, (x, y)) in enumerate(pictures(scene)):
        try:
            tracker = tracker or ms.Tracker(ms.Circle, ms.ColorModel.pick(image, x, y), start=(x, y))
        except ValueError:  # the click is refused
            return Outcome("." * PICTURES, [])
        frame = ms.Frame(image, number / 30.0, number)
        begin = time.perf_counter()
        answer = tracker.update(frame)
        times.append(time.perf_counter() - begin)
        states += "." if isinstance(answer, ms.Lost) else state_of(circle(answer.shape), (x, y), scene.radius)
    return Outcome(states, times)


def state_of(answer: tuple[float, float, float], truth: tuple[float, float], radius: float) -> str:
    """Judge an answer by its center: "1" right, "x" far off, "o" neither."""
    away = math.hypot(answer[0] - truth[0], answer[1] - truth[1])
    if away < max(RIGHT * radius, RIGHT_PX):
        return "1"
    return "x" if away > max(FAR * radius, FAR_PX) else "o"


def measure(quick: bool = False) -> list[Figure]:
    """Follow the balls of the reported scenes, or of some with `quick`."""
    every = scenes(REPORTED)
    chosen = [every[number] for number in QUICK] if quick else every
    found = {scene.name: follow(scene) for scene in chosen}
    figures = [figure for name, outcome in found.items() for figure in _figures(name, outcome)]
    return figures if quick else [*figures, *_all(list(found.values()))]


def _percent(outcome: Outcome) -> float:
    return 100.0 * outcome.states.count("1") / PICTURES


def _figures(name: str, outcome: Outcome) -> list[Figure]:
    where = SECTION, name
    return [
        Figure.of(where, "right, %", _percent(outcome), ROW, noise=NOISE_PERCENT),
        Figure.of(where, "wrong", outcome.states.count("x"), SOME),
    ]


def _all(outcomes: list[Outcome]) -> list[Figure]:
    where, times = (SECTION, ALL), [each for outcome in outcomes for each in outcome.times]
    slow = 1e3 * float(np.quantile(times, 0.99)) if times else None
    return [
        Figure.of(where, "right, %", float(np.mean([_percent(each) for each in outcomes])), MEAN_SHARE),
        Figure.of(where, "wrong", sum(each.states.count("x") for each in outcomes), SOME),
        Figure.of(where, "update 99 %, ms", slow, INFORMATION),
    ]


def main(
    group: Annotated[str, typer.Option(help="tuned or reported.")] = "tuned",
    only: Annotated[str, typer.Option(help="Numbers of scenes, with commas; empty: all.")] = "",
) -> None:
    """Show what becomes of each click: 1 right, o off, x far off, . no answer."""
    one_thread()
    every = scenes({"tuned": TUNED, "reported": REPORTED}[group])
    numbers = [int(each) for each in only.split(",")] if only else range(len(every))
    outcomes = []
    for number in numbers:
        outcomes.append(follow(every[number]))
        slow = 1e3 * float(np.quantile(outcomes[-1].times or [0.0], 0.99))
        typer.echo(f"{number} {every[number].name}: {_percent(outcomes[-1]):.1f} %, 99 % {slow:.1f} ms")
        typer.echo(f"  {outcomes[-1].states}")
    for figure in _all(outcomes):
        typer.echo(f"{figure.name}: {figure.value:.2f}")


if __name__ == "__main__":
    typer.run(main)
