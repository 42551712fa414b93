"""One layer of the network in compiled code: `dense`, `gather_around` before it, and `add_outputs` after it.

NumPy's BLAS would start a thread for each core for matrices of this size, and wait for them: on a busy computer that
takes a hundred times as long as the arithmetic. A kernel stays in the thread that calls it.

The rays lie one behind the other, with those of the other end before and after them: what a circular convolution sees
are rows at fixed distances. A layer that was pruned gives some channels only.
"""

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Singles = npt.NDArray[np.float32]
Places = npt.NDArray[np.int64]

ROWS, TILE = 4, 3  # format: rays and outputs that are worked out together; layers give a multiple of `TILE`
TAPS = 5  # format: rays that a convolution sees, itself in the middle
FARTHEST_STEP = 8  # format: longest step of a convolution, in rays
AROUND = TAPS // 2 * FARTHEST_STEP  # geometry: rays of the other end before and after the rays


@kernel(refcount=False, reassociate=True, fused=True, entry=False)
def dense(values: Singles, weights: Singles, bias: Singles, out: Singles) -> None:
    """Write ``max(values @ weights.T + bias, 0)``: a tile at a time.

    Its twelve sums, and what is multiplied, fit into the sixteen registers of AVX2: with sixteen sums it took 1.7 times
    as long.

    Parameters
    ----------
    values : (4 m, >= k), float32
    weights : (3 n, k), float32
    bias : (3 n,), float32
    out : (4 m, >= 3 n), float32, written
    """
    inputs = weights.shape[1]
    for r in range(0, values.shape[0], ROWS):
        v0, v1, v2, v3 = values[r], values[r + 1], values[r + 2], values[r + 3]
        for j in range(0, weights.shape[0], TILE):
            w0, w1, w2 = weights[j], weights[j + 1], weights[j + 2]
            s00 = s01 = s02 = s10 = s11 = s12 = np.float32(0.0)
            s20 = s21 = s22 = s30 = s31 = s32 = np.float32(0.0)
            for i in range(inputs):
                a, b, c = w0[i], w1[i], w2[i]
                v = v0[i]
                s00, s01, s02 = s00 + a * v, s01 + b * v, s02 + c * v
                v = v1[i]
                s10, s11, s12 = s10 + a * v, s11 + b * v, s12 + c * v
                v = v2[i]
                s20, s21, s22 = s20 + a * v, s21 + b * v, s22 + c * v
                v = v3[i]
                s30, s31, s32 = s30 + a * v, s31 + b * v, s32 + c * v
            out[r, j], out[r, j + 1], out[r, j + 2] = s00, s01, s02
            out[r + 1, j], out[r + 1, j + 1], out[r + 1, j + 2] = s10, s11, s12
            out[r + 2, j], out[r + 2, j + 1], out[r + 2, j + 2] = s20, s21, s22
            out[r + 3, j], out[r + 3, j + 1], out[r + 3, j + 2] = s30, s31, s32
    for r in range(values.shape[0]):
        for j in range(weights.shape[0]):
            out[r, j] = max(out[r, j] + bias[j], np.float32(0.0))


@kernel(refcount=False, entry=False)
def gather_around(rays: Singles, first: int, step: int, out: Singles) -> None:
    """Write, for some rays from the first on, the numbers of the five rays that a convolution sees.

    Parameters
    ----------
    rays : (n + 2 * `AROUND`, width), float32
    first : int
    step : int
        Of the convolution, in rays.
    out : (m, 5 * width), float32, written
    """
    width = rays.shape[1]
    for k in range(out.shape[0]):
        for tap in range(TAPS):
            source = AROUND + first + k + step * (tap - TAPS // 2)
            for i in range(width):
                out[k, tap * width + i] = rays[source, i]


@kernel(refcount=False, entry=False)
def add_outputs(more: Singles, outputs: Places, rays: Singles) -> None:
    """Add what a layer gives to some channels of all rays, and close the ring.

    Parameters
    ----------
    more : (64, k), float32
    outputs : (m,), int64
        Channels.
    rays : (64 + 2 * `AROUND`, width), float32, written
    """
    count = rays.shape[0] - 2 * AROUND
    for ray in range(count):
        for j in range(outputs.shape[0]):
            rays[AROUND + ray, outputs[j]] += more[ray, j]
    for k in range(AROUND):
        for j in range(rays.shape[1]):
            rays[k, j] = rays[count + k, j]
            rays[AROUND + count + k, j] = rays[AROUND + k, j]
