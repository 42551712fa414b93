"""Kernels that find and draw what an `Eye` sees of the others: the window that holds them, and their balls."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.sim.rendering.background import Words
from matchset.sim.rendering.coverage import draw_sphere_on_words

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

REACH = 0.2  # m, radius of the sphere that a vehicle without its ball fills
MARGIN = 4  # px around a window
NEAREST = 0.12  # m, nothing nearer to the lens than that is drawn of vehicles
TALL = 0.19  # m from a vehicle's center of mass to its ball's, along which `Look.above` is measured
TOP = 0.05  # m, radius of the sphere at the upper end of what is above a ball
BESIDE = 0.05  # m, a ball must be so far before the lens to be drawn
MARKER, BETWEEN, EYE_DEPTH = 6, 16, 19  # places in `matchset.sim.rendering.renderer.appearance`
LIGHT = 10


@kernel
def window_of(
    places: Floats,
    balls: Floats,
    looks: Floats,
    radius: float,
    lens: Floats,
    place: Floats,
    back: Floats,
    size: Ints,
    box: Ints,
) -> bool:
    """Write left, top, right, bottom of the part of a picture that shows vehicles, on even columns; False if none.

    Parameters
    ----------
    places, balls : (n, 3)
        Of the vehicles, m, in the room.
    looks : (n, 2)
        How far they reach above the ball and below the center of mass, m.
    radius : float
        Of the balls, m.
    lens : (4,)
        fx, fy, cx, cy of the pinhole, px.
    place, back : (3,), (3, 3)
        Where the camera is, and the rotation from the room to it.
    size : (2,)
        Width and height of its picture, px.
    box : (4,), written
    """
    ends = np.array((math.inf, math.inf, -math.inf, -math.inf))
    center = np.empty(3)
    for k in range(places.shape[0]):
        above, below = looks[k, 0], looks[k, 1]
        _take_in(places[k], max(REACH, below), lens, place, back, ends)
        _take_in(balls[k], radius, lens, place, back, ends)
        if above > 0.0:
            for j in range(3):
                center[j] = balls[k, j] + above / TALL * (balls[k, j] - places[k, j])
            _take_in(center, TOP, lens, place, back, ends)
    if not (ends[2] >= ends[0] and ends[3] >= ends[1]):
        return False
    for j in range(2):
        low, high = min(max(ends[j], -1e6), 1e6), min(max(ends[2 + j], -1e6), 1e6)
        box[j] = max(math.floor(low) - MARGIN, 0)
        box[2 + j] = min(math.ceil(high) + MARGIN, size[j])
    box[0] -= box[0] % 2
    box[2] -= box[2] % 2
    wide, tall = box[2] - box[0] > 2, box[3] - box[1] > 2
    return bool(wide and tall)


@kernel
def _take_in(center: Floats, radius: float, lens: Floats, place: Floats, back: Floats, ends: Floats) -> None:
    """Widen the ends (left, top, right, bottom) of a window by a sphere, unless it is behind the camera."""
    away = np.empty(3)
    for j in range(3):
        away[j] = 0.0
        for i in range(3):
            away[j] += back[j, i] * (center[i] - place[i])
    z = away[2]
    if z < NEAREST:
        return
    reach = radius / max(z - radius, NEAREST)
    for j in range(2):
        at, wide = lens[2 + j] + lens[j] * (away[j] / z), lens[j] * reach * (1.0 + abs(away[j] / z))
        ends[j], ends[2 + j] = min(ends[j], at - wide), max(ends[2 + j], at + wide)


@kernel
def draw_ball(
    patch: Words, lens: Floats, place: Floats, back: Floats, ball: Floats, turn: Floats, radius: float, looks: Floats
) -> None:
    """Draw a vehicle's ball, its marker backward, over a picture.

    Parameters
    ----------
    patch : (h, w), written
        Pixels as words, B in the lowest byte.
    lens : (4,)
        fx, fy, cx, cy of the pinhole, px.
    place, back : (3,), (3, 3)
        Where the camera is, and the rotation from the room to it.
    ball, turn : (3,), (3, 3)
        Center of the ball in the room, and the rotation of its vehicle to the room.
    radius : float
        m.
    looks : (20,)
        `matchset.sim.rendering.renderer.appearance` of the ball, but for what depends on where it is.
    """
    center, marker, look = np.zeros(3), np.zeros(3), looks.copy()
    for j in range(3):
        for i in range(3):
            center[j] += back[j, i] * (ball[i] - place[i])
            marker[j] -= back[j, i] * turn[i, 2]
    if center[2] < radius + BESIDE:
        return  # beside or behind the camera
    far, long = _length(center), _length(marker)
    for j in range(3):
        look[MARKER + j] = marker[j] / long
        look[BETWEEN + j] = look[LIGHT + j] - center[j] / far
    between = max(_length(look[BETWEEN : BETWEEN + 3]), 1e-9)
    for j in range(3):
        look[BETWEEN + j] /= between
    look[EYE_DEPTH] = center[2] / far
    draw_sphere_on_words(patch, lens, center, radius, look)


@kernel
def _length(v: Floats) -> float:
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
