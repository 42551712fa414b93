"""The rotation from directions of markers, against SciPy's `Rotation.align_vectors`."""

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from matchset.localization.attitude import ATTITUDE, AttitudeParameters, fit_rotation, rotation_from_two
from matchset.numeric.record import fields, new_block, store

Floats = npt.NDArray[np.float64]
RNG = np.random.default_rng(0)


def unit_vectors(count: int) -> Floats:
    vectors = RNG.normal(size=(count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


@pytest.mark.parametrize("count", [2, 3, 6])
def test_with_equal_weights_it_is_scipy_s(count: int) -> None:
    for seed in range(5):
        bodies, truth = unit_vectors(count), Rotation.random(random_state=seed)
        seen = truth.apply(bodies) + RNG.normal(0.0, 0.01, (count, 3))
        seen /= np.linalg.norm(seen, axis=1, keepdims=True)
        block = new_block(ATTITUDE)
        fit = fields(block, ATTITUDE)
        store(fit.limits, AttitudeParameters())
        fit.count = count
        fit.bodies[:count], fit.directions[:count] = bodies, seen
        fit.weights[:] = np.eye(3)
        rotation = truth.as_matrix()
        cost = fit_rotation(block.view(ATTITUDE)[0], np.arange(count), rotation)
        theirs, _ = Rotation.align_vectors(seen, bodies)
        np.testing.assert_allclose(rotation, theirs.as_matrix(), atol=1e-7)
        assert cost == pytest.approx(np.square(seen - theirs.apply(bodies)).sum(), rel=1e-6)


def test_two_directions_fix_a_rotation() -> None:
    bodies, truth, rotation = unit_vectors(2), Rotation.random(random_state=1), np.empty((3, 3))
    assert rotation_from_two(bodies, truth.apply(bodies), 0.02, rotation)
    np.testing.assert_allclose(rotation, truth.as_matrix(), atol=1e-12)
    assert not rotation_from_two(bodies[[0, 0]], truth.apply(bodies), 0.02, rotation)
