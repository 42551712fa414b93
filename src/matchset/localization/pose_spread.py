"""How certain the camera's place is as the ball sees it: `seen_spread`, `yaw_variance`."""

import numpy as np
import numpy.typing as npt

from matchset.localization.pose import Pose

Floats = npt.NDArray[np.float64]


def seen_spread(pose: Pose) -> Floats | None:
    """Covariance of the camera's place in the ball frame: x is `side`, y minus `height`, z `heading`.

    The place is c = -R' p. An error dp of the position and a rotation vector w that is missing from R move it by
    ``dc = -R' dp - R' [p]x w``, to first order.

    Parameters
    ----------
    pose : Pose

    Returns
    -------
    ndarray of shape (3, 3), float64, or None
        m^2; None where the rotation is not observed.
    """
    if pose.turn is None:
        return None
    x, y, z = pose.position.tolist()
    cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    slope = -pose.turn.T @ np.hstack((np.eye(3), cross))
    spread: Floats = slope @ pose.covariance @ slope.T
    return spread


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
    slope = np.array((z, 0.0, -x)) / (x * x + z * z)
    return float(slope @ pose.covariance[:3, :3] @ slope)
