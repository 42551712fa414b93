"""Pictures of a world, and where its balls are in them: `Camera`, `Lamp`, `View`. Pixel centers are at integers."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.crowds.crowd import Seen
from benchmarks.crowds.physics.world import Ball, Floats, Point, World

Light = npt.NDArray[np.float32]

WIDTH, HEIGHT = 640, 480
CX, CY = WIDTH / 2.0, HEIGHT / 2.0 - 1.0  # where TinyRenderer draws the axis, measured at spheres at rest
NEAR, FAR = 2.0, 120.0  # dm
GAMMA = 2.2  # of TinyRenderer's colors, taken for those of a display
SPOT = 0.22  # size of the lamp's mirror image on a ball, in its radius
COARSE = 2  # px, of the grid on which shadows are found
JITTER = ((0.25, -0.125), (-0.25, 0.375), (0.0, 0.0), (-0.375, -0.25), (0.375, 0.0))  # px, of the parts of an exposure


class Camera(NamedTuple):
    """A camera at rest.

    Parameters
    ----------
    eye, target : (float, float, float)
        Where it is, and what is in the middle of its picture.
    focal : float
        Focal length, px.
    """

    eye: Point
    target: Point
    focal: float

    def rotation(self) -> Floats:
        """Return rows right, down, forward."""
        forward = np.array(self.target) - np.array(self.eye)
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, (0.0, 0.0, 1.0))
        right = right / np.linalg.norm(right)
        return np.array([right, np.cross(forward, right), forward])

    def circle(self, center: Floats, radius: float) -> ms.Circle | None:
        """Return the circle closest to the outline of a sphere; None behind the camera.

        The outline is an ellipse: the circle has its center, and the same area.
        """
        place = self.rotation() @ (center - np.array(self.eye))
        if place[2] < NEAR:
            return None
        dual = np.outer(place, place) / radius**2 - np.eye(3)  # of the tangent cone
        middle = dual[:2, 2] / dual[2, 2]
        shape = np.outer(middle, middle) - dual[:2, :2] / dual[2, 2]
        size = math.sqrt(math.sqrt(float(np.linalg.det(shape))))
        return ms.Circle(self.focal * middle[0] + CX, self.focal * middle[1] + CY, self.focal * size)


class Lamp(NamedTuple):
    """A lamp above a scene.

    Parameters
    ----------
    place : (float, float, float)
    size : float
        Its radius, which softens shadows, dm.
    direct : float
        Share of the light that it gives; the room gives the rest.
    reach : float
        Distance from the middle of its beam in which it loses half, dm.
    beam : (float, float, float)
        The middle of its beam.
    """

    place: Point
    size: float
    direct: float
    reach: float
    beam: Point


class View:
    """What a camera sees of a world.

    Parameters
    ----------
    world : World
    camera : Camera
    lamp : Lamp
    normal : (float, float, float)
        Of the surface on which shadows fall.
    """

    def __init__(self, world: World, camera: Camera, lamp: Lamp, normal: Point) -> None:
        self.world, self.camera, self.lamp = world, camera, lamp
        self._normal = np.array(normal)
        with world.emptied():
            _, depth, _ = self._taken((0.0, 0.0))
        self._ground = self._places(depth)[::COARSE, ::COARSE]
        self._falloff = self._beam(self._ground)

    def light(self, jitter: tuple[float, float] = (0.0, 0.0)) -> tuple[Light, npt.NDArray[np.int32]]:
        """Return linear light, blue, green, red, and which body is in each pixel."""
        image, _, bodies = self._taken(jitter)
        linear = (image.astype(np.float32) / 255.0) ** GAMMA
        there = [(each, self.world.center(each)) for each in self.world.balls if self.world.there(each)]
        lit = cv2.resize(self._shaded(there), (WIDTH, HEIGHT), interpolation=cv2.INTER_LINEAR)
        for ball, center in there:
            lit[bodies == ball.body] = self._beam(center.astype(np.float32))
        linear *= lit[..., np.newaxis]
        for ball, center in there:
            self._shine(linear, bodies, ball, center)
        return linear, bodies

    def truth(self, bodies: npt.NDArray[np.int32], names: Sequence[tuple[Ball, int]]) -> list[Seen]:
        """Say where balls are, given which body is in each pixel; those wholly out of the picture are left out."""
        found = []
        for ball, identity in names:
            circle = self.camera.circle(self.world.center(ball), ball.radius)
            if circle is None or not _touches(circle):
                continue
            share = float((bodies == ball.body).sum()) / (math.pi * circle.radius**2)
            found.append(Seen(identity, circle, min(share, 1.0)))
        return sorted(found)

    def _taken(self, jitter: tuple[float, float]) -> tuple[npt.NDArray[np.uint8], Floats, npt.NDArray[np.int32]]:
        """Let TinyRenderer draw: colors, distances along the axis, dm, and bodies."""
        engine = self.world.engine
        half_width, half_height = NEAR * WIDTH / 2.0 / self.camera.focal, NEAR * HEIGHT / 2.0 / self.camera.focal
        right, up = (NEAR * each / self.camera.focal for each in jitter)
        frustum = engine.computeProjectionMatrix(
            right - half_width, right + half_width, up - half_height, up + half_height, NEAR, FAR
        )
        view = engine.computeViewMatrix(list(self.camera.eye), list(self.camera.target), [0, 0, 1])
        _, _, colors, depth, bodies = engine.getCameraImage(
            WIDTH,
            HEIGHT,
            view,
            frustum,
            lightDirection=list(self.lamp.place),
            lightAmbientCoeff=1.0 - self.lamp.direct,
            lightDiffuseCoeff=self.lamp.direct,
            lightSpecularCoeff=0.0,  # TinyRenderer's streaks on textures: `_shine` is used instead
            shadow=0,
            renderer=engine.ER_TINY_RENDERER,
            physicsClientId=self.world.client,
        )
        image = np.reshape(colors, (HEIGHT, WIDTH, 4))[..., 2::-1].astype(np.uint8)
        distance = FAR * NEAR / (FAR - (FAR - NEAR) * np.reshape(depth, (HEIGHT, WIDTH)).astype(float))
        return image, distance, np.reshape(bodies, (HEIGHT, WIDTH)).astype(np.int32)

    def _places(self, distance: Floats) -> Light:
        """Return where in the world each pixel's surface is."""
        rows, columns = np.indices(distance.shape)
        rays = np.stack(
            [(columns - CX) / self.camera.focal, (rows - CY) / self.camera.focal, np.ones(distance.shape)], axis=-1
        )
        places = (rays * distance[..., np.newaxis]) @ self.camera.rotation() + np.array(self.camera.eye)
        return np.asarray(places, np.float32)

    def _beam(self, places: Light) -> Light:
        """How much light arrives at places, shadows aside."""
        far = ((places - np.array(self.lamp.beam, np.float32)) ** 2).sum(axis=-1)
        beam = 1.0 / (1.0 + far / self.lamp.reach**2)
        return np.asarray(1.0 - self.lamp.direct + self.lamp.direct * beam, np.float32)

    def _shine(self, linear: Light, bodies: npt.NDArray[np.int32], ball: Ball, center: Floats) -> None:
        """Add the lamp's mirror image to a ball."""
        to_lamp, to_eye = (np.array(each) - center for each in (self.lamp.place, self.camera.eye))
        half = to_lamp / np.linalg.norm(to_lamp) + to_eye / np.linalg.norm(to_eye)
        spot = self.camera.circle(center + ball.radius * half / np.linalg.norm(half), SPOT * ball.radius)
        if spot is None or not _touches(spot):
            return
        reach = 3.0 * spot.radius
        left, top = (max(int(middle - reach), 0) for middle in (spot.x, spot.y))
        right, bottom = (max(int(middle + reach) + 2, 0) for middle in (spot.x, spot.y))
        part = linear[top:bottom, left:right]
        rows, columns = np.indices(part.shape[:2])
        far = ((columns + left - spot.x) ** 2 + (rows + top - spot.y) ** 2) / spot.radius**2
        mirrored = ball.shine * np.exp(-far) * (bodies[top:bottom, left:right] == ball.body)
        part += mirrored[..., np.newaxis].astype(np.float32)

    def _shaded(self, balls: Sequence[tuple[Ball, Floats]]) -> Light:
        """Light on what is at rest: less of the lamp's in the shadows of balls, and of the room's close to them."""
        to_lamp = np.array(self.lamp.place, np.float32) - self._ground
        length = np.sqrt((to_lamp**2).sum(axis=-1))
        to_lamp = to_lamp / length[..., np.newaxis]
        lamp = np.ones(length.shape, np.float32)
        room = np.ones(length.shape, np.float32)
        for ball, center in balls:
            away = center.astype(np.float32) - self._ground
            squared = (away**2).sum(axis=-1)
            along = (away * to_lamp).sum(axis=-1)
            beside = np.sqrt(np.maximum(squared - along**2, 0.0))
            soft = np.maximum(self.lamp.size * along / length, 0.02)
            hidden = np.clip((ball.radius + soft - beside) / (2.0 * soft), 0.0, 1.0) * (along > 0.0)
            lamp *= 1.0 - hidden * np.minimum(ball.radius / soft, 1.0) ** 2
            toward = np.maximum((away * self._normal.astype(np.float32)).sum(axis=-1), 0.0) / np.sqrt(squared)
            room *= 1.0 - np.minimum(ball.radius**2 / np.maximum(squared, ball.radius**2), 1.0) * toward
        direct = self.lamp.direct
        beam = (self._falloff - (1.0 - direct)) / direct
        return np.asarray((1.0 - direct) * room + direct * beam * lamp, np.float32)


def _touches(circle: ms.Circle) -> bool:
    across = -circle.radius < circle.x < WIDTH - 1 + circle.radius
    return across and -circle.radius < circle.y < HEIGHT - 1 + circle.radius
