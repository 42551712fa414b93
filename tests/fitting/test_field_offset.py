"""The chosen edge points of both fields of a picture are brought to the mean of the two."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from matchset.fitting.robust_fit import _take_field_offset
from matchset.numeric.jit import interpreted

STATES, LINES = 5, 6


def test_the_edge_points_of_both_fields_are_brought_to_their_mean() -> None:
    outline = np.zeros((LINES, 4 + STATES + 2))
    normals = np.array([[1.0, 0.0], [0.0, 1.0], [0.6, 0.8], [-1.0, 0.0], [0.0, -1.0], [0.6, -0.8]])
    half = np.where(np.arange(LINES) % 2, -0.5, 0.5)[:, np.newaxis]
    outline[:, 4 + STATES :] = half * normals
    offset = np.array([3.0, -2.0])
    seen = (half * normals) @ offset  # what a shape at rest in the mean shows in each field
    edges = np.full((LINES, 3, 3), 99.0)
    chosen = np.zeros((LINES, 3))
    chosen[:, 2] = np.arange(LINES) % 3
    for line in range(LINES):
        edges[line, line % 3, 0] = seen[line]
    chosen[4, 0] = math.inf
    step = np.concatenate((np.zeros(STATES), offset))
    fitted = SimpleNamespace(fitted=np.full(2, 7.0))
    work = SimpleNamespace(outline=outline, edges=edges, chosen=chosen, step=step, field_offset=fitted)
    interpreted(_take_field_offset)(work, LINES, STATES, STATES + 2)
    left = np.array([edges[line, line % 3, 0] for line in range(LINES)])
    np.testing.assert_allclose(left, np.where(np.arange(LINES) == 4, seen, 0.0), atol=1e-12)
    assert fitted.fitted.tolist() == [3.0, -2.0]
    assert (edges[0, 1:, 0] == 99.0).all()
    interpreted(_take_field_offset)(work, LINES, STATES, STATES)
    assert fitted.fitted.tolist() == [0.0, 0.0]
    assert edges[1, 1, 0] == pytest.approx(0.0, abs=1e-12)
