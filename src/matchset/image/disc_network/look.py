"""What the network says of a patch, and where it leads from circle to circle, in compiled code: `see`, `follow`."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.layers import AROUND, FARTHEST_STEP, Places, Singles, add_outputs, dense, gather_around
from matchset.image.disc_network.patch_format import DIRECTIONS, NUMBERS, PLACES, RAYS, Colors, Image, Patch
from matchset.image.disc_network.patch_kernel import read_patch_kernel
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import invert_3x3, transform
from matchset.numeric.record import Block

Floats = npt.NDArray[np.float64]

STEPS = {"a": 1, "b": 2, "c": 4, "d": FARTHEST_STEP}  # format: of the convolutions, in rays
PRECISION = 30.0  # format: of a circle of which nothing is seen, 1 / radii^2
LOG_PRECISIONS = (-6.0, 8.0)  # format: of a ray, least and largest
MOVES = np.column_stack((DIRECTIONS, np.ones(RAYS)))  # theorem: how the outline moves along the rays with x, y, radius
WAYS = tuple(STEPS.values())
AT_ONCE = 8  # format: rays that are worked out together: what they see fits into the first cache


class Weights(NamedTuple):
    """Weights of the network as kernels read them.

    Attributes
    ----------
    outputs : tuple of ndarray of shape (m,), int64
        Of each layer, to which channel each output is added.
    layers : tuple of ndarray of shape (m, k), float32
        By output.
    biases : tuple of ndarray of shape (m,), float32
    out, out_bias, there, there_bias : ndarray, float32
        From the channels to what is said of a ray, (2, channels), and to the log-odds, (2 channels,).
    """

    outputs: tuple[Places, ...]
    layers: tuple[Singles, ...]
    biases: tuple[Singles, ...]
    out: Singles
    out_bias: Singles
    there: Singles
    there_bias: Singles


class Memory(NamedTuple):
    """Working memory of a thread."""

    patch_block: Block
    patch: Patch
    rays: Singles
    more: Singles
    gathered: Singles
    step: Floats
    precision: Floats
    inverse: Floats
    right: Floats


class FollowLimits(NamedTuple):
    """See `network.FollowParameters`."""

    rounds: int
    most_step: float
    still: float
    least_radius: float
    hopeless: float
    unrest: float


RADIUS, PRECISIONS, LOG_ODDS, LOOKS, IS_FOUND, IS_DONE = 2, 3, 12, 13, 14, 15  # format: of a row of `follow`
PROMISE, ROW = 16, 17  # format: what a further look promises, and how many numbers a row has


@kernel(refcount=False)
def see(weights: Weights, memory: Memory) -> float:
    """Log-odds that the patch in the memory shows a ball; the step to it and its precision are written, in radii."""
    rays, more, gathered, width = memory.rays, memory.more, memory.gathered, memory.rays.shape[1]
    rays[:] = 0.0
    dense(memory.patch.reshape(RAYS, PLACES * NUMBERS), weights.layers[0], weights.biases[0], more)
    add_outputs(more, weights.outputs[0], rays)
    for k in range(len(WAYS)):
        for first in range(0, RAYS, AT_ONCE):
            gather_around(rays, first, WAYS[k], gathered)
            dense(gathered, weights.layers[1 + k], weights.biases[1 + k], more[first : first + AT_ONCE])
        add_outputs(more, weights.outputs[1 + k], rays)
    _weigh_rays(weights, memory)
    odds = weights.there_bias[0]
    for k in range(width):
        total, most = np.float32(0.0), rays[AROUND, k]
        for ray in range(AROUND, AROUND + RAYS):
            total += rays[ray, k]
            most = max(most, rays[ray, k])
        odds += weights.there[k] * total / np.float32(RAYS) + weights.there[width + k] * most
    return float(odds)


@kernel(refcount=False, entry=False)
def _weigh_rays(weights: Weights, memory: Memory) -> None:
    """Write the step to the circle that the rays show, by weighted least squares, and its precision."""
    rays, precision, right = memory.rays, memory.precision, memory.right
    for i in range(3):
        right[i] = 0.0
        for j in range(3):
            precision[i, j] = PRECISION if i == j else 0.0
    for ray in range(RAYS):
        length, log_weight = weights.out_bias[0], weights.out_bias[1]
        for k in range(rays.shape[1]):
            length += weights.out[0, k] * rays[AROUND + ray, k]
            log_weight += weights.out[1, k] * rays[AROUND + ray, k]
        weight = math.exp(min(max(float(log_weight), LOG_PRECISIONS[0]), LOG_PRECISIONS[1]))
        for i in range(3):
            right[i] += weight * length * MOVES[ray, i]
            for j in range(3):
                precision[i, j] += weight * MOVES[ray, i] * MOVES[ray, j]
    invert_3x3(precision, memory.inverse)
    transform(memory.inverse, right, memory.step)


@kernel(refcount=False, entry=False)
def _follow_one(image: Image, circle: Floats, known: Colors, network: tuple[Weights, Memory], row: Floats) -> bool:
    """Look once at a circle and move it; what was seen is written to its row. False where there is nothing to see."""
    weights, memory = network
    if not read_patch_kernel(image, circle, known, memory.patch_block, memory.patch):
        return False
    row[LOG_ODDS] = see(weights, memory)
    scale = circle[RADIUS]
    for i in range(3):
        for j in range(3):
            row[PRECISIONS + 3 * i + j] = memory.precision[i, j] / (scale * scale)
    return True


@kernel(refcount=False, entry=False)
def _next_start(rows: Floats, limits: FollowLimits) -> int:
    """Which start is looked at next: each once, in their order, then the most promising not at rest; -1: none."""
    best, most = -1, -math.inf
    for k in range(rows.shape[0]):
        if rows[k, IS_DONE] != 0.0 or rows[k, LOOKS] >= limits.rounds:
            continue
        if rows[k, LOOKS] == 0.0:
            return k
        if rows[k, PROMISE] > most:
            best, most = k, rows[k, PROMISE]
    return best


@kernel(refcount=False)
def follow(
    image: Image,
    starts: Floats,
    known: Colors,
    limits: FollowLimits,
    network: tuple[Weights, Memory],
    looks: int,
    rows: Floats,
) -> int:
    """Go from circles to balls, in looks: each circle once, then on from the most promising, while there are looks.

    It has seven parameters: each is an array or a record of another kind.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1), uint8
    starts : (n, 3), float64
        x, y and radius, px.
    known : (9216,) or (0,), float32
        Colors of the ball, from another picture.
    limits : FollowLimits
    network : (Weights, Memory)
    looks : int
        How many may be taken.
    rows : (n, ROW), float64, written
        What each start led to; not found are those that led out of the picture, to nothing, or were not looked at.

    Returns
    -------
    int
        How many looks were taken.
    """
    step, precision = network[1].step, network[1].precision
    for k in range(starts.shape[0]):
        rows[k, :] = 0.0
        for i in range(3):
            rows[k, i] = starts[k, i]
        rows[k, IS_DONE] = not starts[k, RADIUS] >= limits.least_radius
    for taken in range(looks):
        k = _next_start(rows, limits)
        if k < 0:
            return taken
        row, circle = rows[k], rows[k, :3]
        row[LOOKS] += 1.0
        row[IS_FOUND] = _follow_one(image, circle, known, network, row)
        if row[IS_FOUND] == 0.0 or (row[LOOKS] == 1.0 and row[LOG_ODDS] < limits.hopeless):
            row[IS_FOUND], row[IS_DONE] = 0.0, 1.0
            continue
        scale, squared = circle[RADIUS], 0.0
        for i in range(3):
            circle[i] += scale * min(max(step[i], -limits.most_step), limits.most_step)
            for j in range(3):
                squared += step[i] * precision[i, j] * step[j]
        row[IS_FOUND] = circle[RADIUS] >= limits.least_radius
        row[IS_DONE] = squared < limits.still or row[IS_FOUND] == 0.0
        row[PROMISE] = row[LOG_ODDS] + limits.unrest * math.log(max(squared, limits.still))
    return looks
