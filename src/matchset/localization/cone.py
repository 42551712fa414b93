"""The tangent cone of a ball, fitted to the rays of its outline.

A ray r (unit vector) touches the sphere with center p and radius R where r.p = |p| cos(alpha), sin(alpha) = R / |p|.
With q = p / (|p| cos(alpha)) that is ``r.q = 1``: linear in q, for any angle off the axis, and
``p = R q / sqrt(q.q - 1)``. A point lies ``e = (r.q - 1) / (dr/dn . q)`` px outside the outline, dr/dn the change of
its ray per px along the outward normal: these px are squared and summed, so an outline counts the same everywhere in
the picture. Distortion is taken out of these points alone.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.lens import fold, undistort
from matchset.localization.matrix3 import add_spread, invert
from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]

ROUNDS = 16
EARLY = 6  # rounds of least absolute values before the biweight
CUT = 4.7  # standard deviations at which Tukey's biweight gives up a point
STEP = 0.25  # px along the normal over which the change of a ray is measured
NEAREST = 0.97  # sine of the largest half-angle: nearer the ball all but touches the camera
DONE, FEW, FLAT, NEAR = 0, 1, 2, 3


@kernel
def _ray(intrinsics: Floats, widest: float, x: float, y: float, ray: Floats) -> bool:
    """Write the unit vector of a pixel; False where the lens has none."""
    u, v, seen = undistort(intrinsics, widest, x, y)
    scale = 1.0 / math.sqrt(u * u + v * v + 1.0)
    ray[0], ray[1], ray[2] = u * scale, v * scale, scale
    return seen


@kernel
def _see(
    intrinsics: Floats, points: Floats, x: float, y: float, shift: float, outward: Floats, rays: Floats, slopes: Floats
) -> int:
    """Rays of the points, shifted outward, and their change per px; returns how many have one, the others are 0."""
    widest = fold(intrinsics[4], intrinsics[5], intrinsics[8])
    beyond, seen = np.empty(3), 0
    for i in range(points.shape[0]):
        nx, ny = points[i, 0] - x, points[i, 1] - y
        far = math.sqrt(nx * nx + ny * ny)
        rays[i, 0] = rays[i, 1] = rays[i, 2] = 0.0
        if not 1e-6 < far < 1e9:
            continue
        nx, ny = nx / far, ny / far
        outward[i, 0], outward[i, 1], outward[i, 2] = nx, ny, 1.0
        px, py = points[i, 0] + shift * nx, points[i, 1] + shift * ny
        if _ray(intrinsics, widest, px + STEP * nx, py + STEP * ny, beyond) and _ray(
            intrinsics, widest, px, py, rays[i]
        ):
            for k in range(3):
                slopes[i, k] = (beyond[k] - rays[i, k]) / STEP
            seen += 1
        else:
            rays[i, 0] = rays[i, 1] = rays[i, 2] = 0.0
    return seen


@kernel
def _solve(rays: Floats, slopes: Floats, weights: Floats, q: Floats, normal: Floats, inverse: Floats) -> bool:
    """Weighted least squares for q; the inverse of the normal matrix is that of px."""
    b, normal[:] = np.zeros(3), 0.0
    for i in range(rays.shape[0]):
        if weights[i] > 0.0:
            fall = slopes[i, 0] * q[0] + slopes[i, 1] * q[1] + slopes[i, 2] * q[2]
            w = weights[i] / (fall * fall)
            for j in range(3):
                b[j] += w * rays[i, j]
                for k in range(3):
                    normal[j, k] += w * rays[i, j] * rays[i, k]
    if not invert(normal, inverse):
        return False
    for j in range(3):
        q[j] = inverse[j, 0] * b[0] + inverse[j, 1] * b[1] + inverse[j, 2] * b[2]
    return bool(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] > 1.0)


@kernel
def _weigh(rays: Floats, slopes: Floats, q: Floats, floor: float, early: bool, weights: Floats) -> float:
    """Weigh the points by how far from the cone they lie; the standard deviation of the good ones, px.

    Early on by the inverse of their distance (least absolute values), since a finger along the rim can tilt the first
    cone so far that the biweight would believe the finger.
    """
    n, count = rays.shape[0], 0
    errors, order = np.empty(n), np.empty(n)
    for i in range(n):
        if rays[i, 2] > 0.0:
            fall = slopes[i, 0] * q[0] + slopes[i, 1] * q[1] + slopes[i, 2] * q[2]
            errors[i] = (rays[i, 0] * q[0] + rays[i, 1] * q[1] + rays[i, 2] * q[2] - 1.0) / fall
            order[count] = abs(errors[i])
            count += 1
    sigma = max(1.4826 * float(np.median(order[:count])) * math.sqrt(count / (count - 3.0)), floor)
    for i in range(n):
        weights[i] = 0.0
        if rays[i, 2] > 0.0:
            z = errors[i] / (CUT * sigma)
            if early:
                weights[i] = sigma / max(abs(errors[i]), sigma)
            else:
                weights[i] = (1.0 - z * z) ** 2 if z * z < 1.0 else 0.0
    return sigma


@kernel
def _respond(
    rays: Floats, slopes: Floats, weights: Floats, q: Floats, inverse: Floats, moved: Floats, response: Floats
) -> None:
    """How q answers when every point moves outward by `moved` px, one column for each of its columns."""
    sums = np.zeros((3, moved.shape[1]))
    for i in range(rays.shape[0]):
        if weights[i] > 0.0:
            fall = slopes[i, 0] * q[0] + slopes[i, 1] * q[1] + slopes[i, 2] * q[2]
            for k in range(moved.shape[1]):
                for j in range(3):
                    sums[j, k] -= weights[i] * rays[i, j] / fall * moved[i, k]
    for k in range(moved.shape[1]):
        for j in range(3):
            response[j, k] = inverse[j, 0] * sums[0, k] + inverse[j, 1] * sums[1, k] + inverse[j, 2] * sums[2, k]


@kernel
def _lens_moves(
    intrinsics: Floats, spread: Floats, points: Floats, rays: Floats, slopes: Floats, q: Floats, moved: Floats
) -> None:
    """By how many px every point seems to move outward per unit of each number of the camera."""
    other, ray = intrinsics.copy(), np.empty(3)
    for k in range(9):
        moved[:, k] = 0.0
        if not spread[k, k] > 0.0:
            continue
        step = min(0.1 * math.sqrt(spread[k, k]), 0.5 if k < 4 else 1e-3)
        other[k] = intrinsics[k] + step
        widest = fold(other[4], other[5], other[8])
        for i in range(points.shape[0]):
            if rays[i, 2] > 0.0 and _ray(other, widest, points[i, 0], points[i, 1], ray):
                fall, rise = 0.0, 0.0
                for j in range(3):
                    fall += slopes[i, j] * q[j]
                    rise += (ray[j] - rays[i, j]) * q[j]
                moved[i, k] = rise / (step * fall)
        other[k] = intrinsics[k]


@kernel
def fit_cone(
    intrinsics: Floats,
    camera_spread: Floats,
    points: Floats,
    x: float,
    y: float,
    shift: float,
    robust: bool,
    spread: Floats,
    inflation: float,
    floor: float,
    radius: float,
    position: Floats,
    covariance: Floats,
) -> tuple[int, float, float]:
    """Fit the cone to points of the outline and place the ball in it.

    Parameters
    ----------
    intrinsics : (9,)
        See `lens.py`.
    camera_spread : (9, 9) or (0, 0)
        Its covariance; empty where it is not known.
    points : (n, 2)
        Points of the outline, px.
    x, y : float
        A point well inside, px: outward is away from it.
    shift : float
        By how much the points are moved outward first, px.
    robust : bool
        Whether points may be wrong.
    spread : (3, 3)
        Covariance of an error of x, y and size that all points share, px^2.
    inflation : float
        By how much the covariance of independent points is enlarged; 0 leaves `spread` alone.
    floor : float
        Least standard deviation of a point that is believed, px.
    radius : float
        Of the ball, m.
    position, covariance : (3,), (3, 3), written
        Of the ball's center, m.

    Returns
    -------
    miss : int
        `DONE`; `FEW`: fewer than 4 points have a ray; `FLAT`: the points lie on no cone; `NEAR`: the ball all but
        touches the camera.
    noise : float
        Standard deviation of a point, px.
    share : float
        Sum of the weights, as a share of the points.
    """
    n = points.shape[0]
    rays, slopes, outward = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
    weights, q, last = np.zeros(n), np.zeros(3), np.zeros(3)
    normal, inverse = np.zeros((3, 3)), np.zeros((3, 3))
    if _see(intrinsics, points, x, y, shift, outward, rays, slopes) < 4:
        return FEW, 0.0, 0.0
    for i in range(n):
        weights[i] = 1.0 if rays[i, 2] > 0.0 else 0.0
        q += rays[i]
    q *= 1.0 / math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    noise = 0.0
    for turn in range(ROUNDS):
        last[:] = q
        if not _solve(rays, slopes, weights, q, normal, inverse):
            return FLAT, 0.0, 0.0
        change = abs(q[0] - last[0]) + abs(q[1] - last[1]) + abs(q[2] - last[2])
        if turn > (EARLY if robust else 1) and change < 1e-10 + (1e-4 if robust else 1e-8) * math.sqrt(
            inverse[0, 0] + inverse[1, 1]
        ):
            break
        if robust:
            noise = _weigh(rays, slopes, q, floor, turn < EARLY, weights)
    square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - 1.0
    if not square > 1e-12:
        return FLAT, 0.0, 0.0
    if square > NEAREST * NEAREST * (1.0 + square) or not q[2] > 0.0:
        return NEAR, 0.0, 0.0
    scale, turned = radius / math.sqrt(square), np.empty((3, 3))
    for j in range(3):
        position[j] = scale * q[j]
        for k in range(3):
            turned[j, k] = scale * ((j == k) - q[j] * q[k] / square)
    covariance[:] = 0.0
    own, response = np.zeros((3, 3)), np.zeros((3, 3))
    for j in range(3):
        for k in range(3):
            own[j, k] = inflation * noise * noise * inverse[j, k]
    _respond(rays, slopes, weights, q, inverse, outward, response)
    add_spread(response, spread, own)
    if camera_spread.shape[0] == 9:
        moved, answer = np.zeros((n, 9)), np.zeros((3, 9))
        _lens_moves(intrinsics, camera_spread, points, rays, slopes, q, moved)
        _respond(rays, slopes, weights, q, inverse, moved, answer)
        add_spread(answer, camera_spread, own)
    add_spread(turned, own, covariance)
    return DONE, noise, weights.sum() / n
