"""What a rendered frame really shows: `ClipTruth`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.shapes.circle import Circle

Array = npt.NDArray[np.float64]


class SphereOutline(msgspec.Struct, frozen=True, kw_only=True):
    """The ellipse in which the tangent cone of a sphere cuts the picture.

    The center of the ellipse is not the projection of the sphere's center: the farther off axis, the
    farther apart.

    Parameters
    ----------
    x, y : float
        Center of the ellipse, px.
    a, b : float
        Semi-axes, px, a >= b.
    angle : float
        From +x toward +y to the a axis, rad, in -pi/2 ... pi/2.
    projected_x, projected_y : float
        Projection of the sphere's center, px.
    """

    x: float
    y: float
    a: float
    b: float
    angle: float
    projected_x: float
    projected_y: float

    def points(self, count: int = 360) -> Array:
        """Points of the outline, equally spaced in the ellipse's parameter.

        Parameters
        ----------
        count : int
            How many.

        Returns
        -------
        ndarray of shape (count, 2), float64
            x, y, px.
        """
        phase = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
        along, across = self.a * np.cos(phase), self.b * np.sin(phase)
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.column_stack((self.x + c * along - s * across, self.y + s * along + c * across))

    def circle(self) -> Circle:
        """Fit the truth circle: the least-squares circle to 360 points of the outline.

        It minimizes sum (|p_i - m| - r)^2. The points are symmetric about the ellipse's center, so m is
        that center, and r is the mean distance to it.

        Returns
        -------
        Circle
            px.
        """
        phase = np.linspace(0.0, 2.0 * math.pi, 360, endpoint=False)
        distance = np.hypot(self.a * np.cos(phase), self.b * np.sin(phase))
        return Circle(self.x, self.y, float(distance.mean()))


def sphere_outline(camera: CameraModel, position: npt.ArrayLike, radius: float) -> SphereOutline:
    """Outline of a sphere seen by a pinhole camera.

    A ray d touches or meets the sphere with center c where d^T (c c^T - (|c|^2 - R^2) I) d >= 0; with
    d = ((x - cx)/fx, (y - cy)/fy, 1) the border of that set is a conic of the picture.

    Parameters
    ----------
    camera : CameraModel
        The camera.
    position : array_like of shape (3,)
        Center of the sphere in the camera frame, m.
    radius : float
        Radius of the sphere, m.

    Returns
    -------
    SphereOutline
        px, rad.

    Raises
    ------
    ValueError
        If the radius is not positive or the sphere is not wholly in front of the camera: its outline is no
        ellipse.
    """
    center = np.asarray(position, dtype=np.float64)
    if center.shape != (3,) or not np.isfinite(center).all():
        raise ValueError(f"a position must be three finite numbers, got {position!r}")
    if not 0.0 < radius < center[2]:
        raise ValueError(f"the sphere must lie in front of the camera: radius {radius} m, depth {center[2]} m")
    cone = np.outer(center, center) - (center @ center - radius**2) * np.eye(3)
    x, y, a, b, angle = _conic_axes(cone, camera)
    return SphereOutline(
        x=x,
        y=y,
        a=a,
        b=b,
        angle=angle,
        projected_x=float(camera.fx * center[0] / center[2] + camera.cx),
        projected_y=float(camera.fy * center[1] / center[2] + camera.cy),
    )


def _conic_axes(cone: Array, camera: CameraModel) -> tuple[float, float, float, float, float]:
    """Center, semi-axes and angle in px of d^T cone d = 0, where d is a ray with depth 1."""
    scale = np.array([1.0 / camera.fx, 1.0 / camera.fy])
    quadratic = cone[:2, :2] * np.outer(scale, scale)
    linear = cone[:2, 2] * scale
    center = -np.linalg.solve(quadratic, linear)
    level = -(cone[2, 2] + linear @ center)
    values, vectors = np.linalg.eigh(quadratic / level)
    a, b = 1.0 / math.sqrt(values[0]), 1.0 / math.sqrt(values[1])
    angle = math.atan2(vectors[1, 0], vectors[0, 0])
    angle = (angle + math.pi / 2.0) % math.pi - math.pi / 2.0
    return float(center[0] + camera.cx), float(center[1] + camera.cy), a, b, angle


def mean_circle(circles: list[Circle]) -> Circle:
    """Mean of several circles: the truth of an interlaced frame from those of its fields.

    Parameters
    ----------
    circles : list of Circle
        At least one.

    Returns
    -------
    Circle
        Mean center and mean radius, px.
    """
    if not circles:
        raise ValueError("the mean of 0 circles is not defined")
    n = len(circles)
    return Circle(sum(c.x for c in circles) / n, sum(c.y for c in circles) / n, sum(c.radius for c in circles) / n)


class ClipTruth(msgspec.Struct, frozen=True, kw_only=True):
    """What a frame of a clip really shows, in the middle of its exposure.

    Parameters
    ----------
    index : int
        The frame's index.
    circle : Circle or None
        Least-squares circle to the exact outline, px; interlaced: the mean of the two fields' circles. None
        where nothing of the ball is visible.
    visible : bool
        Some of the ball is visible.
    share : float
        Share of the disc that lies in the picture and behind nothing, 0 ... 1, good to 0.01.
    outline : SphereOutline or None
        The exact ellipse and the projected center at the middle of the frame's exposure, hidden or not;
        None without a ball.
    position : tuple of 3 floats or None
        Center of the ball in the camera frame, m; None without a ball.
    """

    index: int
    circle: Circle | None
    visible: bool
    share: float
    outline: SphereOutline | None
    position: tuple[float, float, float] | None
