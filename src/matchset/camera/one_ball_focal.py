"""Corrects the focal length of a camera by a ball at one known distance: `focal_from_one_ball`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from matchset.camera.ball_focal_length import BallFocalParameters, HeldBall, half_angle
from matchset.camera.camera_model import CameraModel

Floats = npt.NDArray[np.float64]

RANGE = 8.0  # geometry: by which factor the focal length may be wrong at most


def focal_from_one_ball(
    ball: HeldBall, radius: float, camera: CameraModel, parameters: BallFocalParameters | None = None
) -> CameraModel:
    """Scale both focal lengths so that a ball looks as large as it must at its distance.

    The rays of its outline form a cone of half-angle alpha, sin(alpha) = R / distance (Epstein & Feldman, Eq. 5,
    exact). With one distance neither the center of projection nor a shift of the edges can be told from the focal
    length: what they may be is part of its standard deviation.

    Parameters
    ----------
    ball : HeldBall
        Its center's distance, and its outlines.
    radius : float
        Of the ball, m.
    camera : CameraModel
        Whose focal length is corrected; principal point and lens stay.
    parameters : BallFocalParameters, optional

    Returns
    -------
    CameraModel
        With the covariance of its numbers.

    Raises
    ------
    ValueError
        In words, if the distance does not fit the ball.
    """
    known = parameters or BallFocalParameters()
    if not 0.0 < radius < math.inf:
        raise ValueError(f"a ball's radius must be positive, in m, got {radius}")
    if not known.min_distance_radii * radius < ball.distance < math.inf:
        raise ValueError(f"the ball's center is at {ball.distance:g} m: that is within its radius of {radius:g} m")
    if not any(len(outline) >= known.min_points for outline in ball.outlines):
        raise ValueError(f"the ball was not seen at {ball.distance:.2f} m")
    must = math.asin(radius / ball.distance)

    def excess(log_scale: float) -> float:
        return half_angle(_scaled(camera, math.exp(log_scale)), ball.outlines, 0.0, known)[0] - must

    widest = math.log(RANGE)
    if not excess(-widest) > 0.0 > excess(widest):
        raise ValueError(f"the ball does not look as one of {2.0 * radius:g} m would at {ball.distance:g} m")
    scale = math.exp(brentq(excess, -widest, widest, xtol=1e-6))
    corrected = _scaled(camera, scale)
    _, spread = half_angle(corrected, ball.outlines, 0.0, known)
    place = math.hypot(known.tape_sigma, known.pupil_sigma) / ball.distance
    edges = known.edge_sigma_px / (corrected.fx * math.tan(must))
    share = math.hypot(place, edges, spread / math.tan(must))
    thought = msgspec.structs.replace(corrected, intrinsics_covariance=_covariance(corrected, known, camera.covariance))
    return thought.with_focal_sigma(share)


def _scaled(camera: CameraModel, scale: float) -> CameraModel:
    return msgspec.structs.replace(camera, fx=scale * camera.fx, fy=scale * camera.fy, intrinsics_covariance=None)


def _covariance(
    camera: CameraModel, known: BallFocalParameters, before: Floats | None
) -> tuple[tuple[float, ...], ...]:
    """Return the covariance of all but the focal lengths: as it was, or as is thought."""
    center = (known.center_sigma * camera.width) ** 2
    thought = np.diag([0.0, 0.0, center, center, known.k1_sigma**2, 0.0, 0.0, 0.0, 0.0])
    covariance = thought if before is None else before
    return tuple(tuple(row) for row in covariance.tolist())
