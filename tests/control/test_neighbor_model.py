"""The motion model against SciPy: transition is the matrix exponential, noise the integral of Van Loan (1978)."""

import math

import numpy as np
import numpy.typing as npt
import pytest
from scipy.linalg import expm

from matchset.control.neighbor_filter import WORK, initial_block
from matchset.control.neighbor_model import (
    ORDER,
    NeighborFilterParameters,
    write_drift_transition,
    write_noise,
    write_oscillation_transition,
)
from matchset.numeric.record import fields

Floats = npt.NDArray[np.float64]
PARAMETERS = NeighborFilterParameters()


def system(time_constant: float) -> Floats:
    """A of x' = A x for drift, speed, acceleration, oscillation and its speed."""
    w, z = 2.0 * math.pi / PARAMETERS.oscillation_period, PARAMETERS.oscillation_damping
    a = np.zeros((ORDER, ORDER))
    a[0, 1] = a[1, 2] = a[3, 4] = 1.0
    a[2, 2], a[4, 3], a[4, 4] = -1.0 / time_constant, -w * w, -2.0 * z * w
    return a


@pytest.mark.parametrize("step", [0.0, 1 / 30, 0.2, 1.0, 3.0])
def test_the_transition_is_the_matrix_exponential(step: float) -> None:
    found = np.zeros((ORDER, ORDER))
    write_drift_transition.py_func(0.68, step, found)  # type: ignore[attr-defined]
    write_oscillation_transition.py_func(PARAMETERS, step, found)  # type: ignore[attr-defined]
    np.testing.assert_allclose(found, expm(step * system(0.68)), atol=1e-12)


@pytest.mark.parametrize("axis", [0, 1, 3])
def test_the_noise_of_a_frame_is_the_integral_over_it(axis: int) -> None:
    work = fields(initial_block(PARAMETERS), WORK)
    axes, step = (work.yaw_axis if axis == 3 else work.position_axes), 1 / 30
    found = np.empty((ORDER, ORDER))
    write_noise.py_func(PARAMETERS, axes, axis, step, found)  # type: ignore[attr-defined]
    w, z = 2.0 * math.pi / PARAMETERS.oscillation_period, PARAMETERS.oscillation_damping
    sigma = axes.oscillation_sigma * (PARAMETERS.vertical_oscillation_ratio if axis == 1 else 1.0)
    density = np.diag((0, 0, 2.0 * axes.acceleration_sigma**2 / axes.acceleration_time, 0, 4.0 * z * w**3 * sigma**2))
    a = system(axes.acceleration_time)
    van_loan = expm(step * np.block([[-a, density], [np.zeros_like(a), a.T]]))
    exact = van_loan[ORDER:, ORDER:].T @ van_loan[:ORDER, ORDER:]
    scale = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    assert (
        np.abs((found - exact) / scale).max() < 0.06
    )  # to first order in the step: decay and swing within it are left out
