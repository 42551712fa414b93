"""Equal balls on given paths before a camera at rest, with hands before them: `Crowd`, and what is `Seen` of it."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

import matchset as ms
from matchset.sim.analog_link import PRESETS, degrade
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.hand import HOLD
from matchset.sim.clips.multi_ball_clip import PositionFunction
from matchset.sim.clips.truth import sphere_outline
from matchset.sim.rendering.capsules import Capsule, draw_capsules
from matchset.sim.rendering.renderer import Picture, draw_balloon
from matchset.sim.rendering.shutter import fields, woven
from matchset.sim.scene.scene import Scene, viewpoint

Floats = npt.NDArray[np.float64]
Point = tuple[float, float, float]

CAMERA = ms.CameraModel.from_fov(640, 480, 1.25)
RADIUS = 0.14  # m, of a balloon
FPS = 30.0
MIN_VISIBLE = 0.3  # share of its disc from which a ball counts: what is hidden more may be answered, or not


class Limb(NamedTuple):
    """The hull of two spheres in skin color: centers and radii, camera frame, m."""

    begin: Point
    begin_radius: float
    end: Point
    end_radius: float

    def capsule(self) -> Capsule:
        """Project it into the picture, px."""
        ends = []
        for (x, y, z), radius in ((self.begin, self.begin_radius), (self.end, self.end_radius)):
            ends += [CAMERA.fx * x / z + CAMERA.cx, CAMERA.fy * y / z + CAMERA.cy, CAMERA.fx * radius / z]
        return Capsule(*ends)


LimbFunction = Callable[[float], list[Limb]]


class Seen(NamedTuple):
    """A ball in a frame.

    Parameters
    ----------
    identity : int
        Its number in the scene.
    circle : Circle
        Its outline, px, also where others hide it.
    visible : float
        Share of its disc that is in the picture and behind nothing.
    """

    identity: int
    circle: ms.Circle
    visible: float


class Crowd:
    """A scene: frames, and what is in each.

    Parameters
    ----------
    paths : sequence of callables
        From a time, s, to the center of each ball in the camera frame, m, or None while it is away.
    frames : int
    seed : int
        Decides room and noise.
    preset : str, optional
        "clean", "typical" or "bad".
    hands : sequence of callables, optional
        From a time, s, to the limbs of each hand: nearer than what it holds, and as far away as its first limb.
    radius : float, optional
        Of every ball, m.
    """

    def __init__(
        self,
        paths: Sequence[PositionFunction],
        frames: int,
        seed: int,
        preset: str = "typical",
        *,
        hands: Sequence[LimbFunction] = (),
        radius: float = RADIUS,
    ) -> None:
        self.paths, self.hands, self.radius = paths, hands, radius
        self.frames, self.seed, self.preset = frames, seed, preset

    def __iter__(self) -> Iterator[tuple[ms.Frame, list[Seen]]]:
        link = PRESETS[self.preset]
        background = Scene.room(self.seed).render(CAMERA, *viewpoint(self.seed))
        for index in range(self.frames):
            pictures = [self._draw(background, time / FPS) for _, time in fields(index, link.interlaced)]
            image = degrade(woven(pictures), link, 1_000_003 * self.seed + index)
            yield ms.Frame(image, index / FPS, index), self.truth(index / FPS)

    def truth(self, time: float) -> list[Seen]:
        """Say what is there at a time, s, in the order of the identities."""
        free = np.ones((CAMERA.height, CAMERA.width), bool)
        found = []
        for number, each in reversed(self._there(time)):
            if isinstance(each, list):
                _cover(free, each)
                continue
            circle = sphere_outline(CAMERA, each, self.radius).circle()
            left, top = (max(math.floor(middle - circle.radius), 0) for middle in (circle.x, circle.y))
            right, bottom = (max(math.ceil(middle + circle.radius) + 1, 0) for middle in (circle.x, circle.y))
            part = free[top:bottom, left:right]
            rows, columns = np.indices(part.shape)
            inside = np.hypot(columns + left - circle.x, rows + top - circle.y) < circle.radius
            found.append(Seen(number, circle, min(float((inside & part).sum()) / (math.pi * circle.radius**2), 1.0)))
            part &= ~inside
        return sorted(found)

    def _there(self, time: float) -> list[tuple[int, Floats | list[Limb]]]:
        """Balls, each with its number, and hands, the farthest first."""
        places = [path(time) for path in self.paths]
        there: list[tuple[float, int, Floats | list[Limb]]] = [
            (float(place[2]), number, np.array(place, float))
            for number, place in enumerate(places)
            if place is not None
        ]
        hands = [hand(time) for hand in self.hands]
        there += [(limbs[0].begin[2], -1 - number, limbs) for number, limbs in enumerate(hands)]
        return [(number, each) for _, number, each in sorted(there, key=lambda each: (-each[0], each[1]))]

    def _draw(self, background: Picture, time: float) -> Picture:
        """Draw all that is there at a time, s, the farthest first."""
        picture = background.copy()
        balloon = Balloon(radius=self.radius, marker_radius=0.0)
        for _, each in self._there(time):
            if isinstance(each, list):
                draw_capsules(picture, [[limb.capsule() for limb in each]], HOLD.color)
            else:
                draw_balloon(picture, CAMERA, balloon, each[np.newaxis])
        return picture


def _cover(free: npt.NDArray[np.bool_], limbs: list[Limb]) -> None:
    """Take from the pixels that are free those that limbs cover."""
    for limb in limbs:
        at = limb.capsule()
        most = max(at.r0, at.r1)
        left, right = max(int(min(at.x0, at.x1) - most), 0), max(int(max(at.x0, at.x1) + most) + 2, 0)
        top, bottom = max(int(min(at.y0, at.y1) - most), 0), max(int(max(at.y0, at.y1) + most) + 2, 0)
        part = free[top:bottom, left:right]
        rows, columns = np.indices(part.shape).astype(float)
        part &= ~at.covers(columns + left, rows + top)


def shared_area(one: float, other: float, far: float) -> float:
    """Area that two discs share, px^2.

    Parameters
    ----------
    one, other : float
        Their radii, px.
    far : float
        Distance of their centers, px.

    Returns
    -------
    float
    """
    a, b = sorted((one, other))
    if far >= a + b:
        return 0.0
    if far <= b - a:
        return math.pi * a * a
    u = (far * far + a * a - b * b) / (2.0 * far)
    v = far - u
    below = u * math.sqrt(max(a * a - u * u, 0.0)) + v * math.sqrt(max(b * b - v * v, 0.0))
    return a * a * math.acos(u / a) + b * b * math.acos(v / b) - below
