"""The true circle of a neighbor's ball in a picture, through the lens with its distortion: `true_circle`."""

import math

import msgspec
import numpy as np

from matchset.camera.camera_model import CameraModel
from matchset.shapes.circle import Circle
from matchset.sim.clips.truth import sphere_outline
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import camera_position

# geometry: points on the outline, even angles
POINTS = 90


def true_circle(me: VehiclePose, other: VehiclePose, camera: CameraModel, radius: float) -> Circle | None:
    """Find the least-squares circle of the exact outline of a ball in a picture.

    Parameters
    ----------
    me, other : VehiclePose
        The vehicle with the camera and the one with the ball, at the middle of the exposure.
    camera : CameraModel
    radius : float
        Of the ball, m.

    Returns
    -------
    Circle or None
        px; None where the ball is not wholly before the camera, or outside the range of its lens model.
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
    for _ in range(4):  # Gauss-Newton on sum (|p_i - m| - r)^2; more change 1e-5 px at most (default lens)
        offset = points - (x, y)
        distance = np.hypot(offset[:, 0], offset[:, 1])
        jacobian = np.column_stack((offset / distance[:, None], np.ones(POINTS)))
        dx, dy, r = np.linalg.lstsq(jacobian, distance, rcond=None)[0].tolist()
        x, y = x + dx, y + dy
    return Circle(x, y, r) if math.isfinite(x + y + r) else None
