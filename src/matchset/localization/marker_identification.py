"""Which marker is which: assignments of the markers in the image to those of the ball are tried, the best one is kept.

The cost of an assignment is the weighted sum of squares of its rotation, plus a prior cost: a jump since the previous
frame (or a tilt, if there is none), markers that are assigned to nothing, and markers that should be in sight and are
not. If another rotation fits nearly as well, the rotation counts as not observed.
"""

import enum
import functools
import itertools
import math
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.localization.attitude import (
    direction_by_camera,
    fit_level_rotation,
    fit_rotation,
    marker_direction,
    rotation_from_two,
)
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import add_propagated_covariance, invert_3x3, transform
from matchset.numeric.rotation import rotation_vector_between

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class RotationSource(enum.IntEnum):
    """What a rotation is taken from."""

    NONE = 0
    LEVEL = 1  # one marker, and both vehicles level
    FULL = 2  # two markers or more


@functools.cache
def assignments(seen: int, known: int) -> tuple[Ints, Ints]:
    """All ways to assign up to `seen` directions to markers of the target, or to none (-1).

    As many as possible are assigned, or one less.

    Parameters
    ----------
    seen, known : int
        How many directions, and how many markers the target has.

    Returns
    -------
    ways : ndarray of shape (c, seen), int64
    starts : ndarray of shape (seen + 2,), int64
        The ways for k directions are rows starts[k] ... starts[k + 1], of which the first k columns count.
    """
    ways: list[list[int]] = []
    starts = [0]
    for count in range(seen + 1):
        most = min(count, known)
        for named in range(max(most - 1, 1), most + 1):
            for who in itertools.combinations(range(count), named):
                for names in itertools.permutations(range(known), named):
                    way = [-1] * seen
                    for place, name in zip(who, names, strict=True):
                        way[place] = name
                    ways.append(way)
        starts.append(len(ways))
    return np.array(ways, np.int64).reshape(-1, seen), np.array(starts, np.int64)


@kernel
def measure_directions(fit: Any) -> None:
    """Directions of the markers whose ray meets the ball, with their covariances and weights.

    The covariance is that of the pixel, and of where the marker sits; that of the position is in the Jacobian.
    """
    count, jacobian, wide = 0, np.empty((3, 5)), np.empty((3, 3))
    variance = fit.limits.marker_sigma * fit.limits.marker_sigma
    for i in range(fit.pixel_count):
        direction, own, weight = fit.directions[count], fit.covariances[count], fit.weights[count]
        if not marker_direction(fit, fit.pixels[i, 0], fit.pixels[i, 1], direction, jacobian):
            continue
        own[:] = 0.0
        add_propagated_covariance(jacobian[:, :2].copy(), fit.pixel_covariances[i], own)
        for j in range(3):
            for k in range(3):
                along = direction[j] * direction[k]
                own[j, k] += variance * ((j == k) - along)
                wide[j, k] = own[j, k] + along
                fit.position_jacobians[count, j, k] = jacobian[j, k + 2]
        if not invert_3x3(wide, weight):
            continue
        for j in range(3):
            for k in range(3):
                weight[j, k] -= direction[j] * direction[k]
        fit.sources[count] = i
        count += 1
    fit.count = count


@kernel
def prior_cost(fit: Any, rotation: Floats, who: Ints) -> float:
    """Cost of a rotation before its fit: a jump or a tilt, and markers that should be in sight and are not."""
    limits, position, out = fit.limits, fit.position, np.empty(3)
    cost = (math.acos(min(max(rotation[1, 1], -1.0), 1.0)) / float(limits.usual_tilt)) ** 2
    if fit.last_known != 0:
        cost = (rotation_vector_between(fit.last_rotation[:], rotation, out) / float(limits.usual_turn)) ** 2
    far = math.sqrt(position[0] ** 2 + position[1] ** 2 + position[2] ** 2)
    for m in range(fit.body_count):
        transform(rotation, fit.bodies[m], out)
        facing = -(out[0] * position[0] + out[1] * position[1] + out[2] * position[2])
        missing = facing > limits.visible_cosine * far
        for i in range(who.shape[0]):
            missing = missing and who[i] != m
        cost += float(limits.missing_cost) if missing else 0.0
    return cost


@kernel
def _angle(a: Floats, b: Floats) -> float:
    """Angle between two unit vectors, rad."""
    return math.acos(min(max(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], -1.0), 1.0))


@kernel
def _fits_pairwise(fit: Any, who: Ints) -> bool:
    """Whether all angles between the markers are near those of the target."""
    for i in range(fit.count):
        for j in range(i):
            if who[i] >= 0 and who[j] >= 0:
                angle = _angle(fit.directions[i], fit.directions[j])
                if abs(_angle(fit.bodies[who[i]], fit.bodies[who[j]]) - angle) > fit.limits.pair_tolerance:
                    return False
    return True


@kernel
def fit_assignment(fit: Any, who: Ints, rotation: Floats) -> float:
    """Rotation for one assignment; returns its cost, infinite if it is impossible."""
    first: Any = np.int64(-1)  # a plain -1 would be a type of its own: kernels that take it would compile twice
    second = first
    for i in range(fit.count):
        if who[i] >= 0 and first < 0:
            first = i
        elif who[i] >= 0 and second < 0:
            second = i
    cost = 0.0
    if second < 0:
        if not fit_level_rotation(fit, first, who[first], rotation):
            return math.inf
    else:
        if not _fits_pairwise(fit, who):
            return math.inf
        bodies, seen = np.empty((2, 3)), np.empty((2, 3))
        bodies[0], bodies[1] = fit.bodies[who[first]], fit.bodies[who[second]]
        seen[0], seen[1] = fit.directions[first], fit.directions[second]
        if not rotation_from_two(bodies, seen, fit.limits.min_sine_squared, rotation):
            return math.inf
        cost = fit_rotation(fit, who, rotation)
    for i in range(fit.count):
        cost += fit.limits.unmatched_cost if who[i] < 0 else 0.0
    return cost


@kernel
def identify_markers(fit: Any, ways: Ints) -> tuple[int, float, float]:
    """Find out which marker is which by trying.

    Parameters
    ----------
    fit : record of `AttitudeFit`
        `rotation`, `gains` and `tilt_axis` are written, of the best assignment.
    ways : (c, n)
        The assignments to try: a marker of the target for each direction, -1 for none.

    Returns
    -------
    best : int
        The best assignment, -1 if none is possible.
    cost : float
        Its sum of weighted squares.
    margin : float
        By how much the cost of the best different rotation is larger.
    """
    count, vector = ways.shape[0], np.empty(3)
    costs, rotations = np.full(count, math.inf), np.zeros((count, 3, 3))
    best, margin, distinct = -1, math.inf, fit.limits.distinct_angle
    for c in range(count):
        cost = fit_assignment(fit, ways[c], rotations[c])
        if cost < math.inf:
            costs[c] = cost + prior_cost(fit, rotations[c], ways[c])
            if best < 0 or costs[c] < costs[best]:
                best = c
    if best < 0:
        return -1, 0.0, 0.0
    for c in range(count):
        ahead = costs[c] - costs[best]
        if ahead < margin and rotation_vector_between(rotations[c], rotations[best], vector) > distinct:
            margin = ahead
    fit.gains[:] = 0.0
    fit.tilt_axis[:] = 0.0
    cost = fit_assignment(fit, ways[best], fit.rotation[:])
    for i in range(fit.count):
        cost -= fit.limits.unmatched_cost if ways[best, i] < 0 else 0.0
    return best, cost, margin


@kernel
def _write_covariance(fit: Any, who: Ints, level: bool) -> None:
    """Covariance of the rotation vector, and with the position: of the directions, of the position, of the tilt."""
    shared, own, position = np.zeros((3, 3)), np.zeros((3, 3)), fit.position_covariance[:]
    for i in range(fit.count):
        if who[i] >= 0:
            add_propagated_covariance(fit.gains[i], fit.covariances[i], own)
            for a in range(3):
                for b in range(3):
                    for c in range(3):
                        shared[a, b] += fit.gains[i, a, c] * fit.position_jacobians[i, c, b]
    add_propagated_covariance(shared, position, own)
    tilt = fit.limits.tilt_sigma * fit.limits.tilt_sigma if level else 0.0
    for a in range(3):
        for b in range(3):
            fit.rotation_covariance[a, b] = own[a, b] + tilt * fit.tilt_axis[a] * fit.tilt_axis[b]
            total = 0.0
            for c in range(3):
                total += shared[a, c] * position[c, b]
            fit.cross_covariance[a, b] = total


@kernel(entry=False)
def _write_camera_slope(fit: Any, who: Ints) -> None:
    """Write the derivatives of the rotation vector to the intrinsics: they move the rays of ball and markers alike."""
    one, other, slope = np.empty(3), np.empty(3), fit.rotation_slope
    for k in range(9):
        step = fit.camera_steps[k]
        if not step > 0.0:
            continue
        for i in range(fit.count):
            if who[i] < 0:
                continue
            x, y = fit.pixels[fit.sources[i], 0], fit.pixels[fit.sources[i], 1]
            if direction_by_camera(fit, x, y, k, step, one) and direction_by_camera(fit, x, y, k, -step, other):
                for a in range(3):
                    for c in range(3):
                        slope[a, k] += fit.gains[i, a, c] * (one[c] - other[c]) / (2.0 * step)


@kernel
def estimate_rotation(fit: Any, ways: Ints, starts: Ints) -> int:
    """Rotation of the ball from the markers in the image.

    Parameters
    ----------
    fit : record of `AttitudeFit`, written
    ways, starts : (c, n), (n + 2,)
        See `assignments`.

    Returns
    -------
    int
        One of `RotationSource`.
    """
    measure_directions(fit)
    k = fit.count
    if k == 0:
        return RotationSource.NONE.value
    tried = ways[starts[k] : starts[k + 1], :k].copy()
    best, cost, margin = identify_markers(fit, tried)
    if best < 0 or margin < fit.limits.min_margin:
        return RotationSource.NONE.value
    named = 0
    for i in range(k):
        named += 1 if tried[best, i] >= 0 else 0
    if named > 1 and cost > fit.limits.max_cost * named:
        return RotationSource.NONE.value
    _write_covariance(fit, tried[best], named == 1)
    _write_camera_slope(fit, tried[best])
    return RotationSource.LEVEL.value if named == 1 else RotationSource.FULL.value
