"""Things that stand in a room: bookcase, sofa, table, cabinet, cartons, plant, lamp."""

import math

import numpy as np
import numpy.typing as npt

from matchset.sim.clips.balloon import Color
from matchset.sim.rendering.surface import Surface
from matchset.sim.scene.textures import PAINTS, Picture, Random, books, cloud, framed, leaves, plain, texture, wood

Array = npt.NDArray[np.float64]
_TO_LIGHT = np.array([-0.48, -0.72, -0.5])  # geometry: direction to the room's light


def shade(normal: Array) -> float:
    """Brightness of a face under the room's soft light, 0.45 ... 1.1, from its unit normal."""
    return 0.58 + 0.52 * max(float(normal @ _TO_LIGHT), -0.25)


def cuboid(
    center: tuple[float, float, float],
    size: tuple[float, float, float],
    turn: float,
    skin: Picture,
    front: Picture | None = None,
) -> list[Surface]:
    """Build a box that stands upright.

    Parameters
    ----------
    center : tuple of 3 floats
        Middle of its bottom, room frame (y down), m.
    size : tuple of 3 floats
        Width, height and depth, m.
    turn : float
        Rotation about the vertical axis, rad.
    skin : ndarray of shape (h, w, 3), float32
        Picture on all faces.
    front : ndarray of shape (h, w, 3), float32, optional
        Another picture on the face toward -z.

    Returns
    -------
    list of Surface
        Front, back, left, right, top.
    """
    right = np.array([math.cos(turn), 0.0, math.sin(turn)])
    deep = np.array([-math.sin(turn), 0.0, math.cos(turn)])
    down = np.array([0.0, 1.0, 0.0])
    half_x, height, half_z = 0.5 * size[0], size[1], 0.5 * size[2]
    top = np.array(center) - height * down
    faces: list[Surface] = []
    for normal, along, reach, half in (
        (-deep, right, half_z, half_x),
        (deep, -right, half_z, half_x),
        (-right, -deep, half_x, half_z),
        (right, deep, half_x, half_z),
    ):
        picture = front if front is not None and not faces else skin
        fade = np.linspace(1.04, 0.86, picture.shape[0], dtype=np.float32)[:, None, None]
        faces.append(
            Surface(
                origin=top + reach * normal - half * along,
                u=2.0 * half * along,
                v=height * down,
                texture=texture(picture * (fade * np.float32(shade(normal)))),
            )
        )
    lid = texture(skin * np.float32(shade(-down)))
    faces.append(
        Surface(origin=top - half_x * right + half_z * deep, u=size[0] * right, v=-size[2] * deep, texture=lid)
    )
    return faces


FLOOR = 1.75  # geometry: m below the origin of the room frame, a camera at rest
# format: colors, BGR
_FABRICS: tuple[Color, ...] = ((64, 142, 186), (92, 124, 96), (128, 134, 138), (84, 92, 150), (166, 186, 198))
# format: colors, BGR
_WOODS: tuple[Color, ...] = ((84, 124, 164), (58, 86, 118), (150, 186, 212), (196, 206, 212))
Place = tuple[float, float]


def _fabric(rng: Random) -> Color:
    """Choose the color of a fabric."""
    return _FABRICS[rng.integers(len(_FABRICS))]


def _timber(rng: Random) -> Color:
    """Choose the color of a wood."""
    return _WOODS[rng.integers(len(_WOODS))]


def bookcase(rng: Random, place: Place) -> list[Surface]:
    """Bookcase full of books; `place` is x and z of the middle of its foot, m."""
    width, height = rng.uniform(1.2, 1.6), rng.uniform(1.7, 2.3)
    front = books(rng, int(150 * height), int(150 * width), int(height / 0.4))
    return cuboid((place[0], FLOOR, place[1]), (width, height, 0.35), 0.0, wood(rng, 80, 40, _timber(rng)), front)


def sofa(rng: Random, place: Place) -> list[Surface]:
    """Sofa with two cushions."""
    color = _fabric(rng)
    cloth = plain(60, 90, color) * (1.0 + 0.03 * cloud(rng, 60, 90, 4))
    x, z = place
    parts = cuboid((x, FLOOR, z), (1.6, 0.42, 0.85), 0.0, cloth)
    parts += cuboid((x, FLOOR, z + 0.36), (1.6, 0.86, 0.2), 0.0, cloth)
    for side in (-0.8, 0.8):
        parts += cuboid((x + side, FLOOR, z), (0.2, 0.62, 0.9), 0.0, cloth)
    for side in (-0.42, 0.38):
        pillow = plain(24, 24, PAINTS[rng.integers(len(PAINTS))])
        parts += cuboid((x + side, FLOOR - 0.42, z + 0.18), (0.42, 0.36, 0.14), float(rng.normal(0.0, 0.2)), pillow)
    return parts


def table(rng: Random, place: Place) -> list[Surface]:
    """Table on four legs with a few small things on it."""
    timber = wood(rng, 40, 120, _timber(rng))
    x, z = place
    parts = cuboid((x, FLOOR - 0.71, z), (1.5, 0.05, 0.8), 0.0, timber)
    for side in (-0.68, 0.68):
        for deep in (-0.34, 0.34):
            parts += cuboid((x + side, FLOOR, z + deep), (0.07, 0.71, 0.07), 0.0, timber)
    for i in range(5):
        size = (rng.uniform(0.08, 0.34), rng.uniform(0.05, 0.3), rng.uniform(0.1, 0.25))
        skin = framed(plain(30, 30, PAINTS[rng.integers(len(PAINTS))]), 2, (70.0, 74.0, 80.0))
        spot = (x - 0.6 + 0.3 * i, FLOOR - 0.76, z + float(rng.uniform(-0.22, 0.22)))
        parts += cuboid(spot, size, float(rng.uniform(-0.7, 0.7)), skin)
    return parts


def cabinet(rng: Random, place: Place) -> list[Surface]:
    """Low cabinet with drawers and a dark screen on top."""
    timber = wood(rng, 70, 160, _timber(rng))
    front = timber.copy()
    for i in range(3):
        for j in range(2):
            part = (slice(j * 35 + 3, j * 35 + 33), slice(i * 53 + 3, i * 53 + 51))
            front[part] = framed(np.ascontiguousarray(front[part]), 1, (50.0, 60.0, 70.0))
            front[j * 35 + 16 : j * 35 + 19, i * 53 + 22 : i * 53 + 32] = 60.0
    x, z = place
    screen = framed(plain(70, 120, (44.0, 42.0, 40.0)), 4, (18.0, 18.0, 18.0))
    screen[4:-4, 4:-4] += np.linspace(26.0, 0.0, 112, dtype=np.float32)[None, :, None]
    parts = cuboid((x, FLOOR, z), (1.6, 0.62, 0.42), 0.0, timber, front)
    return parts + cuboid((x, FLOOR - 0.62, z), (1.15, 0.66, 0.06), 0.0, plain(8, 8, (22.0, 22.0, 22.0)), screen)


def cartons(rng: Random, place: Place) -> list[Surface]:
    """Stack of two or three cardboard boxes with tape."""
    parts: list[Surface] = []
    level = FLOOR
    for i in range(int(rng.integers(2, 4))):
        skin = plain(50, 60, (104.0, 148.0, 186.0)) * np.float32(rng.uniform(0.85, 1.1))
        skin[:, 27:33] *= np.float32(1.16)
        skin[34:44, 8:20] = 70.0
        size = (rng.uniform(0.4, 0.62), rng.uniform(0.3, 0.46), rng.uniform(0.36, 0.5))
        parts += cuboid((place[0] + 0.05 * i, level, place[1]), size, float(rng.normal(0.0, 0.3)), skin)
        level -= size[1]
    return parts


def plant(rng: Random, place: Place) -> list[Surface]:
    """Potted plant; its leaves are one upright surface that faces the camera."""
    x, z = place
    pot = plain(30, 30, PAINTS[int(rng.integers(0, 3))]) * np.float32(0.8)
    parts = cuboid((x, FLOOR, z), (0.34, 0.36, 0.34), 0.3, pot)
    height = rng.uniform(0.9, 1.3)
    leafy = leaves(rng, 240, 200)
    origin = np.array([x - 0.5 * height * 0.85, FLOOR - 0.34 - height, z])
    along, down = np.array([0.85 * height, 0.0, 0.0]), np.array([0.0, height, 0.0])
    return [*parts, Surface(origin=origin, u=along, v=down, texture=leafy)]


def lamp(rng: Random, place: Place) -> list[Surface]:
    """Floor lamp with a bright shade."""
    x, z = place
    height = rng.uniform(1.5, 1.8)
    glow = plain(40, 40, (176.0, 226.0, 252.0)) * np.linspace(1.15, 0.95, 40, dtype=np.float32)[:, None, None]
    parts = cuboid((x, FLOOR, z), (0.3, 0.03, 0.3), 0.2, plain(8, 8, (60.0, 62.0, 66.0)))
    parts += cuboid((x, FLOOR - 0.03, z), (0.03, height, 0.03), 0.2, plain(8, 8, (60.0, 62.0, 66.0)))
    return parts + cuboid((x, FLOOR - height, z), (0.4, 0.32, 0.4), 0.35, glow)
