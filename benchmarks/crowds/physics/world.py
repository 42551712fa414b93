"""Bodies in pybullet: `World`, `Ball`. Lengths in dm, times in s."""

import math
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType, TracebackType
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Color = tuple[int, int, int]  # sRGB
Point = tuple[float, float, float]

RATE = 600  # steps a second
GRAVITY = 98.1  # dm/s^2
AWAY = -300.0  # dm, height of balls that wait
FINENESS = 3  # times that an icosahedron's triangles are divided into four
RESTING = 1.0  # dm/s, approach below which nothing bounces


def engine() -> ModuleType:
    """Import pybullet.

    Raises
    ------
    ImportError
        If it is not installed.
    """
    try:
        return import_module("pybullet")
    except ImportError as error:
        raise ImportError("crowds with physics need pybullet: pip install pybullet") from error


@dataclass
class Ball:
    """A ball in a world.

    Parameters
    ----------
    body : int
        Its number in the engine.
    radius : float
        In dm.
    equal : bool
        Whether it is one of the crowd; others only distract.
    shine : float
        How bright it mirrors the lamp.
    identity : int or None
        Its name while it is there; None while it is away, and of others.
    """

    body: int
    radius: float
    equal: bool
    shine: float = 0.0
    identity: int | None = None


class World:
    """An engine of its own, with its meshes and pictures in a temporary folder; used as a context manager."""

    def __init__(self) -> None:
        self.engine = engine()
        self.client: int = self.engine.connect(self.engine.DIRECT)
        self.balls: list[Ball] = []
        self.names = 0
        self._folder = tempfile.TemporaryDirectory()
        self._files = 0
        self._sphere = self._write_sphere()
        self.engine.setPhysicsEngineParameter(
            fixedTimeStep=1.0 / RATE,
            numSolverIterations=60,
            deterministicOverlappingPairs=1,
            restitutionVelocityThreshold=RESTING,
            physicsClientId=self.client,
        )
        self.pull((0.0, 0.0, -GRAVITY))

    def __enter__(self) -> "World":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.engine.disconnect(physicsClientId=self.client)
        self._folder.cleanup()

    def pull(self, gravity: Point) -> None:
        """Set gravity, dm/s^2."""
        self.engine.setGravity(*gravity, physicsClientId=self.client)

    def step(self) -> None:
        """Go on by one step."""
        self.engine.stepSimulation(physicsClientId=self.client)

    def ball(
        self, radius: float, texture: Bytes, *, equal: bool, bounce: float, rolling: float = 0.004, shine: float = 0.4
    ) -> Ball:
        """Add a ball, away for now.

        Parameters
        ----------
        radius : float
        texture : (rows, columns, 3) uint8
            Blue, green, red, around it.
        equal : bool
        bounce : float
            Coefficient of restitution.
        rolling : float, optional
            Coefficient of rolling friction per radius.
        shine : float, optional
            How bright it mirrors the lamp, 1 = white.
        """
        visual = self.engine.createVisualShape(
            self.engine.GEOM_MESH,
            fileName=self._sphere,
            meshScale=[radius] * 3,
            rgbaColor=[1, 1, 1, 1],
            physicsClientId=self.client,
        )
        shape = self.engine.createCollisionShape(self.engine.GEOM_SPHERE, radius=radius, physicsClientId=self.client)
        body = self._body(visual, shape, (0.0, 5.0 * len(self.balls), AWAY), mass=0.1, texture=texture)
        self._surface(body, bounce, 0.3, rolling * radius)
        made = Ball(body, radius, equal, shine)
        self.balls.append(made)
        return made

    def sheet(self, corner: Point, along: Point, across: Point, texture: Bytes) -> int:
        """Add a flat picture without thickness: from a corner, along the columns and the rows of its texture."""
        path = self._path("obj")
        parts = 12
        rows = []
        normal = np.cross(np.array(along), np.array(across))
        normal = normal / np.linalg.norm(normal)
        for v in range(parts + 1):
            for u in range(parts + 1):
                place = np.array(corner) + np.array(along) * (u / parts) + np.array(across) * (v / parts)
                rows.append("v {:.6f} {:.6f} {:.6f}".format(*place))
        for v in range(parts + 1):
            rows += [f"vt {u / parts:.6f} {v / parts:.6f}" for u in range(parts + 1)]
        rows.append("vn {:.6f} {:.6f} {:.6f}".format(*normal))
        for v in range(parts):
            for u in range(parts):
                a = v * (parts + 1) + u + 1
                b, c, d = a + 1, a + parts + 2, a + parts + 1
                rows += [f"f {a}/{a}/1 {b}/{b}/1 {c}/{c}/1", f"f {a}/{a}/1 {c}/{c}/1 {d}/{d}/1"]
        path.write_text("\n".join(rows) + "\n", encoding="ascii")
        visual = self.engine.createVisualShape(
            self.engine.GEOM_MESH,
            fileName=str(path),
            rgbaColor=[1, 1, 1, 1],
            physicsClientId=self.client,
        )
        return self._body(visual, -1, (0.0, 0.0, 0.0), mass=0.0, texture=texture)

    def block(self, center: Point, half: Point, texture: Bytes | None, *, bounce: float = 0.8) -> int:
        """Add a fixed box; without a texture it is not seen."""
        shape = self.engine.createCollisionShape(
            self.engine.GEOM_BOX, halfExtents=list(half), physicsClientId=self.client
        )
        seen = texture is not None  # the engine would draw the shape of a body that has no other look
        visual = self.engine.createVisualShape(
            self.engine.GEOM_BOX,
            halfExtents=list(half) if seen else [0.001] * 3,
            visualFramePosition=[0.0, 0.0, 0.0 if seen else AWAY],
            rgbaColor=[1, 1, 1, 1],
            physicsClientId=self.client,
        )
        body = self._body(visual, shape, center, mass=0.0, texture=texture)
        self._surface(body, bounce, 0.5, 0.0)
        return body

    def peg(self, center: Point, radius: float, height: float, color: Color) -> int:
        """Add a fixed upright cylinder."""
        shape = self.engine.createCollisionShape(
            self.engine.GEOM_CYLINDER, radius=radius, height=height, physicsClientId=self.client
        )
        visual = self.engine.createVisualShape(
            self.engine.GEOM_CYLINDER,
            radius=radius,
            length=height,
            rgbaColor=[*(each / 255.0 for each in color), 1],
            physicsClientId=self.client,
        )
        body = self._body(visual, shape, center, mass=0.0, texture=None)
        self._surface(body, 0.7, 0.3, 0.0)
        return body

    def limb(self, radius: float, length: float, texture: Bytes) -> int:
        """Add a long rounded body that touches nothing: what `place` moves."""
        visual = self.engine.createVisualShape(
            self.engine.GEOM_MESH,
            fileName=self._sphere,
            meshScale=[radius, radius, length / 2.0],
            rgbaColor=[1, 1, 1, 1],
            physicsClientId=self.client,
        )
        return self._body(visual, -1, (0.0, 0.0, AWAY), mass=0.0, texture=texture)

    def place(self, body: int, where: Point, turn: Point = (0.0, 0.0, 0.0), speed: Point = (0.0, 0.0, 0.0)) -> None:
        """Put a body somewhere, turned by angles about x, y, z, with a velocity, dm/s."""
        quaternion = self.engine.getQuaternionFromEuler(list(turn))
        self.engine.resetBasePositionAndOrientation(body, list(where), quaternion, physicsClientId=self.client)
        self.engine.resetBaseVelocity(body, list(speed), [0.0, 0.0, 0.0], physicsClientId=self.client)

    def throw(self, ball: Ball, where: Point, speed: Point, spin: Point = (0.0, 0.0, 0.0)) -> None:
        """Let a ball go somewhere; one of the crowd that was away gets a new name."""
        if ball.equal and ball.identity is None:
            ball.identity = self.names
            self.names += 1
        self.place(ball.body, where, spin, speed)
        self.engine.resetBaseVelocity(ball.body, list(speed), list(spin), physicsClientId=self.client)

    def kick(self, ball: Ball, speed: Point) -> None:
        """Give a ball a velocity, dm/s."""
        self.engine.resetBaseVelocity(ball.body, list(speed), [0.0, 0.0, 0.0], physicsClientId=self.client)

    def put_away(self, ball: Ball) -> None:
        """Take a ball out of the scene."""
        ball.identity = None
        self.place(ball.body, (0.0, 5.0 * self.balls.index(ball), AWAY))

    def center(self, ball: Ball) -> Floats:
        """Return where a ball is."""
        return np.array(self.engine.getBasePositionAndOrientation(ball.body, physicsClientId=self.client)[0])

    def there(self, ball: Ball) -> bool:
        """Whether a ball is in the scene."""
        return bool(self.center(ball)[2] > AWAY / 2.0)

    @contextmanager
    def emptied(self) -> Iterator[None]:
        """Take all balls away for a moment."""
        state = self.engine.saveState(physicsClientId=self.client)
        for number, ball in enumerate(self.balls):
            self.place(ball.body, (0.0, 5.0 * number, AWAY))
        yield
        self.engine.restoreState(state, physicsClientId=self.client)
        self.engine.removeState(state, physicsClientId=self.client)

    def no_touch(self) -> None:
        """Let balls pass each other."""
        for number, one in enumerate(self.balls):
            for other in self.balls[:number]:
                self.engine.setCollisionFilterPair(one.body, other.body, -1, -1, 0, physicsClientId=self.client)

    def _body(self, visual: int, shape: int, where: Point, *, mass: float, texture: Bytes | None) -> int:
        body: int = self.engine.createMultiBody(mass, shape, visual, list(where), physicsClientId=self.client)
        if texture is not None:
            path = self._path("png")
            cv2.imwrite(str(path), texture)
            number: Any = self.engine.loadTexture(str(path), physicsClientId=self.client)
            self.engine.changeVisualShape(body, -1, textureUniqueId=number, physicsClientId=self.client)
        return body

    def _surface(self, body: int, bounce: float, friction: float, rolling: float) -> None:
        self.engine.changeDynamics(
            body,
            -1,
            restitution=bounce,
            lateralFriction=friction,
            rollingFriction=rolling,
            spinningFriction=rolling,
            linearDamping=0.0,
            angularDamping=0.0,
            physicsClientId=self.client,
        )

    def _path(self, suffix: str) -> Path:
        self._files += 1
        return Path(self._folder.name) / f"{self._files}.{suffix}"

    def _write_sphere(self) -> str:
        """Write a unit sphere with smooth normals; say where."""
        corners, faces = _icosphere(FINENESS)
        rows = ["v {:.6f} {:.6f} {:.6f}".format(*each) for each in corners]
        rows += [f"vt {0.5 + math.atan2(y, x) / math.tau:.6f} {0.5 + 0.5 * z:.6f}" for x, y, z in corners]
        rows += ["vn {:.6f} {:.6f} {:.6f}".format(*each) for each in corners]
        rows += ["f " + " ".join(f"{each + 1}/{each + 1}/{each + 1}" for each in face) for face in faces]
        path = self._path("obj")
        path.write_text("\n".join(rows) + "\n", encoding="ascii")
        return str(path)


def _icosphere(times: int) -> tuple[list[Floats], list[tuple[int, int, int]]]:
    """Return corners and triangles of an icosahedron, each triangle divided into four some times."""
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    raw: list[tuple[float, float, float]] = [(a, b * golden, 0.0) for b in (1, -1) for a in (-1, 1)]
    raw += [(0.0, a, b * golden) for b in (1, -1) for a in (-1, 1)]
    raw += [(b * golden, 0.0, a) for b in (1, -1) for a in (-1, 1)]
    corners = [np.array(each) / math.hypot(*each) for each in raw]
    faces = []
    for a in range(12):
        for b in range(a + 1, 12):
            for c in range(b + 1, 12):
                sides = [corners[a] - corners[b], corners[b] - corners[c], corners[c] - corners[a]]
                if max(float(np.linalg.norm(side)) for side in sides) < 1.1:
                    outward = float(np.dot(np.cross(corners[b] - corners[a], corners[c] - corners[a]), corners[a]))
                    faces.append((a, b, c) if outward > 0.0 else (a, c, b))
    for _ in range(times):
        middles: dict[tuple[int, int], int] = {}
        finer = []
        for face in faces:
            between = []
            for one, other in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0])):
                key = (min(one, other), max(one, other))
                if key not in middles:
                    middle = corners[one] + corners[other]
                    middles[key] = len(corners)
                    corners.append(middle / np.linalg.norm(middle))
                between.append(middles[key])
            d, e, f = between
            finer += [(face[0], d, f), (face[1], e, d), (face[2], f, e), (d, e, f)]
        faces = finer
    return corners, faces
