"""Kernels of the filter: three numbers and their speeds, constant but for white noise in the acceleration."""

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.linalg import invert

Floats = npt.NDArray[np.float64]


@kernel
def advance(state: Floats, covariance: Floats, ahead: float, noise: float) -> None:
    """Extrapolate by `ahead` seconds, in place.

    ``x += v t`` and ``P = F P F^T + Q``, with Q = noise^2 (t^3/3, t^2/2; t^2/2, t) for each of the three.

    Parameters
    ----------
    state : (6,), written
        Three numbers, then their speeds per s.
    covariance : (6, 6), written
    ahead : float
        s, not negative.
    noise : float
        Square root of the acceleration's spectral density, units/s^2 per root of Hz.
    """
    for j in range(3):
        state[j] += ahead * state[j + 3]
    for j in range(3):
        for k in range(6):
            covariance[j, k] += ahead * covariance[j + 3, k]
    for j in range(6):
        for k in range(3):
            covariance[j, k] += ahead * covariance[j, k + 3]
    q = noise * noise
    for j in range(3):
        covariance[j, j] += q * ahead**3 / 3.0
        covariance[j, j + 3] += q * ahead**2 / 2.0
        covariance[j + 3, j] += q * ahead**2 / 2.0
        covariance[j + 3, j + 3] += q * ahead


@kernel
def correct(state: Floats, covariance: Floats, seen: Floats, spread: Floats, gate: float) -> float:
    """Take in a measurement of the three numbers unless it lies too far from the prediction.

    Parameters
    ----------
    state, covariance
        See `advance`; written.
    seen, spread : (3,), (3, 3)
        The measurement less the prediction, and its covariance.
    gate : float
        Largest squared distance, in standard deviations, that is believed.

    Returns
    -------
    float
        The squared distance, infinite for a covariance without inverse; above the gate nothing was changed.
    """
    innovation, inverse, distance = np.empty((3, 3)), np.empty((3, 3)), 0.0
    for j in range(3):
        for k in range(3):
            innovation[j, k] = covariance[j, k] + spread[j, k]
    if not invert(innovation, inverse):
        return np.inf
    for j in range(3):
        for k in range(3):
            distance += seen[j] * inverse[j, k] * seen[k]
    if not distance <= gate:
        return distance
    columns, gain = covariance[:, :3].copy(), np.zeros((6, 3))
    for j in range(6):
        for k in range(3):
            for m in range(3):
                gain[j, k] += columns[j, m] * inverse[m, k]
    for j in range(6):
        for k in range(3):
            state[j] += gain[j, k] * seen[k]
    for j in range(6):
        for k in range(j + 1):
            drop = 0.0
            for m in range(3):
                drop += gain[j, m] * columns[k, m]
            covariance[j, k] -= drop
            covariance[k, j] = covariance[j, k]
    return distance
