"""Balls whose outline is known exactly, for the tests of localization."""

import math

import numpy as np
import numpy.typing as npt

import matchset as ms

Floats = npt.NDArray[np.float64]

PINHOLE = ms.CameraModel(width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5)
BARREL = ms.CameraModel(
    width=640, height=480, fx=450.0, fy=455.0, cx=315.0, cy=243.0, distortion=(-0.3, 0.06, 0.001, -0.002, 0.0)
)


def rim(position: npt.ArrayLike, radius: float = 0.14, count: int = 64) -> Floats:
    """Directions that touch a sphere, (count, 3): a circle on the tangent cone, written out."""
    center = np.asarray(position, np.float64)
    far = float(np.linalg.norm(center))
    axis, sine = center / far, radius / far
    one = np.cross(axis, (0.0, 1.0, 0.0) if abs(axis[1]) < 0.9 else (1.0, 0.0, 0.0))
    one /= np.linalg.norm(one)
    angles = 2.0 * math.pi * (np.arange(count) + 0.25) / count
    circle = np.outer(np.cos(angles), one) + np.outer(np.sin(angles), np.cross(axis, one))
    return np.asarray(math.sqrt(1.0 - sine * sine) * axis + sine * circle)


def track(points: Floats, spread: float = 0.1, time: float = 0.0, keep: int | None = None) -> "ms.Track[ms.Circle]":
    """A track with these edge points (or the first few of them) and the circle through their mean."""
    middle = points.mean(axis=0)
    radius = float(np.hypot(*(points - middle).T).mean())
    circle = ms.Circle(float(middle[0]), float(middle[1]), radius)
    return ms.Track(circle, spread**2 * np.eye(3), 1.0, points[:keep], time)


def ball(camera: ms.CameraModel, position: npt.ArrayLike, radius: float = 0.14) -> "ms.Track[ms.Circle]":
    """The track of a ball without any error."""
    return track(camera.project(rim(position, radius)))


def dot(camera: ms.CameraModel, place: npt.ArrayLike, spread: float = 0.2, time: float = 0.0) -> "ms.Track[ms.Circle]":
    """The track of a marker whose rim has its middle at a place (3,)."""
    x, y = camera.project(np.asarray(place, np.float64)[np.newaxis])[0].tolist()
    return ms.Track(ms.Circle(x, y, 5.0), spread**2 * np.eye(3), 1.0, np.empty((0, 2)), time)


def square(error: Floats, covariance: Floats) -> float:
    """Normalized error squared."""
    return float(error @ np.linalg.solve(covariance, error))
