"""What a tracker would find in the pictures of a `World`, from the truth and with noise: `OutlineCameras`."""

import math
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.shapes.circle import Circle
from matchset.sim.world import RATE, World
from matchset.sim.world_views import WorldViews
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]


class OutlineNoise(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far outlines and markers are off: normal deviates, new in every picture.

    Chosen by: errors and claimed covariances of poses in rendered flights, docs/log.md, 2026-11-23. All together a
    center is 0.2 px off along each axis and a range 0.5 %; what consecutive pictures share in that is left out.

    Parameters
    ----------
    point_px : float
        Standard deviation of each point across the outline, px. A localizer estimates from it how sure it is: less
        makes it claim too much, and a gate after it closes too early.
    size : float
        Standard deviation of the size besides, as a share: as much is the range off.
    center_px : float
        Standard deviation of the center along each axis besides, px.
    marker_deg : float
        Standard deviation of the marker's direction on the ball, about each axis, degree.
    points : int
        Points of an outline. More are slower, and need more noise each.
    marker_cosine : float
        Least cosine between the marker's direction and that to the camera at which it is found.
    inside : float
        Least share of an outline that must be in the picture.
    inside_beyond : float
        The same of the next-but-one ball, which the neighbor's hides in part.
    marker_diameter : float
        Across a marker, as a share of the ball's diameter; its size decides nothing.
    """

    point_px: float = 0.3
    size: float = 0.0045
    center_px: float = 0.18
    marker_deg: float = 0.6
    points: int = 24
    marker_cosine: float = 0.3
    inside: float = 0.5
    inside_beyond: float = 0.3
    marker_diameter: float = 0.2

    def __post_init__(self) -> None:
        for name in ("point_px", "size", "center_px", "marker_deg"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be 0 or more, got {getattr(self, name)}")
        if not 5 <= self.points <= 64:
            raise ValueError(f"points must be within 5 ... 64, got {self.points}")


class Outline(NamedTuple):
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
    """

    points: Floats
    middle: Floats
    radius: float
    marker: Floats | None

    def tracks(self, time: float, noise: OutlineNoise) -> tuple[Track[Circle], tuple[Track[Circle], ...]]:
        """Return ball and markers as trackers do, with a time, s."""
        center, size = noise.center_px**2, (noise.size * self.radius) ** 2
        circle = Circle(float(self.middle[0]), float(self.middle[1]), self.radius)
        ball = Track(circle, np.diag((center, center, size)), 1.0, self.points, time)
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

    def outline(self, who: int, step: int) -> Outline | Lost[Circle]:
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
        poses, radius = self.world.poses(step), self.world.vehicle.ball_radius
        view, neighbor = self.viewpoint(poses[who]), poses[who + 1]
        ball = view.from_room @ (neighbor.ball - view.position)
        if not ball[2] > radius:
            return Lost("the ball is not before the camera", time)
        points = self._seen(ball[np.newaxis] + radius * self._edge(ball, radius))
        if len(points) < self.noise.inside * self.noise.points:
            return Lost("the ball is not in the picture", time)
        rng = np.random.default_rng((self.world.seed, 0x0071, who, step))
        marker = self._marker_in_picture(ball, -(view.from_room @ self.marked(neighbor.rotation))[:, 2], rng)
        return self._noisy(points, points, marker, 1.0, rng)

    def outline_beyond(self, who: int, step: int) -> Outline | Lost[Circle]:
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
        time, poses, radius = step / RATE, self.world.poses(step), self.world.vehicle.ball_radius
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
        rng = np.random.default_rng((self.world.seed, 0x0072, who, step))
        worse = math.sqrt(self.noise.points / len(points)) * math.sqrt(ball @ ball) / middle
        return self._noisy(points, self._seen(edge), None, worse, rng)

    def _noisy(
        self, points: Floats, whole: Floats, marker: Floats | None, worse: float, rng: np.random.Generator
    ) -> Outline:
        """Move points of an outline, by its center and size from all of it, and its marker; `worse` enlarges noise."""
        noise, middle = self.noise, whole.mean(axis=0)
        size = math.sqrt(((whole - middle) ** 2).sum(axis=1).mean())
        moved = worse * noise.center_px * rng.standard_normal(2)
        grown = 1.0 + worse * noise.size * rng.standard_normal()
        off = grown + noise.point_px / size * rng.standard_normal((len(points), 1))
        points = middle + off * (points - middle) + moved
        return Outline(points, middle + moved, grown * size, None if marker is None else marker + moved)

    def _edge(self, ball: Floats, radius: float) -> Floats:
        """Where the tangent cone touches a ball, from its center in units of its radius, (n, 3)."""
        x, y, z = ball.tolist()
        far, level = math.hypot(x, y, z), math.hypot(x, z)
        sine, ahead = radius / far, ball / far
        right = np.array((z, 0.0, -x)) / level
        down = np.array((-x * y, level * level, -y * z)) / (level * far)
        edge: Floats = math.sqrt(1.0 - sine**2) * self._circle @ np.stack((right, down)) - sine * ahead
        return edge

    def _marker_in_picture(self, ball: Floats, direction: Floats, rng: np.random.Generator) -> Floats | None:
        """Project the marker in a direction on a ball, with noise; None if it is not seen."""
        along, across, up = np.radians(self.noise.marker_deg) * rng.standard_normal(3)
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
