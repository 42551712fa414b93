"""From markers in the image to the rotation of the ball.

A marker's pixel gives its ray, and the ray cut with the sphere its direction s from the ball's center (camera frame).
Two or more markers give the rotation R that minimizes ``sum (s - R b)^T W (s - R b)`` (Wahba's problem with full
weights): b is a marker's place in the ball frame, W the inverse of the covariance of s across s. One marker leaves the
rotation about it open; if both vehicles are level it follows.
"""

import math
from typing import Annotated, Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.lens import fold, undistort
from matchset.localization.ball_target import MOST_MARKERS
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import cross, invert_3x3, transform
from matchset.numeric.record import record_dtype
from matchset.numeric.rotation import rotate

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class AttitudeParameters(msgspec.Struct, frozen=True):
    """How markers become a rotation, and which marker is which.

    Costs are squared standard deviations, as they are in the sum that is minimized.

    Parameters
    ----------
    tilt_sigma : float
        Standard deviation of the tilt of "level" vehicles against each other, rad: what one marker leaves open. Chosen
        by hand; `python -m benchmarks --only localization_covariance` would show a change.
    marker_sigma : float
        Standard deviation of where the markers sit on the ball, rad. Chosen by hand: 1.4 mm on a ball of 0.28 m.
    min_margin : float
        By how much the cost of the best assignment must be below that of the best one with another rotation; otherwise
        the rotation counts as not observed. Chosen by hand; `python -m benchmarks --only localization_markers` would
        show a change, as for all that follow.
    max_cost : float
        Largest cost per marker of an assignment that is used.
    unmatched_cost : float
        Cost of a marker in the image that is assigned to none of the ball's.
    missing_cost : float
        Cost of a marker of the ball that should be in sight and is not.
    visible_cosine : float
        A marker should be in sight if the cosine between its direction and that to the camera is above this.
    usual_tilt, usual_turn : float
        Standard deviation of the tilt of a ball without a previous rotation, and of the rotation since the previous
        frame, rad.
    distinct_angle : float
        Angle between two rotations from which they are different answers, rad.
    pair_tolerance : float
        By how much the angle between two markers may differ from that of the target, rad; others are not tried.
    min_cosine : float
        Least cosine between a marker's direction and the line of sight: a ray that grazes the ball fixes no direction.
    min_sine_squared : float
        Least squared sine between two directions that fix a rotation together.
    iterations : int
        Most Gauss-Newton steps; they converge quadratically from a rotation that is already near.
    tolerance : float
        Size of the last of them, rad.
    pixel_step, distance_step : float
        Steps of the central differences for derivatives: px, and a share of the ball's distance.
    """

    tilt_sigma: float = 0.1
    marker_sigma: float = 0.01
    min_margin: float = 3.5
    max_cost: float = 25.0
    unmatched_cost: float = 20.0
    missing_cost: float = 4.0
    visible_cosine: float = 0.7
    usual_tilt: float = 0.3
    usual_turn: float = 0.2
    distinct_angle: float = 0.15
    pair_tolerance: float = 0.35
    min_cosine: float = 0.2
    min_sine_squared: float = 0.02
    iterations: int = 5
    tolerance: float = 1e-6
    pixel_step: float = 0.1
    distance_step: float = 1e-4


class AttitudeFit:
    """Workspace of `estimate_rotation` (`marker_identification.py`); rows of arrays are markers."""

    limits: AttitudeParameters
    intrinsics: Annotated[Floats, (9,), "f8"]  # see `lens.py`
    rim_distance: float  # from the ball's center to the middle of a marker's rim, m
    body_count: int
    bodies: Annotated[Floats, (MOST_MARKERS, 3), "f8"]  # the target's markers, unit vectors, ball frame
    last_rotation: Annotated[Floats, (3, 3), "f8"]
    last_known: bool  # whether there is one, and recent
    camera_steps: Annotated[Floats, (9,), "f8"]  # of derivatives to the intrinsics; 0 where one is exact
    # of the frame
    pixel_count: int
    pixels: Annotated[Floats, (MOST_MARKERS, 2), "f8"]  # middles of the markers' rims, px
    pixel_covariances: Annotated[Floats, (MOST_MARKERS, 2, 2), "f8"]  # px^2
    position: Annotated[Floats, (3,), "f8"]  # of the ball's center, camera frame, m
    position_covariance: Annotated[Floats, (3, 3), "f8"]  # m^2, without camera and diameter
    position_slope: Annotated[Floats, (3, 9), "f8"]  # of the position to the intrinsics, m per unit
    # directions s of the markers that meet the ball
    count: int
    sources: Annotated[Ints, (MOST_MARKERS,), "i8"]  # rows of `pixels`
    directions: Annotated[Floats, (MOST_MARKERS, 3), "f8"]
    covariances: Annotated[Floats, (MOST_MARKERS, 3, 3), "f8"]
    weights: Annotated[Floats, (MOST_MARKERS, 3, 3), "f8"]  # W
    position_jacobians: Annotated[Floats, (MOST_MARKERS, 3, 3), "f8"]  # ds/dp, per m
    # the rotation vector's derivatives, of the last assignment that was fitted
    gains: Annotated[Floats, (MOST_MARKERS, 3, 3), "f8"]  # to each direction
    tilt_axis: Annotated[
        Floats, (3,), "f8"
    ]  # to a tilt of one vehicle against the other; zero for two markers and more
    lever: Annotated[Floats, (MOST_MARKERS, 3, 3), "f8"]
    # what is found
    rotation: Annotated[Floats, (3, 3), "f8"]  # from the ball frame to the camera frame
    rotation_covariance: Annotated[Floats, (3, 3), "f8"]  # of the rotation vector, rad^2
    cross_covariance: Annotated[Floats, (3, 3), "f8"]  # of the rotation vector with the position, rad m
    rotation_slope: Annotated[Floats, (3, 9), "f8"]  # of the rotation vector to the intrinsics, rad per unit


ATTITUDE = record_dtype(AttitudeFit)


@kernel(refcount=False)
def _sphere_direction(fit: Any, x: float, y: float, position: Floats, out: Floats) -> bool:
    """Write the unit vector from `position` to where the ray of a pixel first meets the sphere of the rims' middles."""
    k, reach = fit.intrinsics[:], fit.rim_distance
    u, v, seen = undistort(k, fold(k[4], k[5], k[8]), x, y)
    if not seen:
        return False
    scale = 1.0 / math.sqrt(u * u + v * v + 1.0)
    rx, ry, rz = u * scale, v * scale, scale
    along = rx * position[0] + ry * position[1] + rz * position[2]
    square = position[0] ** 2 + position[1] ** 2 + position[2] ** 2
    depth = along * along - square + reach * reach
    if not depth > (fit.limits.min_cosine * reach) ** 2:
        return False
    t = along - math.sqrt(depth)
    out[0] = (t * rx - position[0]) / reach
    out[1] = (t * ry - position[1]) / reach
    out[2] = (t * rz - position[2]) / reach
    return True


@kernel
def marker_direction(fit: Any, x: float, y: float, direction: Floats, jacobian: Floats) -> bool:
    """Direction of a marker from the ball's center: its ray, cut with the sphere.

    Parameters
    ----------
    fit : record of `AttitudeFit`
        `intrinsics`, `position` and `rim_distance` are read.
    x, y : float
        Middle of the marker's rim in the image, px.
    direction : (3,), written
        Unit vector, camera frame.
    jacobian : (3, 5), written
        Its derivatives to x, y (per px) and to the position (per m).

    Returns
    -------
    bool
        Whether the ray meets the ball well inside its outline.
    """
    moved, one, other = fit.position[:].copy(), np.empty(3), np.empty(3)
    if not _sphere_direction(fit, x, y, moved, direction):
        return False
    far = math.sqrt(moved[0] ** 2 + moved[1] ** 2 + moved[2] ** 2)
    for k in range(5):
        step = fit.limits.pixel_step if k < 2 else fit.limits.distance_step * far
        dx, dy = (step if k == 0 else 0.0), (step if k == 1 else 0.0)
        if k > 1:
            moved[k - 2] = fit.position[k - 2] + step
        if not _sphere_direction(fit, x + dx, y + dy, moved, one):
            return False
        if k > 1:
            moved[k - 2] = fit.position[k - 2] - step
        if not _sphere_direction(fit, x - dx, y - dy, moved, other):
            return False
        if k > 1:
            moved[k - 2] = fit.position[k - 2]
        for m in range(3):
            jacobian[m, k] = (one[m] - other[m]) / (2.0 * step)
    return True


@kernel(entry=False)
def direction_by_camera(fit: Any, x: float, y: float, number: int, step: float, out: Floats) -> bool:
    """Write a marker's direction as if one of the intrinsics were larger by a step, which moves the ball, too."""
    moved, known = fit.position[:].copy(), fit.intrinsics[number]
    for j in range(3):
        moved[j] += step * fit.position_slope[j, number]
    fit.intrinsics[number] = known + step
    met = _sphere_direction(fit, x, y, moved, out)
    fit.intrinsics[number] = known
    return bool(met)


@kernel(refcount=False)
def _triad(first: Floats, second: Floats, min_sine_squared: float, out: Floats) -> bool:
    """Rows of a right-handed frame: z along `first`, y as near to `second` as that allows, x = y cross z."""
    dot = first[0] * second[0] + first[1] * second[1] + first[2] * second[2]
    square = 0.0
    for k in range(3):
        out[2, k] = first[k]
        out[1, k] = second[k] - dot * first[k]
        square += out[1, k] ** 2
    if not square > min_sine_squared:
        return False
    unit = 1.0 / math.sqrt(square)
    for k in range(3):
        out[1, k] *= unit
    cross(out[1], out[2], out[0])
    return True


@kernel
def rotation_from_two(bodies: Floats, seen: Floats, min_sine_squared: float, rotation: Floats) -> bool:
    """Rotation that takes one direction exactly to another, and a second one as near as that allows (TRIAD).

    Parameters
    ----------
    bodies, seen : (2, 3)
        Unit vectors: bodies[0] goes to seen[0] exactly.
    min_sine_squared : float
        See `AttitudeParameters`.
    rotation : (3, 3), written

    Returns
    -------
    bool
        False if the two directions of `bodies` or `seen` are nearly parallel.
    """
    body, there = np.empty((3, 3)), np.empty((3, 3))
    if not _triad(bodies[0], bodies[1], min_sine_squared, body):
        return False
    if not _triad(seen[0], seen[1], min_sine_squared, there):
        return False
    for j in range(3):
        for k in range(3):
            rotation[j, k] = there[0, j] * body[0, k] + there[1, j] * body[1, k] + there[2, j] * body[2, k]
    return True


@kernel
def _wahba_equations(fit: Any, who: Ints, rotation: Floats, normal: Floats, right_side: Floats) -> float:
    """Write the normal equations of the rotation vector and the levers; returns the sum of weighted squares."""
    normal[:], right_side[:], cost = 0.0, 0.0, 0.0
    model, e = np.empty(3), np.empty(3)
    weights, lever = fit.weights, fit.lever
    for i in range(fit.count):
        if who[i] < 0:
            continue
        transform(rotation, fit.bodies[who[i]], model)
        for k in range(3):
            e[k] = fit.directions[i, k] - model[k]
            # Row by row: model cross (the column k of the weights).
            lever[i, 0, k] = model[1] * weights[i, 2, k] - model[2] * weights[i, 1, k]
            lever[i, 1, k] = model[2] * weights[i, 0, k] - model[0] * weights[i, 2, k]
            lever[i, 2, k] = model[0] * weights[i, 1, k] - model[1] * weights[i, 0, k]
        for j in range(3):
            x, y, z = lever[i, j, 0], lever[i, j, 1], lever[i, j, 2]
            right_side[j] += x * e[0] + y * e[1] + z * e[2]
            normal[j, 0] += model[1] * z - model[2] * y
            normal[j, 1] += model[2] * x - model[0] * z
            normal[j, 2] += model[0] * y - model[1] * x
            for k in range(3):
                cost += e[j] * weights[i, j, k] * e[k]
    return cost


@kernel
def fit_rotation(fit: Any, who: Ints, rotation: Floats) -> float:
    """Gauss-Newton for the rotation that fits the markers best (Wahba's problem).

    Parameters
    ----------
    fit : record of `AttitudeFit`
        Its `gains` are written: how the rotation vector depends on each direction.
    who : (n,)
        Which marker of the target each direction is; -1 for none.
    rotation : (3, 3), written
        The rotation; a rough one to begin with.

    Returns
    -------
    float
        Sum of weighted squares; infinite if there is no unique answer.
    """
    normal, inverse, right_side, step, cost = np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty(3), 0.0
    for _ in range(fit.limits.iterations):
        cost = _wahba_equations(fit, who, rotation, normal, right_side)
        if not invert_3x3(normal, inverse):
            return math.inf
        transform(inverse, right_side, step)
        rotate(rotation, step)
        if abs(step[0]) + abs(step[1]) + abs(step[2]) < fit.limits.tolerance:
            break
    for i in range(fit.count):
        for j in range(3):
            for k in range(3):
                total = 0.0
                for m in range(3):
                    total += inverse[j, m] * fit.lever[i, m, k]
                fit.gains[i, j, k] = total
    return cost


@kernel
def fit_level_rotation(fit: Any, i: int, marker: int, rotation: Floats) -> bool:
    """Rotation from one marker and two level vehicles: the marker exactly, down as near to down as that allows.

    Parameters
    ----------
    fit : record of `AttitudeFit`
        Its `gains[i]` and `tilt_axis` are written.
    i, marker : int
        The direction, and which marker of the target it is.
    rotation : (3, 3), written

    Returns
    -------
    bool
        False for a marker straight above or below.
    """
    bodies, seen, other = np.empty((2, 3)), np.empty((2, 3)), np.empty((3, 3))
    direction, least = fit.directions[i], fit.limits.min_sine_squared
    for k in range(3):
        bodies[0, k], seen[0, k] = fit.bodies[marker, k], direction[k]
        bodies[1, k] = seen[1, k] = 1.0 if k == 1 else 0.0  # down
    if not rotation_from_two(bodies, seen, least, rotation):
        return False
    across = math.sqrt(max(1.0 - direction[1] * direction[1], least))
    step = fit.limits.tolerance
    for k in range(3):
        fit.tilt_axis[k] = direction[k] / across
        for m in range(3):
            seen[0, m] = direction[m] + step * ((m == k) - direction[k] * direction[m])  # along the sphere
        unit = 1.0 / math.sqrt(seen[0, 0] ** 2 + seen[0, 1] ** 2 + seen[0, 2] ** 2)
        for m in range(3):
            seen[0, m] *= unit
        if not rotation_from_two(bodies, seen, least, other):
            return False
        for m in range(3):
            p, q = (m + 1) % 3, (m + 2) % 3
            rise = 0.0
            for c in range(3):
                rise += other[q, c] * rotation[p, c] - other[p, c] * rotation[q, c]
            fit.gains[i, m, k] = 0.5 * rise / step
    return True
