"""What a camera should have seen: the truth circle of a neighbor's ball through a distorting lens."""

import math

import msgspec
import numpy as np

from matchset.camera.camera_model import CameraModel
from matchset.shapes.circle import Circle
from matchset.sim.clips.truth import sphere_outline
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import camera_position

POINTS = 90
ROUNDS = 4


def true_circle(me: VehiclePose, other: VehiclePose, camera: CameraModel, radius: float) -> Circle | None:
    """Find the least-squares circle to the exact outline of a ball in a picture.

    Parameters
    ----------
    me, other : VehiclePose
        Who watches, and whose ball, at the middle of the exposure.
    camera : CameraModel
    radius : float
        Of the ball, m.

    Returns
    -------
    Circle or None
        px; None where the ball is not wholly before the camera, or beyond what its lens images.
    """
    position = me.rotation.T @ (other.ball - camera_position(me))
    if position[2] <= radius:
        return None
    pinhole = msgspec.structs.replace(camera, distortion=(0.0,) * 5)
    ellipse = sphere_outline(pinhole, position, radius).points(POINTS)
    rays = np.column_stack(
        ((ellipse[:, 0] - camera.cx) / camera.fx, (ellipse[:, 1] - camera.cy) / camera.fy, np.ones(POINTS))
    )
    try:
        points = camera.project(rays)
    except ValueError:  # beyond where the lens model has an image
        return None
    x, y = points.mean(axis=0).tolist()
    for _ in range(ROUNDS):  # Gauss-Newton on sum (|p_i - m| - r)^2
        away = points - (x, y)
        distance = np.hypot(away[:, 0], away[:, 1])
        slope = np.column_stack((away / distance[:, None], np.ones(POINTS)))
        dx, dy, r = np.linalg.lstsq(slope, distance, rcond=None)[0].tolist()
        x, y = x + dx, y + dy
    return Circle(x, y, r) if math.isfinite(x + y + r) else None
