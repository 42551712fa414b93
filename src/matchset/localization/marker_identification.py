"""All markers that are seen on the ball at once: which is which, and the rotation with its covariance."""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.attitude import BAD, fit_level, fit_turn, turn_between
from matchset.localization.marker_direction import place_marker
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import add_spread, apply, invert, turn_from

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

NOTHING, LEVEL, FULL = 0, 1, 2
STRANGER = 20.0  # cost of a marker that is seen but is none of the ball's
ABSENT, FACING = 4.0, 0.7  # cost of one that should be seen and is not: cosine to the line of sight above this
TILT = 0.3  # rad by which vehicles are usually tilted at most, while nothing else speaks
TURN = 0.2  # rad by which the ball turns at most between two frames
UNLIKE = 0.15  # rad from which two rotations are different answers
APART = 0.35  # rad by which the angle between two markers may be wrong for a choice to be tried


@kernel
def _surprise(turn: Floats, bodies: Floats, who: Ints, position: Floats, last: Floats, known: bool) -> float:
    """Tell what else speaks against an answer: a jump or a tilt, and markers that should be seen and are not."""
    vector, out = np.empty(3), np.empty(3)
    if known:
        cost = (turn_from(last, turn, vector) / TURN) ** 2
    else:
        cost = (math.acos(min(max(turn[1, 1], -1.0), 1.0)) / TILT) ** 2
    far = math.sqrt(position[0] ** 2 + position[1] ** 2 + position[2] ** 2)
    for m in range(bodies.shape[0]):
        apply(turn, bodies[m], out)
        missing = -(out[0] * position[0] + out[1] * position[1] + out[2] * position[2]) > FACING * far
        for i in range(who.shape[0]):
            missing = missing and who[i] != m
        cost += ABSENT if missing else 0.0
    return cost


@kernel
def _fit_choice(
    who: Ints, bodies: Floats, seen: Floats, weights: Floats, turn: Floats, gains: Floats, free: Floats
) -> float:
    """Rotation for one way to name the markers; its cost, `BAD` where it cannot be."""
    first = second = -1
    for i in range(seen.shape[0]):
        if who[i] >= 0 and first < 0:
            first = i
        elif who[i] >= 0 and second < 0:
            second = i
    cost = 0.0
    if second < 0:
        if not fit_level(bodies[who[first]], seen[first], turn, gains[first], free):
            return BAD
    else:
        for i in range(seen.shape[0]):
            for j in range(i):
                if who[i] >= 0 and who[j] >= 0:
                    model = np.dot(bodies[who[i]], bodies[who[j]])
                    angle = math.acos(min(max(np.dot(seen[i], seen[j]), -1.0), 1.0))
                    if abs(math.acos(min(max(model, -1.0), 1.0)) - angle) > APART:
                        return BAD
        if not turn_between(bodies[who[first]], bodies[who[second]], seen[first], seen[second], turn):
            return BAD
        cost = fit_turn(bodies, seen, weights, who, turn, gains)
    for i in range(seen.shape[0]):
        cost += STRANGER if who[i] < 0 else 0.0
    return cost


@kernel
def identify(
    choices: Ints,
    bodies: Floats,
    seen: Floats,
    weights: Floats,
    position: Floats,
    last: Floats,
    known: bool,
    turn: Floats,
    gains: Floats,
    free: Floats,
) -> tuple[int, float, float]:
    """Find out which marker is which by trying.

    Parameters
    ----------
    choices : (c, n)
        What to try: a marker for each direction, -1 for none.
    bodies, seen, weights, gains
        See `fit_turn`.
    position : (3,)
        The ball's center, camera frame, m.
    last : (3, 3)
        The rotation a moment ago.
    known : bool
        Whether there is one.
    turn : (3, 3), written
        The best rotation.
    free : (3,), written
        See `fit_level`; zeros for two markers and more.

    Returns
    -------
    best : int
        The best choice, -1 where none is possible.
    cost : float
        Sum of weighted squares of the best choice.
    lead : float
        By how much the best answer that is really different is worse.
    """
    count, n = choices.shape[0], seen.shape[0]
    costs, turns, vector = np.full(count, BAD), np.zeros((count, 3, 3)), np.empty(3)
    best, lead = -1, BAD
    for c in range(count):
        cost = _fit_choice(choices[c], bodies, seen, weights, turns[c], gains, free)
        if cost < BAD:
            costs[c] = cost + _surprise(turns[c], bodies, choices[c], position, last, known)
            if best < 0 or costs[c] < costs[best]:
                best = c
    if best < 0:
        return -1, 0.0, 0.0
    for c in range(count):
        if costs[c] - costs[best] < lead and turn_from(turns[c], turns[best], vector) > UNLIKE:
            lead = costs[c] - costs[best]
    gains[:], free[:] = 0.0, 0.0
    cost = _fit_choice(choices[best], bodies, seen, weights, turn, gains, free)
    for i in range(n):
        cost -= STRANGER if choices[best, i] < 0 else 0.0
    return best, cost, lead


@kernel
def _directions(
    intrinsics: Floats,
    pixels: Floats,
    spreads: Floats,
    position: Floats,
    reach: float,
    loose: float,
    seen: Floats,
    weights: Floats,
    own: Floats,
    slopes: Floats,
) -> int:
    """Directions of the markers that meet the ball, first in the arrays; returns how many there are."""
    count, slope, wide = 0, np.empty((3, 5)), np.empty((3, 3))
    for i in range(pixels.shape[0]):
        if not place_marker(intrinsics, pixels[i, 0], pixels[i, 1], position, reach, seen[count], slope):
            continue
        own[count] = 0.0
        add_spread(slope[:, :2], spreads[i], own[count])
        for j in range(3):
            for k in range(3):
                along = seen[count, j] * seen[count, k]
                own[count, j, k] += loose * loose * ((j == k) - along)
                wide[j, k] = own[count, j, k] + along
                slopes[count, j, k] = slope[j, k + 2]
        if not invert(wide, weights[count]):
            continue
        for j in range(3):
            for k in range(3):
                weights[count, j, k] -= seen[count, j] * seen[count, k]
        count += 1
    return count


@kernel
def observe_turn(
    intrinsics: Floats,
    pixels: Floats,
    spreads: Floats,
    choices: Ints,
    starts: Ints,
    bodies: Floats,
    position: Floats,
    reach: float,
    loose: float,
    tilt: float,
    lead: float,
    misfit: float,
    last: Floats,
    known: bool,
    turn: Floats,
    covariance: Floats,
) -> int:
    """Rotation of the ball from the markers that are seen.

    Parameters
    ----------
    intrinsics : (9,)
        See `lens.py`.
    pixels, spreads : (n, 2), (n, 2, 2)
        Middles of the markers' rims, px, and their covariances.
    choices, starts : (c, n), (n + 2,)
        What to try if k <= n of them meet the ball: the first k columns of rows starts[k] ... starts[k + 1], see
        `identify`.
    bodies : (m, 3)
        The markers of the ball, ball frame.
    position : (3,)
        The ball's center, camera frame, m.
    reach : float
        How far the middle of a rim is from there, m.
    loose, tilt, lead, misfit : float
        See `LocalizerParameters`.
    last, known
        See `identify`.
    turn : (3, 3), written
    covariance : (6, 6), written
        The block of the position is read, the others are written.

    Returns
    -------
    int
        `NOTHING`, `LEVEL` or `FULL`.
    """
    n = pixels.shape[0]
    seen, weights, own, slopes = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, 3, 3)), np.empty((n, 3, 3))
    k = _directions(intrinsics, pixels, spreads, position, reach, loose, seen, weights, own, slopes)
    if k == 0:
        return NOTHING
    gains, free, ways = np.zeros((k, 3, 3)), np.zeros(3), choices[starts[k] : starts[k + 1], :k].copy()
    best, cost, ahead = identify(ways, bodies, seen[:k], weights[:k], position, last, known, turn, gains, free)
    if best < 0 or ahead < lead:
        return NOTHING
    named, shared, own_turn = 0, np.zeros((3, 3)), np.zeros((3, 3))
    for i in range(k):
        if ways[best, i] >= 0:
            named += 1
            add_spread(gains[i], own[i], own_turn)
            for a in range(3):
                for b in range(3):
                    for c in range(3):
                        shared[a, b] += gains[i, a, c] * slopes[i, c, b]
    if named > 1 and cost > misfit * named:
        return NOTHING
    place = covariance[:3, :3].copy()
    add_spread(shared, place, own_turn)
    for a in range(3):
        for b in range(3):
            covariance[3 + a, 3 + b] = own_turn[a, b] + (tilt * tilt * free[a] * free[b] if named == 1 else 0.0)
            tie = 0.0
            for c in range(3):
                tie += shared[a, c] * place[c, b]
            covariance[3 + a, b] = covariance[b, 3 + a] = tie
    return LEVEL if named == 1 else FULL
