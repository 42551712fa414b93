"""The Kalman filter's two steps for any small linear model: `predict` and `update`; and constant velocity."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import helper, kernel
from matchset.numeric.linalg import factor_cholesky, solve_cholesky

Floats = npt.NDArray[np.float64]


@kernel
def predict(state: Floats, covariance: Floats, transition: Floats, noise: Floats) -> None:
    """Predict, in place: ``x <- F x``, ``P <- F P F^T + Q``.

    Parameters
    ----------
    state : (n,), written
        x.
    covariance : (n, n), written
        P.
    transition : (n, n)
        F; its zeros cost nothing.
    noise : (n, n)
        Q, the covariance of the process noise.
    """
    n = state.shape[0]
    before, product = state.copy(), np.zeros((n, n))
    for i in range(n):
        state[i] = 0.0
        for k in range(n):
            f = transition[i, k]
            if f != 0.0:
                state[i] += f * before[k]
                for j in range(n):
                    product[i, j] += f * covariance[k, j]
    for i in range(n):
        for j in range(n):
            covariance[i, j] = noise[i, j]
    for j in range(n):
        for k in range(n):
            f = transition[j, k]
            if f != 0.0:
                for i in range(n):
                    covariance[i, j] += product[i, k] * f


@kernel
def update(
    state: Floats, covariance: Floats, innovation: Floats, observation: Floats, noise: Floats, gate: float
) -> float:
    """Correct by a measurement, in place, unless it lies outside the gate.

    ``S = H P H^T + R``, ``K = P H^T S^-1``, ``x <- x + K y``, ``P <- P - K H P``.

    Parameters
    ----------
    state : (n,), written
        x.
    covariance : (n, n), written
        P.
    innovation : (m,)
        y, the measurement less what is predicted of it.
    observation : (m, n)
        H; its zeros cost nothing.
    noise : (m, m)
        R, the covariance of the measurement.
    gate : float
        Largest squared Mahalanobis distance, ``y^T S^-1 y``, of a measurement that is used.

    Returns
    -------
    float
        The squared distance, infinite if S is singular. Above the gate nothing is changed.
    """
    m, n = observation.shape
    cross, s, solved = np.zeros((m, n)), np.empty(m * m), np.empty(m)  # H P, the Cholesky factor of S, S^-1 y
    for i in range(m):
        for k in range(n):
            if observation[i, k] != 0.0:
                for j in range(n):
                    cross[i, j] += observation[i, k] * covariance[k, j]
    for i in range(m):
        for j in range(i + 1):
            total = noise[i, j]
            for k in range(n):
                total += cross[i, k] * observation[j, k]
            s[i * m + j] = total
    if not factor_cholesky(s, m, 0.0):
        return math.inf
    solve_cholesky(s, innovation, solved, m)
    distance = 0.0
    for i in range(m):
        distance += innovation[i] * solved[i]
    if not distance <= gate:
        return distance
    gain = np.empty(m)
    for j in range(n):
        for i in range(m):
            state[j] += cross[i, j] * solved[i]
            gain[i] = cross[i, j]
        solve_cholesky(s, gain, gain, m)  # row j of K: S is symmetric
        for k in range(j + 1):
            drop = 0.0
            for i in range(m):
                drop += gain[i] * cross[i, k]
            covariance[j, k] -= drop
            covariance[k, j] = covariance[j, k]
    return distance


@kernel
def predict_constant_velocity(state: Floats, covariance: Floats, ahead: float, noise: float) -> None:
    """Predict numbers and their speeds: constant velocity, white noise in the acceleration.

    ``x += v t`` and ``P = F P F^T + Q``, with Q = noise^2 (t^3/3, t^2/2; t^2/2, t) for each number.

    Parameters
    ----------
    state : (2 n,), written
        The numbers, then their speeds, per s.
    covariance : (2 n, 2 n), written
    ahead : float
        t, s, not negative.
    noise : float
        Root of the acceleration's spectral density, units/s^2 per root of Hz.
    """
    n, q = state.shape[0] // 2, noise * noise
    for j in range(n):
        state[j] += ahead * state[j + n]
    for j in range(n):
        for k in range(2 * n):
            covariance[j, k] += ahead * covariance[j + n, k]
    for j in range(2 * n):
        for k in range(n):
            covariance[j, k] += ahead * covariance[j, k + n]
    for j in range(n):
        covariance[j, j] += q * ahead**3 / 3.0
        covariance[j, j + n] += q * ahead**2 / 2.0
        covariance[j + n, j] += q * ahead**2 / 2.0
        covariance[j + n, j + n] += q * ahead


@helper
def add_prediction(
    state: Floats, covariance: Floats, transition: Floats, predicted: Floats, predicted_covariance: Floats
) -> None:
    """Predict without arrays of its own: ``x' = F x``, ``P' += F P F^T``.

    Parameters
    ----------
    state, covariance : (n,), (n, n)
        x, P.
    transition : (n, n)
        F.
    predicted : (n,), written
        x'.
    predicted_covariance : (n, n), written
        P'; it holds Q, the covariance of the process noise, before.
    """
    n = state.shape[0]
    for j in range(n):
        predicted[j] = 0.0
        for k in range(n):
            predicted[j] += transition[j, k] * state[k]
            product = 0.0  # (F P)[j, k]
            for m in range(n):
                product += transition[j, m] * covariance[m, k]
            for m in range(n):
                predicted_covariance[j, m] += product * transition[m, k]


@helper
def correct_by_scalar(state: Floats, covariance: Floats, cross: Floats, innovation: float, variance: float) -> None:
    """Correct by one number, in place: ``x <- x + c y / S``, ``P <- P - c c^T / S``.

    Parameters
    ----------
    state, covariance : (n,), (n, n), written
        x, P.
    cross : (n,)
        c = P h, the covariance of the state with what is measured.
    innovation, variance : float
        y, the measurement less what is predicted of it; S = h c + R, its variance.
    """
    for j in range(state.shape[0]):
        gain = cross[j] / variance
        state[j] += gain * innovation
        for k in range(state.shape[0]):
            covariance[j, k] -= gain * cross[k]
