"""Other blue things, to mislead a tracker: posters, bars and rims, but never a filled disc."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.sim.rendering.surface import Surface
from matchset.sim.scene.room import BACK, HALF_WIDTH
from matchset.sim.scene.textures import Random, Texture


class ClutterParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Where blue things may hang.

    Parameters
    ----------
    tries : int
        Positions tried for a thing before it is left out.
    clear : float
        Distance between a hoop and anything else, in sums of their half-widths. More than 1: no hoop is filled by a
        card behind it, which would be a blue disc, and so a false target.
    """

    tries: int = 12
    clear: float = 1.1


PARAMETERS = ClutterParameters()


def clutter(rng: Random) -> list[Surface]:
    """Build blue cards, bars and hoops that hang between the furniture and the far wall.

    Parameters
    ----------
    rng : numpy.random.Generator
        Decides how many, which, and where.

    Returns
    -------
    list of Surface
        From far to near; their pictures have transparent parts. Nothing hangs before or behind a hoop: a hoop filled
        with a card is a blue disc in the picture, and there is to be none.
    """
    things: list[tuple[Texture, float, bool]] = []
    for kind, most in ((_card, 7), (_bar, 5), (_rim, 5)):
        things.extend((*kind(rng), kind is _rim) for _ in range(rng.integers(most // 2, most)))
    depths = np.sort(rng.uniform(4.2, BACK - 0.1, len(things)))[::-1]
    order = rng.permutation(len(things))
    hung: list[tuple[Surface, bool]] = []
    for i, depth in zip(order, depths, strict=True):
        picture, size, is_rim = things[i]
        for _ in range(PARAMETERS.tries):
            surface = _hang(rng, (picture, size), float(depth))
            if not any((is_rim or was_rim) and _overlap(surface, other) for other, was_rim in hung):
                hung.append((surface, is_rim))
                break
    return [surface for surface, _ in hung]


def _overlap(one: Surface, other: Surface) -> bool:
    """Whether the circles around two pictures overlap, seen from about the middle of the room."""
    places = []
    for surface in (one, other):
        middle = surface.origin + 0.5 * (surface.u + surface.v)
        half = 0.5 * float(np.linalg.norm(surface.v))
        places.append((middle[:2] / middle[2], half / middle[2]))
    (a, reach), (b, more) = places
    return bool(np.linalg.norm(a - b) < PARAMETERS.clear * (reach + more))


def _hang(rng: Random, thing: tuple[Texture, float], depth: float) -> Surface:
    """Hang a square picture with its side in m somewhere in the view, turned about the vertical axis."""
    picture, size = thing
    turn = rng.uniform(-0.6, 0.6)
    along = size * np.array([math.cos(turn), 0.0, math.sin(turn)])
    down = np.array([0.0, size, 0.0])
    reach = min(HALF_WIDTH, 0.58 * depth) - 0.3 * size
    middle = np.array([rng.uniform(-reach, reach), rng.uniform(-1.5, 1.3), depth])
    return Surface(origin=middle - 0.5 * (along + down), u=along, v=down, texture=picture)


def _ground(rng: Random, pixels: int) -> Texture:
    """Transparent square in some blue near the balloon's, a little darker toward one side."""
    blue = np.array((205.0, 72.0, 22.0)) * rng.uniform(0.55, 1.1) + rng.normal(0.0, 10.0, 3)
    ramp = np.linspace(1.08, 0.86, pixels)[:, None, None]
    square = np.zeros((pixels, pixels, 4), np.uint8)
    square[..., :3] = np.clip(blue * ramp, 0.0, 255.0)
    return square


def _stamp(square: Texture, corners: npt.ArrayLike) -> None:
    """Make a polygon of a transparent square opaque."""
    alpha = np.zeros(square.shape[:2], np.uint8)
    cv2.fillPoly(alpha, [np.round(np.asarray(corners) * 16.0).astype(np.int32)], 255, cv2.LINE_AA, 4)
    square[..., 3] = np.maximum(square[..., 3], alpha)


def _card(rng: Random) -> tuple[Texture, float]:
    """Rotated rectangle, 0.1 ... 0.9 m long; half of them with pale lines as of print."""
    pixels = 160
    square = _ground(rng, pixels)
    longer = 0.94 * pixels * rng.uniform(0.8, 1.0)
    size = (longer, longer * rng.uniform(0.45, 0.9))
    angle = float(rng.uniform(-90.0, 90.0))
    if rng.random() < 0.5:
        square[60:66, 45:115, :3] = 215
        square[78:84, 45:95, :3] = 215
    shrink = 1.0 / (abs(math.cos(math.radians(angle))) + abs(math.sin(math.radians(angle))))
    size = (size[0] * max(shrink, 0.75), size[1] * max(shrink, 0.75))
    _stamp(square, cv2.boxPoints(((79.5, 79.5), size, angle)))
    return square, float(np.exp(rng.uniform(math.log(0.16), math.log(1.0))))


def _bar(rng: Random) -> tuple[Texture, float]:
    """Rotated bar, 6 to 20 times longer than wide."""
    pixels = 240
    square = _ground(rng, pixels)
    longer = 0.95 * pixels
    _stamp(
        square,
        cv2.boxPoints(((119.5, 119.5), (longer, longer / rng.uniform(6.0, 20.0)), rng.uniform(-90.0, 90.0))),
    )
    return square, float(rng.uniform(0.4, 1.3))


def _rim(rng: Random) -> tuple[Texture, float]:
    """Hoop, circular or elliptic: outer radius 0.15 ... 0.5 m, its rim 10 to 35 % of that wide."""
    pixels = 240
    square = _ground(rng, pixels)
    outer = 0.47 * pixels
    ratio = 1.0 if rng.random() < 0.5 else rng.uniform(0.55, 0.95)
    angle = float(rng.uniform(0.0, 180.0))
    hole = 1.0 - rng.uniform(0.10, 0.35)
    alpha = np.zeros((pixels, pixels), np.uint8)
    for share, value in ((1.0, 255), (hole, 0)):
        cv2.ellipse(
            alpha,
            ((119.5, 119.5), (2.0 * outer * share, 2.0 * outer * ratio * share), angle),
            value,
            -1,
            cv2.LINE_AA,
        )
    square[..., 3] = alpha
    return square, float(rng.uniform(0.3, 1.0))
