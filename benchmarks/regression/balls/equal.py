"""Two equal red balls, and a blue one that passes before one of them: `measure`.

One click into one of six pictures. The ball that was clicked at is followed to the end, never the other one.
"""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

import matchset as ms
from benchmarks.common.start import Image
from benchmarks.regression.balls.pictures import Ball, Camera, Color, background
from benchmarks.regression.figures import MEAN_SHARE, QUANTILE, SOME, Figure
from benchmarks.tracking.trial import circle
from matchset.app.track.score import Circle3

SECTION, ALL = "equal balls", "all"
SEED = 3
WIDTH, HEIGHT = 1280, 720
FPS = 30
PICTURES = 150
STARTS = (0, 10, 20, 30, 45, 60)
"""Pictures of the clicks."""
TINT: Color = (0.55, 0.75, 0.8)
RED: Color = (25.0, 64.0, 242.0)
BLUE: Color = (230.0, 77.0, 25.0)
NOISE, QUALITY = 5.0, 80
"""Standard deviation of the noise, gray levels, and quality of the JPEG coding, in percent."""
RIGHT = 0.5
"""An answer is right with a center nearer than so many radii of the ball to the ball's center."""
FAR = 2.0
"""And wrong if it is farther than so many."""


class Seen(msgspec.Struct, frozen=True):
    """A picture, and the ball that is clicked at in it.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
    truth : (float, float, float)
        Center and radius, px.
    """

    image: Image
    truth: Circle3


def clicked(time: float) -> Circle3:
    """Center and radius of the ball that is clicked at, at a time in s, px: it comes and goes."""
    return 200.0 + 180.0 * time, 360.0 - 250.0 * math.sin(2.2 * time), 45.0 + 20.0 * math.sin(1.1 * time)


def other(time: float) -> Circle3:
    """Center and radius of its twin, px."""
    return 1050.0 - 150.0 * time, 300.0 + 200.0 * math.cos(1.7 * time), 40.0


def passing(time: float) -> Circle3:
    """Center and radius of the blue ball, px: it is nearer to the camera than both."""
    return 600.0 + 100.0 * math.sin(time), 500.0, 38.0


def pictures(count: int = PICTURES) -> list[Seen]:
    """Draw the first pictures."""
    generator = np.random.default_rng(SEED)
    image = background(generator, WIDTH, HEIGHT, TINT, clutter=25)
    camera = Camera(image, generator, NOISE, exposure=0.0, quality=QUALITY)
    seen = []
    for number in range(count):
        circles = [each(number / FPS) for each in (clicked, other, passing)]
        balls = [_ball(each, color) for each, color in zip(circles, (RED, RED, BLUE), strict=True)]
        seen.append(Seen(camera.take(float(number), balls), circles[0]))
    return seen


def _ball(place: Circle3, color: Color) -> Ball:
    x, y, radius = place
    return Ball(lambda _: (x, y), radius, color, shaded=True)


def follow(seen: Sequence[Seen], start: int) -> str:
    """Click at the ball in a picture, and follow it to the last.

    Parameters
    ----------
    seen : sequence of Seen
    start : int
        Number of the picture.

    Returns
    -------
    str
        A letter for each picture from there on: "1" right, "o" neither right nor far, "x" far off, "." no answer.
    """
    first = seen[start]
    x, y, _ = first.truth
    try:
        tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(first.image, x, y), start=(x, y))
    except ValueError:  # the click is refused
        return "." * (len(seen) - start)
    states = ""
    for number, each in enumerate(seen[start:], start):
        answer = tracker.update(ms.Frame(each.image, number / FPS, number))
        states += "." if isinstance(answer, ms.Lost) else state_of(circle(answer.shape), each.truth)
    return states


def state_of(answer: Circle3, truth: Circle3) -> str:
    """Judge an answer by its center: "1" right, "x" far off, "o" neither."""
    radii = math.hypot(answer[0] - truth[0], answer[1] - truth[1]) / truth[2]
    if radii < RIGHT:
        return "1"
    return "x" if radii > FAR else "o"


def measure() -> list[Figure]:
    """Follow the ball from each of the clicks."""
    seen = pictures()
    found = {start: follow(seen, start) for start in STARTS}
    figures = [figure for start, states in found.items() for figure in figures_of(f"from picture {start}", states)]
    every = "".join(found.values())
    least = min(_percent(states) for states in found.values())
    return [*figures, *figures_of(ALL, every), Figure.of((SECTION, ALL), "least right, %", least, QUANTILE)]


def figures_of(name: str, states: str) -> list[Figure]:
    """Name the numbers of a click, or of all of them."""
    where = SECTION, name
    return [
        Figure.of(where, "right, %", _percent(states), MEAN_SHARE, noise=2.0 if name != ALL else None),
        Figure.of(where, "wrong", states.count("x"), SOME),
        Figure.of(where, "lost", states.count("."), SOME),
    ]


def _percent(states: str) -> float:
    return 100.0 * states.count("1") / len(states)
