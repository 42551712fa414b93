"""The tangent cone of a ball, fitted to the rays of its outline.

A ray r (unit vector) touches the sphere with center p and radius R where r.p = |p| cos(alpha), sin(alpha) = R / |p|.
With q = p / (|p| cos(alpha)) that is ``r.q = 1``: linear in q, for any angle off the axis, and
``p = R q / sqrt(q.q - 1)``. The residual of a point is ``e = (r.q - 1) / (dr/dn . q)`` px, positive outside the
outline; dr/dn is the change of its ray per px along the outward normal. Squares of px are summed, so a point counts
the same everywhere in the image. Only these points are undistorted, never the image.

Weights: iteratively reweighted least squares, first with least absolute values, then with Tukey's biweight.
"""

import enum
import math
from typing import Annotated, Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.lens import bend, fold, undistort
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import add_propagated_covariance, invert_3x3, norm, transform
from matchset.numeric.record import record_dtype

Floats = npt.NDArray[np.float64]


class BallParameters(msgspec.Struct, frozen=True):
    """How the center of a ball is estimated from its outline.

    Parameters
    ----------
    edge_shift_px : float
        By how much the outline lies outside its edge points. A ball gets darker or brighter toward its rim, which pulls
        edges inward by 0.03 to 0.07 px in rendered rooms; flat discs by 0.005. The default is between the two; 0.1 px
        too much is 0.25 % of range at a radius of 40 px. To set it, hold the ball at two or more taped distances.
        Chosen in: decision 015.
    min_points : int
        Edge points from which the cone is fitted to them; with fewer it is fitted to the circle of the track. Chosen
        by hand; `python -m benchmarks --only localization_range` would show a change.
    inflation : float
        Factor on the covariance of independent edge points, because the errors of neighbors are correlated: larger is
        safer. Chosen in: decision 015; `python -m benchmarks --only localization_covariance` would show a change.
    min_sigma_px : float
        Smallest standard deviation of an edge point that the weights assume. Chosen by hand: below it lie rounding and
        the table of the edges.
    center_sigma_px, size_sigma_px : float
        Standard deviation of an error of center and radius that all edge points share (shading, blur, the grid of
        pixels). Chosen in: decision 015; `python -m benchmarks --only localization_covariance` would show a change.
    field_share : float
        The same in an interlaced picture, along the offset of its fields and as a share of it; that of the radius has
        half the variance. As `QualityParameters.field_share`.
    iterations : int
        Most rounds of reweighting. Chosen by hand: 14 are typical (docs/log/speed.md#processing).
    absolute_iterations : int
        Rounds of least absolute values before the biweight. With 0, 3 and 6 rounds twelve wrong points of 64 bias the
        range by 1.0, 0.6 and below 0.1 % (docs/log/localization.md#meters).
    biweight_cutoff : float
        Residual, in standard deviations, from which Tukey's biweight is zero. 4.685 is 95 % efficient for normal
        errors (Huber & Ronchetti, Robust Statistics); rounded.
    tolerance : float
        Change of q, as a share of its standard deviation, that ends the iteration. 1e-3 saves 2 us and moves positions
        by 7e-5 m (docs/log/speed.md#processing).
    max_sine : float
        Largest sine of the cone's half-angle, R / distance: above it the ball all but touches the camera. Chosen by
        hand; tests/localization/test_cone.py would show a change.
    """

    edge_shift_px: float = 0.025
    min_points: int = 12
    inflation: float = 2.5
    min_sigma_px: float = 0.02
    center_sigma_px: float = 0.014
    size_sigma_px: float = 0.025
    field_share: float = 0.1
    iterations: int = 16
    absolute_iterations: int = 6
    biweight_cutoff: float = 4.7
    tolerance: float = 1e-4
    max_sine: float = 0.97


class ConeFit:
    """Workspace of `fit_cone`."""

    limits: BallParameters
    radius: float  # of the ball, m
    intrinsics: Annotated[Floats, (9,), "f8"]  # see `lens.py`
    intrinsics_uncertain: bool  # whether one of them is
    camera_steps: Annotated[Floats, (9,), "f8"]  # of derivatives to them, px or no unit; 0 where one is exact
    inside: Annotated[Floats, (2,), "f8"]  # a point well inside the outline, px: outward is away from it
    robust: bool  # whether points may be wrong
    shared_covariance: Annotated[Floats, (3, 3), "f8"]  # of an error of x, y, size common to all points, px^2
    # what is found
    q: Annotated[Floats, (3,), "f8"]
    normal: Annotated[Floats, (3, 3), "f8"]  # normal matrix of q, upper triangle
    right_side: Annotated[Floats, (3,), "f8"]
    inverse: Annotated[Floats, (3, 3), "f8"]  # of the normal matrix
    noise_px: float  # standard deviation of a point
    position: Annotated[Floats, (3,), "f8"]  # of the ball's center, camera frame, m
    covariance: Annotated[Floats, (3, 3), "f8"]  # of the position, m^2, without camera and radius
    camera_slope: Annotated[Floats, (3, 9), "f8"]  # of the position to the intrinsics, m per unit; 0 for exact ones


CONE = record_dtype(ConeFit)


class ConeFailure(enum.IntEnum):
    """Why there is no position."""

    NONE = 0
    TOO_FEW_RAYS = 1  # fewer than 4 points have a ray
    NO_CONE = 2  # the points lie on no cone
    TOO_NEAR = 3  # the ball touches the camera, or is behind it


class OutlineRays(NamedTuple):
    """Rays of the n points of an outline that have one."""

    x: Floats  # (n,), of the unit vectors
    y: Floats
    z: Floats
    dx: Floats  # (n,), their change per px along the outward normal
    dy: Floats
    dz: Floats
    gradient: Floats  # (n,), change of r.q per px outward
    residual: Floats  # (n,), px outside the cone
    distance: Floats  # (n,), its absolute value
    weight: Floats  # (n,)
    pixels: Floats  # (n, 2), the points as shifted, px
    outward: Floats  # (n, 3), px by which a point moves outward per px of an error of x, y and size


@kernel
def undistort_points(fit: Any, points: Floats) -> OutlineRays:
    """Rays of the points, shifted outward by `edge_shift_px`, and their derivatives; points without a ray are left out.

    Parameters
    ----------
    fit : record of `ConeFit`
    points : (n, 2)
        px.
    """
    n, seen = points.shape[0], 0
    table, pixels, outward = np.empty((9, n)), np.empty((n, 2)), np.empty((n, 3))
    k, shift = fit.intrinsics[:], fit.limits.edge_shift_px
    widest = fold(k[4], k[5], k[8])
    for i in range(n):
        nx, ny = points[i, 0] - fit.inside[0], points[i, 1] - fit.inside[1]
        far = math.sqrt(nx * nx + ny * ny)
        if not 1e-6 < far < 1e9:
            continue
        nx, ny = nx / far, ny / far
        x, y = points[i, 0] + shift * nx, points[i, 1] + shift * ny
        u, v, found = undistort(k, widest, x, y)
        xx, xy, yy = bend(k, u, v)
        area = xx * yy - xy * xy
        if not (found and area > 0.0):
            continue
        right, under = (1.0 / k[0]) * nx / area, (1.0 / k[1]) * ny / area
        du, dv = yy * right - xy * under, xx * under - xy * right
        square = 1.0 / (u * u + v * v + 1.0)
        scale, fade = math.sqrt(square), square * (u * du + v * dv)
        table[0, seen], table[1, seen], table[2, seen] = u * scale, v * scale, scale
        table[3, seen], table[4, seen], table[5, seen] = scale * (du - u * fade), scale * (dv - v * fade), -scale * fade
        pixels[seen, 0], pixels[seen, 1] = x, y
        outward[seen, 0], outward[seen, 1], outward[seen, 2] = nx, ny, 1.0
        seen += 1
    return OutlineRays(
        table[0, :seen],
        table[1, :seen],
        table[2, :seen],
        table[3, :seen],
        table[4, :seen],
        table[5, :seen],
        table[6, :seen],
        table[7, :seen],
        table[8, :seen],
        np.ones(seen),
        pixels[:seen],
        outward[:seen],
    )


@kernel(refcount=False, reassociate=True)
def gradients(rays: OutlineRays, q: Floats) -> None:
    """Change of r.q per px outward, at every point."""
    dx, dy, dz, gradient, q0, q1, q2 = rays.dx, rays.dy, rays.dz, rays.gradient, q[0], q[1], q[2]
    for place in range(gradient.shape[0]):
        i = np.uintp(place)
        gradient[i] = dx[i] * q0 + dy[i] * q1 + dz[i] * q2


@kernel(refcount=False, reassociate=True)
def residuals(rays: OutlineRays, q: Floats) -> None:
    """Residual of every point, px outside the cone, and its absolute value."""
    x, y, z, q0, q1, q2 = rays.x, rays.y, rays.z, q[0], q[1], q[2]
    gradient, residual, distance = rays.gradient, rays.residual, rays.distance
    for place in range(gradient.shape[0]):
        i = np.uintp(place)
        residual[i] = (x[i] * q0 + y[i] * q1 + z[i] * q2 - 1.0) / gradient[i]
    for place in range(gradient.shape[0]):
        distance[np.uintp(place)] = abs(residual[np.uintp(place)])


@kernel(refcount=False, reassociate=True)
def normal_equations(rays: OutlineRays, normal: Floats, right_side: Floats) -> None:
    """Write the weighted normal equations of q."""
    x, y, z, gradient, weight = rays.x, rays.y, rays.z, rays.gradient, rays.weight
    xx = xy = xz = yy = yz = zz = bx = by = bz = 0.0
    for place in range(gradient.shape[0]):
        i = np.uintp(place)
        w = weight[i] / (gradient[i] * gradient[i])
        wx, wy, wz = w * x[i], w * y[i], w * z[i]
        xx, xy, xz = xx + wx * x[i], xy + wx * y[i], xz + wx * z[i]
        yy, yz, zz = yy + wy * y[i], yz + wy * z[i], zz + wz * z[i]
        bx, by, bz = bx + wx, by + wy, bz + wz
    normal[0, 0], normal[0, 1], normal[0, 2], normal[1, 1], normal[1, 2], normal[2, 2] = xx, xy, xz, yy, yz, zz
    right_side[0], right_side[1], right_side[2] = bx, by, bz


@kernel
def reweight(rays: OutlineRays, limits: Any, absolute: bool) -> float:
    """Weights of the points by their residuals; returns the standard deviation of the inliers, px.

    `absolute` weights are the inverse of the distance (least absolute values): wrong points along a part of the rim can
    tilt the first cone so far that the biweight would keep them instead of the others.
    """
    residual, weight, count = rays.residual, rays.weight, rays.residual.shape[0]
    # 1.4826 = 1 / Phi^-1(3/4) makes the median absolute deviation consistent for normal errors.
    sigma = 1.4826 * float(np.median(rays.distance)) * math.sqrt(count / (count - 3.0))
    sigma = max(sigma, float(limits.min_sigma_px))
    unit = 1.0 / (limits.biweight_cutoff * sigma)
    if absolute:
        for place in range(count):
            far = abs(residual[np.uintp(place)])
            weight[np.uintp(place)] = sigma / (far if far > sigma else sigma)
    else:
        for place in range(count):
            z = residual[np.uintp(place)] * unit
            left = 1.0 - z * z
            left = left if left > 0.0 else 0.0
            weight[np.uintp(place)] = left * left
    return sigma


@kernel
def _iterate(fit: Any, rays: OutlineRays) -> bool:
    """Find q by iteratively reweighted least squares; False if there is no unique answer."""
    q, inverse, limits, robust = fit.q[:], fit.inverse[:], fit.limits, fit.robust != 0
    q[0], q[1], q[2] = rays.x.sum(), rays.y.sum(), rays.z.sum()
    scale = 1.0 / norm(q)
    for j in range(3):
        q[j] *= scale
    fit.noise_px = 0.0
    gradients(rays, q)
    for turn in range(limits.iterations):
        x, y, z = q[0], q[1], q[2]
        normal_equations(rays, fit.normal[:], fit.right_side[:])
        if not invert_3x3(fit.normal[:], inverse):
            return False
        transform(inverse, fit.right_side[:], q)
        if not q[0] * q[0] + q[1] * q[1] + q[2] * q[2] > 1.0:
            return False
        gradients(rays, q)
        change = abs(q[0] - x) + abs(q[1] - y) + abs(q[2] - z)
        tolerance = limits.tolerance if robust else limits.tolerance * limits.tolerance
        enough = limits.absolute_iterations if robust else 1
        if turn > enough and change < 1e-10 + tolerance * math.sqrt(inverse[0, 0] + inverse[1, 1]):
            break
        if robust:
            residuals(rays, q)
            fit.noise_px = reweight(rays, limits, turn < limits.absolute_iterations)
    return True


@kernel
def propagate(fit: Any, rays: OutlineRays, moved: Floats) -> Floats:
    """Jacobian of q, (3, k), to k numbers that move every point outward by `moved` px, (n, k), per unit."""
    weight, gradient, inverse, columns = rays.weight, rays.gradient, fit.inverse, moved.shape[1]
    sums = np.zeros((3, columns))
    for i in range(gradient.shape[0]):
        if weight[i] > 0.0:
            w = weight[i] / gradient[i]
            for k in range(columns):
                sums[0, k] -= w * rays.x[i] * moved[i, k]
                sums[1, k] -= w * rays.y[i] * moved[i, k]
                sums[2, k] -= w * rays.z[i] * moved[i, k]
    for k in range(columns):
        x, y, z = sums[0, k], sums[1, k], sums[2, k]
        for j in range(3):
            sums[j, k] = inverse[j, 0] * x + inverse[j, 1] * y + inverse[j, 2] * z
    return sums


@kernel
def camera_jacobian(fit: Any, rays: OutlineRays) -> Floats:
    """By how many px every point seems to move outward per unit of each of the nine intrinsics, (n, 9)."""
    other, q = fit.intrinsics[:].copy(), fit.q
    moved = np.zeros((rays.gradient.shape[0], 9))
    for k in range(9):
        step = fit.camera_steps[k]
        if not step > 0.0:
            continue
        other[k] = fit.intrinsics[k] + step
        widest = fold(other[4], other[5], other[8])
        for i in range(rays.gradient.shape[0]):
            u, v, seen = undistort(other, widest, rays.pixels[i, 0], rays.pixels[i, 1])
            if seen:
                scale = 1.0 / math.sqrt(u * u + v * v + 1.0)
                rise = (u * scale - rays.x[i]) * q[0] + (v * scale - rays.y[i]) * q[1] + (scale - rays.z[i]) * q[2]
                moved[i, k] = rise / (step * rays.gradient[i])
        other[k] = fit.intrinsics[k]
    return moved


@kernel
def _write_covariance(fit: Any, rays: OutlineRays, slope: Floats) -> None:
    """Covariance of the position: of independent points, of what they share; apart, its slopes to the camera's numbers.

    `slope` is dp/dq.
    """
    own = np.zeros((3, 3))
    for j in range(3):
        for k in range(3):
            own[j, k] = fit.limits.inflation * fit.noise_px * fit.noise_px * fit.inverse[j, k]
    add_propagated_covariance(propagate(fit, rays, rays.outward), fit.shared_covariance[:], own)
    covariance = fit.covariance[:]
    covariance[:] = 0.0
    add_propagated_covariance(slope, own, covariance)
    if fit.intrinsics_uncertain != 0:
        jacobian = propagate(fit, rays, camera_jacobian(fit, rays))
        for j in range(3):
            for k in range(9):
                total = 0.0
                for m in range(3):
                    total += slope[j, m] * jacobian[m, k]
                fit.camera_slope[j, k] = total


@kernel
def fit_cone(fit: Any, points: Floats) -> int:
    """Fit the tangent cone to points of the outline and place the ball in it.

    Parameters
    ----------
    fit : record of `ConeFit`, written
    points : (n, 2)
        Points of the outline, px.

    Returns
    -------
    int
        One of `ConeFailure`.
    """
    rays = undistort_points(fit, points)
    if rays.x.shape[0] < 4:
        return ConeFailure.TOO_FEW_RAYS.value
    if not _iterate(fit, rays):
        return ConeFailure.NO_CONE.value
    q = fit.q
    square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - 1.0
    if not square > 1e-12:
        return ConeFailure.NO_CONE.value
    if square > fit.limits.max_sine * fit.limits.max_sine * (1.0 + square) or not q[2] > 0.0:
        return ConeFailure.TOO_NEAR.value
    scale, slope = fit.radius / math.sqrt(square), np.empty((3, 3))
    for j in range(3):
        fit.position[j] = scale * q[j]
        for k in range(3):
            slope[j, k] = scale * ((j == k) - q[j] * q[k] / square)
    _write_covariance(fit, rays, slope)
    return ConeFailure.NONE.value
