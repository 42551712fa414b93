"""Position and rotation of the ball, and the camera as seen from the ball, with covariances: `Pose`."""

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.words import measured, one_line, short, table_of

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Floats = npt.NDArray[np.float64]
Observed = Literal["position", "level", "full"]

UNOBSERVED_VARIANCE = math.pi**2 / 3.0  # theorem: of an angle that is uniform in -pi ... pi
"""Variance of a rotation about which nothing is known, rad^2 on each axis."""
LEFT_OUT = "± leaves out camera and diameter"
"""What the words of a pose add where camera and diameter are taken as exact."""


# format: a recording leaves out what is not known of systematic errors
class Pose(msgspec.Struct, frozen=True, kw_only=True, dict=True, omit_defaults=True):
    """Position and rotation of the ball, with their covariance.

    Camera frame: x right, y down, z forward. Ball frame: z out of the ball through marker 0, y down, x = y cross z.

    Parameters
    ----------
    position : ndarray of shape (3,), float64
        The ball's center in the camera frame, m.
    rotation_matrix : ndarray of shape (3, 3), float64, or None
        Turns vectors of the ball frame into the camera frame; None where it is not observed.
    covariance : ndarray of shape (6, 6), float64
        Of the position (m) and of the rotation vector, in the camera frame, that turns `rotation` into the true one
        (rad). Where the rotation is not observed its block is pi^2/3 on the diagonal. It leaves out errors of camera
        and diameter that were taken as exact: see `systematic_covariance`.
    observed : str
        "position": the ball alone; "level": one marker, and the turn about it from the assumption that both vehicles
        are level; "full": two or more markers.
    time : float
        When the picture was taken, s.
    systematic_covariance : ndarray of shape (6, 6), float64, or None
        The part of `covariance` that comes from `CameraModel.covariance` and `BallTarget.diameter_sigma`: such an error
        is the same in every picture, so no averaging reduces it. None where both are taken as exact.
    """

    position: Floats
    rotation_matrix: Floats | None
    covariance: Floats
    observed: Observed
    time: float
    systematic_covariance: Floats | None = None

    @property
    def random_covariance(self) -> Floats:
        """`covariance` without `systematic_covariance`: what is independent from picture to picture, (6, 6)."""
        return self.covariance if self.systematic_covariance is None else self.covariance - self.systematic_covariance

    @property
    def distance(self) -> float:
        """From the camera to the ball's center, m (Epstein & Feldman, Eq. 5, for any angle off the axis)."""
        return math.hypot(*self.position.tolist())

    @property
    def yaw(self) -> float | None:
        """Where the ball is to the side of the camera's axis, atan2(X, Z), rad, > 0 to the right (Eq. 9).

        None where the rotation is not observed, as for `side`: with `heading` and `side` it says how the two vehicles
        stand to each other.
        """
        if self.rotation_matrix is None:
            return None
        return math.atan2(float(self.position[0]), float(self.position[2]))

    @property
    def side(self) -> float | None:
        """The camera's x in the ball frame, m (Eq. 6); None where the rotation is not observed."""
        return None if self._seen_from_ball is None else float(self._seen_from_ball[0])

    @property
    def height(self) -> float | None:
        """How far the camera is above the ball, -y in the ball frame, m (Eq. 7); None as for `side`."""
        return None if self._seen_from_ball is None else -float(self._seen_from_ball[1])

    @property
    def heading(self) -> float | None:
        """How far the camera is before the marker, z in the ball frame, m (Eq. 8); None as for `side`."""
        return None if self._seen_from_ball is None else float(self._seen_from_ball[2])

    def measured(self) -> dict[str, tuple[float, float]]:
        """Return the columns of `poses.csv` with their standard deviations, m and rad; `yaw` comes last.

        `side`, `height`, `heading` and `yaw` are there only where the rotation is observed.
        """
        values = dict(zip("xyz", self.position.tolist(), strict=True))
        variances = dict(zip("xyz", np.diagonal(self.covariance).tolist(), strict=False))
        relative = viewpoint_covariance(self)
        if relative is not None:
            names = ("side", "height", "heading", "yaw")
            values |= {name: float(getattr(self, name)) for name in names}
            variances |= dict(zip(names, (*np.diagonal(relative).tolist(), yaw_variance(self)), strict=True))
        return {name: (value, math.sqrt(max(variances[name], 0.0))) for name, value in values.items()}

    def to_dict(self) -> dict[str, Any]:
        """Return it for JSON, under the names of `poses.csv`: m, rad and s; with `rotation_matrix`, or None there."""
        found = self.measured()
        return {
            "time": float(self.time),
            "found": True,
            **{name: value for name, (value, _) in found.items()},
            **{f"{name}_std": sigma for name, (_, sigma) in found.items() if math.isfinite(sigma)},
            "observed": self.observed,
            "rotation_matrix": None if self.rotation_matrix is None else self.rotation_matrix.tolist(),
        }

    @one_line
    def __repr__(self) -> str:
        numbers = ", ".join(f"{name} {words}" for name, words in self._in_words())
        exact = f"; {LEFT_OUT}" if self.systematic_covariance is None else ""
        return f"Pose({numbers}, observed {self.observed}, {short(self.time)} s{exact})"

    def _repr_html_(self) -> str:
        """Show the numbers in a notebook."""
        rows = [*self._in_words(), ("distance", f"{short(self.distance)} m"), ("observed", self.observed)]
        rows += [("time", f"{short(self.time)} s")]
        rows += [("±", LEFT_OUT.removeprefix("± "))] if self.systematic_covariance is None else []
        return table_of("Pose of the ball before the camera", rows)

    def _in_words(self) -> list[tuple[str, str]]:
        found = self.measured()
        yaw = found.pop("yaw", None)
        words = [(name, f"{measured(value, std, '+')} m") for name, (value, std) in found.items()]
        if yaw is None:
            return words
        angle, sigma = (math.degrees(each) for each in yaw)
        return [*words, ("yaw", f"{measured(angle, sigma, '+')}°")]

    @cached_property
    def rotation(self) -> "Rotation | None":
        """`rotation_matrix` as SciPy's `Rotation`; made when asked for, since that and loading it take a while."""
        from scipy.spatial.transform import Rotation

        return None if self.rotation_matrix is None else Rotation.from_matrix(self.rotation_matrix)

    @cached_property
    def _seen_from_ball(self) -> Floats | None:
        """The camera in the ball frame, (3,), m."""
        return None if self.rotation_matrix is None else -(self.position @ self.rotation_matrix)


def viewpoint_covariance(pose: Pose) -> Floats | None:
    """Covariance of the camera's position in the ball frame: x is `side`, y minus `height`, z `heading`.

    The position is c = -R' p. An error dp of p and a rotation vector w that is missing from R change it by
    ``dc = -R' dp - R' [p]x w``, to first order.

    Parameters
    ----------
    pose : Pose

    Returns
    -------
    ndarray of shape (3, 3), float64, or None
        m^2; None where the rotation is not observed.
    """
    if pose.rotation_matrix is None:
        return None
    x, y, z = pose.position.tolist()
    cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    jacobian = -pose.rotation_matrix.T @ np.hstack((np.eye(3), cross))
    covariance: Floats = jacobian @ pose.covariance @ jacobian.T
    return covariance


def yaw_variance(pose: Pose) -> float:
    """Variance of `Pose.yaw`, atan2(X, Z), rad^2.

    Parameters
    ----------
    pose : Pose

    Returns
    -------
    float
    """
    x, _, z = pose.position.tolist()
    jacobian = np.array((z, 0.0, -x)) / (x * x + z * z)
    return float(jacobian @ pose.covariance[:3, :3] @ jacobian)
