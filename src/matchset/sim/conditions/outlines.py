"""What a tracker would find in the pictures of a `World`, from the truth and with noise: `OutlineCameras`."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.fitting.fit_quality import add_field_covariance
from matchset.numeric.jit import interpreted
from matchset.shapes.circle import Circle
from matchset.sim.conditions.outline_noise import PICTURE, Deviates, OutlineNoise, deviates, slip
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import KEPT, RATE, World
from matchset.sim.world_views import WorldViews
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]

NEXT, BEYOND = 0x0071, 0x0072  # format: whose deviates: the next ball's and the next-but-one's


class BallOutline(NamedTuple):
    """A ball in a picture.

    Attributes
    ----------
    points : (n, 2)
        Of its outline, px.
    middle : (2,)
        px
    radius : float
        px
    marker : (2,) or None
        Middle of the marker, px; None if it cannot be seen.
    way : (2,)
        Of the ball's center since the last picture, px.
    """

    points: Floats
    middle: Floats
    radius: float
    marker: Floats | None
    way: Floats

    def tracks(self, time: float, noise: OutlineNoise) -> tuple[Track[Circle], tuple[Track[Circle], ...]]:
        """Return ball and markers as trackers do, with a time, s."""
        circle = Circle(float(self.middle[0]), float(self.middle[1]), self.radius)
        offset = -0.5 * self.way  # geometry: the fields are half a picture apart, the even rows first
        point = noise.point_deviation(math.hypot(*self.way.tolist())) ** 2 / max(len(self.points), 1)
        center = 2.0 * point + noise.center_px**2
        covariance = np.diag((center, center, point + (noise.size * self.radius) ** 2))
        interpreted(add_field_covariance)(offset, noise.claimed, covariance)
        ball = Track(circle, covariance, 1.0, self.points, time, field_offset=(float(offset[0]), float(offset[1])))
        if self.marker is None:
            return ball, ()
        spread = (math.radians(noise.marker_deg) * self.radius) ** 2
        small = Circle(float(self.marker[0]), float(self.marker[1]), noise.marker_diameter * self.radius)
        return ball, (Track(small, np.diag((spread, spread, spread)), 1.0, np.empty((0, 2)), time),)


class OutlineCameras(WorldViews):
    """Finds the balls in the pictures of a world without drawing them: each follower sees its neighbor's, and only it.

    Parameters
    ----------
    world : World
        Its seed decides the noise.
    camera : CameraModel
        What is told about every follower's camera; where the outlines are follows from the cameras as they are.
    noise : OutlineNoise, optional
    """

    def __init__(self, world: World, camera: CameraModel, noise: OutlineNoise | None = None) -> None:
        super().__init__(world, camera)
        self.noise = noise or OutlineNoise()
        angles = np.linspace(0.0, 2.0 * math.pi, self.noise.points, endpoint=False)
        self._circle = np.column_stack((np.cos(angles), np.sin(angles)))
        self._read_at, self._read = -1, dict[int, list[VehiclePose]]()
        self._weights = self.noise.lasting_weights()
        self._lasts = max(len(self._weights), self.noise.burst_pictures, self.noise.wrong_pictures)

    def outline(self, who: int, step: int) -> BallOutline | Lost[Circle]:
        """Find the neighbor's ball in a picture.

        Parameters
        ----------
        who : int
            Whose picture, from 0.
        step : int
            The middle of its exposure, of the last second.

        Returns
        -------
        Outline or Lost
            `Lost` with the reason if it is hidden or outside.
        """
        time = step / RATE
        if self.is_hidden(who, time):
            return Lost("the ball is hidden", time)
        poses, radius = self._poses(step), self.world.vehicle.ball_radius
        view, neighbor = self.viewpoint(poses[who]), poses[who + 1]
        ball = view.from_room @ (neighbor.ball - view.position)
        if not ball[2] > radius:
            return Lost("the ball is not before the camera", time)
        points = self._seen(ball[np.newaxis] + radius * self._edge(ball, radius))
        if len(points) < self.noise.inside * self.noise.points:
            return Lost("the ball is not in the picture", time)
        way, drawn = self._way(who, 1, step, ball), deviates(self.world.seed, NEXT, who, step)
        marker = None
        if drawn.missed >= self.noise.marker_missed * math.hypot(*way.tolist()):
            marker = self._marker_in_picture(
                ball, -(view.from_room @ self.marked(neighbor.rotation))[:, 2], drawn.marker
            )
        points, middle, radius = self._noisy(points, points, way, 1.0, self._history(NEXT, who, step))
        return BallOutline(points, middle, radius, marker, way)

    def outline_beyond(self, who: int, step: int) -> BallOutline | Lost[Circle]:
        """Find the next-but-one ball in a picture, without its marker: the neighbor's ball hides a part of it.

        Parameters
        ----------
        who, step : int
            See `outline`.

        Returns
        -------
        Outline or Lost
            `Lost` with the reason if too little of it can be seen, or there is none.
        """
        time, poses, radius = step / RATE, self._poses(step), self.world.vehicle.ball_radius
        if who + 2 >= len(poses) or self.is_hidden(who, time):
            return Lost("there is no next-but-one ball" if who + 2 >= len(poses) else "the ball is hidden", time)
        view = self.viewpoint(poses[who])
        near, ball = (view.from_room @ (poses[who + ahead].ball - view.position) for ahead in (1, 2))
        if not ball[2] > radius:
            return Lost("the ball is not before the camera", time)
        edge = ball + radius * self._edge(ball, radius)
        far, middle = np.sqrt((edge**2).sum(axis=1)), math.sqrt(near @ near)
        clear = (edge @ near < math.sqrt(max(1.0 - (radius / middle) ** 2, 0.0)) * far * middle) | (far < middle)
        points = self._seen(edge[clear])
        if len(points) < self.noise.inside_beyond * self.noise.points:
            return Lost("too little of the ball can be seen", time)
        worse = math.sqrt(self.noise.points / len(points)) * math.sqrt(ball @ ball) / middle
        way, history = self._way(who, 2, step, ball), self._history(BEYOND, who, step)
        points, center, size = self._noisy(points, self._seen(edge), way, worse, history)
        return BallOutline(points, center, size, None, way)

    def _noisy(
        self, points: Floats, whole: Floats, way: Floats, worse: float, history: list[Deviates]
    ) -> tuple[Floats, Floats, float]:
        """Move points of an outline, its center and radius, found from all of it; `worse` enlarges errors."""
        noise, middle = self.noise, whole.mean(axis=0)
        size = math.sqrt(((whole - middle) ** 2).sum(axis=1).mean())
        off = slip(noise, history, self._weights, way, size)
        moved, grown = worse * off.center, 1.0 + worse * off.radius / size
        scatter = noise.point_deviation(math.hypot(*way.tolist()))
        each = grown + scatter / size * history[0].points[: len(points), np.newaxis]
        return middle + each * (points - middle) + moved, middle + moved, grown * size

    def _history(self, what: int, who: int, step: int) -> list[Deviates]:
        """Deviates of a picture and of those before it, newest first."""
        seed = self.world.seed
        return [deviates(seed, what, who, step - PICTURE * k) for k in range(self._lasts)]

    def _poses(self, step: int) -> list[VehiclePose]:
        """Poses of all vehicles at a step, read from the world once for all followers that see it at one time."""
        if self._read_at != self.world.step:
            self._read_at, self._read = self.world.step, {}
        if step not in self._read:
            self._read[step] = self.world.poses(step)
        return self._read[step]

    def _way(self, who: int, ahead: int, step: int, ball: Floats) -> Floats:
        """Way of a ball's center in the picture since the last one, px, as if the lens were straight."""
        earlier = max(step - PICTURE, self.world.step - KEPT + 1, 0)  # what the world remembers
        if earlier >= step:
            return np.zeros(2)
        poses = self._poses(earlier)
        view = self.viewpoint(poses[who])
        (x, y, z), (right, down, far) = (
            (view.from_room @ (poses[who + ahead].ball - view.position)).tolist(),
            ball.tolist(),
        )
        if not z > self.world.vehicle.ball_radius:
            return np.zeros(2)
        pictures = (step - earlier) / PICTURE
        return np.array((self.model.fx * (right / far - x / z), self.model.fy * (down / far - y / z))) / pictures

    def _edge(self, ball: Floats, radius: float) -> Floats:
        """Where the tangent cone touches a ball, from its center in units of its radius, (n, 3)."""
        x, y, z = ball.tolist()
        far, level = math.hypot(x, y, z), math.hypot(x, z)
        sine, ahead = radius / far, ball / far
        right = np.array((z, 0.0, -x)) / level
        down = np.array((-x * y, level * level, -y * z)) / (level * far)
        edge: Floats = math.sqrt(1.0 - sine**2) * self._circle @ np.stack((right, down)) - sine * ahead
        return edge

    def _marker_in_picture(self, ball: Floats, direction: Floats, deviate: Floats) -> Floats | None:
        """Project the marker in a direction on a ball, with noise; None if it is not seen."""
        along, across, up = (math.radians(self.noise.marker_deg) * deviate).tolist()
        x, y, z = direction.tolist()
        off = np.array((x + across * z - up * y, y + up * x - along * z, z + along * y - across * x))
        direction = off / math.sqrt(off @ off)
        if -(direction @ ball) < self.noise.marker_cosine * math.sqrt(ball @ ball):
            return None
        place = ball + self.world.vehicle.ball_radius * direction
        pixels = self._seen(place[np.newaxis])
        return pixels[0] if len(pixels) else None

    def _seen(self, points: Floats) -> Floats:
        """Pixels of those points that are in the picture."""
        visible = self.model.visible(points)
        return self.model.project(points if visible.all() else points[visible])
