"""A furnished room from a seed: walls, floor, window, posters, furniture."""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.sim.clips.balloon import Color
from matchset.sim.rendering.surface import Surface
from matchset.sim.scene import furniture
from matchset.sim.scene.furniture import FLOOR
from matchset.sim.scene.textures import Picture, Random, cloud, plain, planks, plaster, poster, texture, window

Array = npt.NDArray[np.float64]
HALF_WIDTH, BACK, BEHIND = 2.8, 6.4, -2.0  # geometry: m from the origin, a camera at rest
_DEPTH = BACK - BEHIND
# format: colors, BGR
_WALLS: tuple[Color, ...] = (
    (196, 216, 226),
    (178, 204, 196),
    (150, 176, 214),
    (186, 220, 232),
    (198, 202, 206),
    (178, 182, 218),
    (142, 166, 172),
)
# format: colors, BGR
_FLOORS: tuple[Color, ...] = ((96, 140, 178), (66, 98, 132), (128, 164, 190), (126, 132, 136))
_SCALE = 100  # geometry: px of texture per m


def room(rng: Random) -> list[Surface]:
    """Build a room around a camera that looks along +z.

    Parameters
    ----------
    rng : numpy.random.Generator
        Decides colors, furniture, and where things stand.

    Returns
    -------
    list of Surface
        Room frame: origin at the camera, x right, y down, z forward, m. No color in it is the balloon's blue.
    """
    feet, things = _furnish(rng)
    return [*_shell(rng, feet), *_decorate(rng), *things]


def darken_edges(picture: Picture, reach: float, depth: float) -> Picture:
    """Darken a picture in place toward its edges, like corners of a room; `reach` px, `depth` 0 ... 1."""
    height, width = picture.shape[:2]
    y, x = np.arange(height, dtype=np.float32), np.arange(width, dtype=np.float32)
    down = 1.0 - depth * (np.exp(-y / reach) + np.exp(-(height - 1 - y) / reach))
    across = 1.0 - depth * (np.exp(-x / reach) + np.exp(-(width - 1 - x) / reach))
    picture *= down[:, None, None] * across[None, :, None]
    return picture


def _glow(picture: Picture, x: float, y: float, reach: float, level: float) -> Picture:
    """Brighten a picture in place around (x, y), shares of its size; `reach` is a share of its width."""
    height, width = picture.shape[:2]
    across = np.exp(-(((np.arange(width, dtype=np.float32) / width - x) / reach) ** 2))
    down = np.exp(-(((np.arange(height, dtype=np.float32) / height - y) * height / width / reach) ** 2))
    picture *= 1.0 + level * down[:, None, None] * across[None, :, None]
    return picture


def _wall(rng: Random, length: float, color: Color) -> Picture:
    """Wall with a skirting board; `length` in m."""
    height, width = int(2 * FLOOR * _SCALE), int(length * _SCALE)
    wall = plaster(rng, height, width, color)
    skirting = int(0.11 * _SCALE)
    wall[-skirting:] = np.array((214, 220, 224), np.float32)
    wall[-skirting - 2 : -skirting] *= np.float32(0.7)
    return darken_edges(wall, 0.45 * _SCALE, 0.16)


def _floor(rng: Random, feet: list[tuple[float, float, float, float]]) -> Picture:
    """Floor with the shadows of what stands on it."""
    height, width = int(_DEPTH * _SCALE), int(2 * HALF_WIDTH * _SCALE)
    floor = planks(rng, height, width, _FLOORS[rng.integers(len(_FLOORS))], int(0.16 * _SCALE))
    if rng.random() < 0.7:
        _rug(rng, floor)
    floor *= cv2.resize(_floor_light(feet), (width, height))[..., None]
    return darken_edges(floor, 0.5 * _SCALE, 0.22)


def _floor_light(feet: list[tuple[float, float, float, float]]) -> Picture:
    """Light on the floor at 25 px per m: shadows under the furniture, sun below the window."""
    scale = 25.0
    height, width = int(_DEPTH * scale), int(2 * HALF_WIDTH * scale)
    shadow, lit = np.ones((height, width), np.float32), np.zeros((height, width), np.float32)
    for x, z, half_x, half_z in feet:
        left, top = (x - half_x + HALF_WIDTH) * scale, (BACK - z - half_z) * scale
        right, bottom = left + 2.0 * half_x * scale, top + 2.0 * half_z * scale
        shadow[max(int(top) - 1, 0) : int(bottom) + 3, max(int(left) - 1, 0) : int(right) + 4] = 0.42
    patch = np.array([(0.18, 0.14), (0.40, 0.18), (0.44, 0.33), (0.20, 0.28)]) * (width, height)
    cv2.fillPoly(lit, [patch.astype(np.int32)], 0.28)
    light: Picture = cv2.GaussianBlur(shadow, (0, 0), 0.1 * scale) * (1.0 + cv2.GaussianBlur(lit, (0, 0), 0.08 * scale))
    return light


def _rug(rng: Random, floor: Picture) -> None:
    """Lay a rug on a floor."""
    height, width = floor.shape[:2]
    rows, columns = int(0.24 * height), int(0.5 * width)
    colors = np.array(((70, 84, 158), (136, 160, 178), (90, 116, 104)), np.float32)
    mat = plain(rows, columns, tuple(colors[rng.integers(3)].tolist())) * (1.0 + 0.04 * cloud(rng, rows, columns, 3))
    for i, tone in enumerate((1.3, 0.7, 1.2)):
        inset = 6 + 12 * i
        cv2.rectangle(mat, (inset, inset), (columns - inset, rows - inset), (mat[0, 0] * tone).tolist(), 4)
    top, left = int(0.15 * height), int(0.25 * width)
    floor[top : top + rows, left : left + columns] = mat


def _shell(rng: Random, feet: list[tuple[float, float, float, float]]) -> list[Surface]:
    """Walls, floor and ceiling."""
    color = _WALLS[rng.integers(len(_WALLS))]
    accent = color if rng.random() < 0.5 else _WALLS[rng.integers(len(_WALLS))]
    x, y, width = np.array([2 * HALF_WIDTH, 0, 0]), np.array([0, 2 * FLOOR, 0]), 2 * HALF_WIDTH
    z = np.array([0.0, 0.0, _DEPTH])
    far = _glow(_wall(rng, width, accent), 0.35, 0.3, 0.4, 0.12) * np.float32(0.9)
    left, right = _wall(rng, _DEPTH, color) * np.float32(0.77), _wall(rng, _DEPTH, color) * np.float32(0.95)
    ceiling = darken_edges(plain(int(_DEPTH * 60), int(width * 60), (196, 202, 204)), 40.0, 0.16)
    ceiling = _glow(ceiling, 0.5, 0.3, 0.4, 0.12)
    cv2.rectangle(ceiling, (120, 130), (216, 170), (255.0, 255.0, 255.0), -1)
    corner = np.array([-HALF_WIDTH, -FLOOR, BACK])
    floor = texture(_floor(rng, feet))
    return [
        Surface(origin=corner, u=x, v=y, texture=texture(far)),
        Surface(origin=corner - z, u=z, v=y, texture=texture(left)),
        Surface(origin=corner + x, u=-z, v=y, texture=texture(right)),
        Surface(origin=corner + y, u=x, v=-z, texture=floor),
        Surface(origin=corner - z, u=x, v=z, texture=texture(ceiling[::-1])),
        Surface(origin=corner - z + x, u=-x, v=y, texture=texture(plain(8, 8, color))),
    ]


def _decorate(rng: Random) -> list[Surface]:
    """Window in the left wall, posters on the others."""
    start = rng.uniform(3.9, 4.5)
    pane = Surface(
        origin=np.array([-HALF_WIDTH + 0.02, -1.1, start]),
        u=np.array([0.0, 0.0, 1.7]),
        v=np.array([0.0, 1.6, 0.0]),
        texture=texture(window(300, 320)),
    )
    hung = [pane]
    for middle in (-1.7, 0.0, 1.7):
        tall, wide = rng.uniform(0.6, 1.0), rng.uniform(0.5, 1.1)
        at = np.array([middle + rng.uniform(-0.3, 0.3) - 0.5 * wide, rng.uniform(-1.4, -1.0), BACK - 0.03])
        hung += _hang(rng, at, np.array([wide, 0.0, 0.0]), tall)
    for near in (3.4, 5.0):
        tall, wide = rng.uniform(0.6, 1.0), rng.uniform(0.6, 1.0)
        at = np.array([HALF_WIDTH - 0.03, rng.uniform(-1.3, -0.8), near + rng.uniform(0.0, 0.5) + wide])
        hung += _hang(rng, at, np.array([0.0, 0.0, -wide]), tall)
    return hung


def _hang(rng: Random, at: Array, along: Array, tall: float) -> list[Surface]:
    """Hang a poster with its upper left corner at a position; `tall` in m."""
    wide = float(np.abs(along).sum())
    print_ = poster(rng, int(150 * tall), int(150 * wide))
    return [Surface(origin=at, u=along, v=np.array([0.0, tall, 0.0]), texture=texture(print_ * np.float32(0.92)))]


def _furnish(rng: Random) -> tuple[list[tuple[float, float, float, float]], list[Surface]]:
    """Return the footprints (x, z, half width, half depth; m) and the surfaces of the furniture."""
    big = [furniture.bookcase, furniture.sofa, furniture.table, furniture.cabinet]
    small = [furniture.cartons, furniture.plant, furniture.lamp, furniture.cartons]
    feet, things = [], []
    for i, choice in enumerate(rng.permutation(len(big))[:3]):
        place = (-1.85 + 1.85 * i + float(rng.uniform(-0.06, 0.06)), 5.75)
        things += big[choice](rng, place)
        feet.append((*place, 0.8, 0.45))
    order = rng.permutation(len(small))
    for i, place in enumerate(((-2.35, 4.9), (2.4, 4.6), (-0.95, 5.0), (0.95, 5.1))):
        if i < 2 or rng.random() < 0.5:
            things += small[order[i]](rng, place)
            feet.append((*place, 0.2, 0.2))
    return feet, things
