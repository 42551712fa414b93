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

from matchset.camera.lens import bend, fold, undistort
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import add_spread, apply, invert, length

Floats = npt.NDArray[np.float64]

ROUNDS = 16
EARLY = 6  # rounds of least absolute values before the biweight
CUT = 4.7  # standard deviations at which Tukey's biweight gives up a point
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
    intrinsics: Floats, points: Floats, x: float, y: float, shift: float, kept: Floats, rays: Floats, slopes: Floats
) -> int:
    """Write the points that have a ray with their outward normals, their rays, shifted outward, and these' slopes.

    A slope is the change of a ray per px along the normal. Returns how many points there are.
    """
    widest, seen = fold(intrinsics[4], intrinsics[5], intrinsics[8]), 0
    across, down = 1.0 / intrinsics[0], 1.0 / intrinsics[1]
    for i in range(points.shape[0]):
        nx, ny = points[i, 0] - x, points[i, 1] - y
        far = math.sqrt(nx * nx + ny * ny)
        if not 1e-6 < far < 1e9:
            continue
        nx, ny = nx / far, ny / far
        u, v, found = undistort(intrinsics, widest, points[i, 0] + shift * nx, points[i, 1] + shift * ny)
        xx, xy, yy = bend(intrinsics, u, v)
        area = xx * yy - xy * xy
        if not (found and area > 0.0):
            continue
        right, under = across * nx / area, down * ny / area
        du, dv = yy * right - xy * under, xx * under - xy * right
        square = 1.0 / (u * u + v * v + 1.0)
        scale, fade = math.sqrt(square), square * (u * du + v * dv)
        rays[0, seen], rays[1, seen], rays[2, seen] = u * scale, v * scale, scale
        slopes[0, seen], slopes[1, seen] = scale * (du - u * fade), scale * (dv - v * fade)
        slopes[2, seen] = -scale * fade
        kept[seen, 0], kept[seen, 1], kept[seen, 2] = nx, ny, 1.0
        kept[seen, 3], kept[seen, 4] = points[i, 0], points[i, 1]
        seen += 1
    return seen


@kernel(refcount=False, reassociate=True)
def _fall(slopes: Floats, q: Floats, falls: Floats) -> None:
    """By how much r.q changes per px outward, at every point."""
    x, y, z, q0, q1, q2 = slopes[0], slopes[1], slopes[2], q[0], q[1], q[2]
    for place in range(falls.shape[0]):
        i = np.uintp(place)
        falls[i] = x[i] * q0 + y[i] * q1 + z[i] * q2


@kernel(refcount=False, reassociate=True)
def _err(rays: Floats, q: Floats, falls: Floats, errors: Floats, order: Floats) -> None:
    """How far every point lies outside the cone, px, and the same without its sign."""
    x, y, z, q0, q1, q2 = rays[0], rays[1], rays[2], q[0], q[1], q[2]
    for place in range(falls.shape[0]):
        i = np.uintp(place)
        errors[i] = (x[i] * q0 + y[i] * q1 + z[i] * q2 - 1.0) / falls[i]
    for place in range(falls.shape[0]):
        order[np.uintp(place)] = abs(errors[np.uintp(place)])


@kernel(refcount=False, reassociate=True)
def _add(rays: Floats, falls: Floats, weights: Floats, normal: Floats, b: Floats) -> None:
    """Write the normal equations of q."""
    x, y, z = rays[0], rays[1], rays[2]
    xx = xy = xz = yy = yz = zz = bx = by = bz = 0.0
    for place in range(falls.shape[0]):
        i = np.uintp(place)
        w = weights[i] / (falls[i] * falls[i])
        wx, wy, wz = w * x[i], w * y[i], w * z[i]
        xx, xy, xz = xx + wx * x[i], xy + wx * y[i], xz + wx * z[i]
        yy, yz, zz = yy + wy * y[i], yz + wy * z[i], zz + wz * z[i]
        bx, by, bz = bx + wx, by + wy, bz + wz
    normal[0, 0], normal[0, 1], normal[0, 2], normal[1, 1], normal[1, 2], normal[2, 2] = xx, xy, xz, yy, yz, zz
    b[0], b[1], b[2] = bx, by, bz


@kernel
def _solve(rays: Floats, falls: Floats, weights: Floats, q: Floats, inverse: Floats) -> bool:
    """Weighted least squares for q; the inverse of the normal matrix is that of px."""
    normal, b = np.empty((3, 3)), np.empty(3)
    _add(rays, falls, weights, normal, b)
    if not invert(normal, inverse):
        return False
    apply(inverse, b, q)
    return bool(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] > 1.0)


@kernel
def _weigh(errors: Floats, order: Floats, floor: float, early: bool, weights: Floats) -> float:
    """Weigh the points by how far from the cone they lie; the standard deviation of the good ones, px.

    Early on by the inverse of their distance (least absolute values), since a finger along the rim can tilt the first
    cone so far that the biweight would believe the finger.
    """
    count = errors.shape[0]
    sigma = max(1.4826 * float(np.median(order)) * math.sqrt(count / (count - 3.0)), floor)
    unit = 1.0 / (CUT * sigma)
    if early:
        for place in range(count):
            far = abs(errors[np.uintp(place)])
            weights[np.uintp(place)] = sigma / (far if far > sigma else sigma)
    else:
        for place in range(count):
            z = errors[np.uintp(place)] * unit
            left = 1.0 - z * z
            left = left if left > 0.0 else 0.0
            weights[np.uintp(place)] = left * left
    return sigma


@kernel
def _respond(rays: Floats, falls: Floats, weights: Floats, inverse: Floats, moved: Floats, response: Floats) -> None:
    """How q answers when every point moves outward by `moved` px, one column for each of its columns."""
    sums = np.zeros((3, response.shape[1]))
    for i in range(falls.shape[0]):
        if weights[i] > 0.0:
            w = weights[i] / falls[i]
            for k in range(response.shape[1]):
                for j in range(3):
                    sums[j, k] -= w * rays[j, i] * moved[i, k]
    for k in range(response.shape[1]):
        for j in range(3):
            response[j, k] = inverse[j, 0] * sums[0, k] + inverse[j, 1] * sums[1, k] + inverse[j, 2] * sums[2, k]


@kernel
def _lens_moves(
    intrinsics: Floats, spread: Floats, kept: Floats, rays: Floats, falls: Floats, q: Floats, moved: Floats
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
        for i in range(falls.shape[0]):
            if _ray(other, widest, kept[i, 3], kept[i, 4], ray):
                rise = 0.0
                for j in range(3):
                    rise += (ray[j] - rays[j, i]) * q[j]
                moved[i, k] = rise / (step * falls[i])
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
    kept, every = np.empty((n, 5)), np.empty((8, n))
    seen = _see(intrinsics, points, x, y, shift, kept, every[0:3], every[3:6])
    if seen < 4:
        return FEW, 0.0, 0.0
    rays, slopes, falls, errors = every[0:3, :seen], every[3:6, :seen], every[6, :seen], every[7, :seen]
    weights, order, q, last, inverse = np.ones(seen), np.empty(seen), np.empty(3), np.empty(3), np.empty((3, 3))
    for j in range(3):
        q[j] = rays[j].sum()
    q *= 1.0 / length(q)
    noise = 0.0
    _fall(slopes, q, falls)
    for turn in range(ROUNDS):
        last[:] = q
        if not _solve(rays, falls, weights, q, inverse):
            return FLAT, 0.0, 0.0
        _fall(slopes, q, falls)
        change = abs(q[0] - last[0]) + abs(q[1] - last[1]) + abs(q[2] - last[2])
        if turn > (EARLY if robust else 1) and change < 1e-10 + (1e-4 if robust else 1e-8) * math.sqrt(
            inverse[0, 0] + inverse[1, 1]
        ):
            break
        if robust:
            _err(rays, q, falls, errors, order)
            noise = _weigh(errors, order, floor, turn < EARLY, weights)
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
    _respond(rays, falls, weights, inverse, kept, response)
    add_spread(response, spread, own)
    if camera_spread.shape[0] == 9:
        moved, answer = np.zeros((seen, 9)), np.zeros((3, 9))
        _lens_moves(intrinsics, camera_spread, kept, rays, falls, q, moved)
        _respond(rays, falls, weights, inverse, moved, answer)
        add_spread(answer, camera_spread, own)
    add_spread(turned, own, covariance)
    return DONE, noise, weights.sum() / n
