"""Rotations inside kernels against SciPy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from balls import Floats
from matchset.numeric.rotation import rotate, rotation_vector_between

vectors = st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(np.array)


@given(vectors, vectors)
def test_turns_agree_with_scipy(one: Floats, other: Floats) -> None:
    first, second = Rotation.from_rotvec(one), Rotation.from_rotvec(other)
    vector = np.empty(3)
    angle = rotation_vector_between(first.as_matrix(), second.as_matrix(), vector)
    theirs = second * first.inv()
    assert angle == pytest.approx(theirs.magnitude(), abs=1e-7)
    turn = first.as_matrix()
    rotate(turn, vector)
    np.testing.assert_allclose(turn, second.as_matrix(), atol=1e-7)
