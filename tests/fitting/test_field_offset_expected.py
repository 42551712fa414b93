"""The field offset that is expected: from the last speed, and from the way in this frame once that was fitted."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from matchset.fitting import prior
from matchset.fitting.prior import FieldParameters, correct_field_offset, predict_field_offset
from matchset.numeric.jit import interpreted

LIMITS = FieldParameters()


@pytest.fixture(autouse=True)
def in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rules are called as Python, with a workspace that is no record."""
    monkeypatch.setattr(prior, "time_between_fields", interpreted(prior.time_between_fields))


def known_fields(velocity: tuple[float, float], way: tuple[float, float], between: float = 0.02) -> Any:
    """A shape seen 1/25 s ago, its fields known to be `between` apart, s, and a fit that moved it by `way`, px."""
    speed = float(np.hypot(*velocity))
    predicted = np.array(velocity) / 25.0
    noted = 1e6
    motion = SimpleNamespace(
        velocity=np.array(velocity),
        speed=speed,
        speed_moment=noted,
        offset_moment=between * noted,
        predicted=predicted,
        last_state=np.zeros(2),
    )
    window = SimpleNamespace(speed=speed / 25.0, velocity_unknown=0, use_prior=1)
    offset = SimpleNamespace(fitted=np.zeros(2), expected=np.zeros(2), sigma=0.0)
    return SimpleNamespace(field_limits=LIMITS, motion=motion, window=window, field_offset=offset, state=np.array(way))


def test_a_steady_way_changes_nothing() -> None:
    work = known_fields((100.0, -200.0), (4.0, -8.0))
    interpreted(predict_field_offset)(work)
    np.testing.assert_allclose(work.field_offset.expected, (2.0, -4.0))
    sigma = work.field_offset.sigma
    interpreted(correct_field_offset)(work)
    np.testing.assert_allclose(work.field_offset.expected, (2.0, -4.0))
    np.testing.assert_allclose(work.field_offset.fitted, (2.0, -4.0))
    assert work.field_offset.sigma == sigma


def test_a_shape_that_changed_its_speed_has_its_fields_where_this_frame_puts_them() -> None:
    work = known_fields((0.0, 100.0), (3.0, 10.0))  # predicted (0, 4): 3 and 6 px farther in 1/25 s
    interpreted(predict_field_offset)(work)
    interpreted(correct_field_offset)(work)
    np.testing.assert_allclose(work.field_offset.expected, (1.5, 5.0))
    np.testing.assert_allclose(work.field_offset.fitted, (1.5, 5.0))


def test_the_other_field_may_come_first() -> None:
    work = known_fields((0.0, 100.0), (3.0, 10.0), between=-0.0215)  # near enough to half a frame to be that
    interpreted(predict_field_offset)(work)
    np.testing.assert_allclose(work.field_offset.expected, (0.0, -2.0))
    interpreted(correct_field_offset)(work)
    np.testing.assert_allclose(work.field_offset.expected, (-1.5, -5.0))


@pytest.mark.parametrize("between", [0.0, 0.004, -0.01, 0.03])
def test_where_the_fields_are_not_half_a_frame_apart_none_is_expected(between: float) -> None:
    work = known_fields((0.0, 100.0), (3.0, 10.0), between=between)
    interpreted(predict_field_offset)(work)
    np.testing.assert_array_equal(work.field_offset.expected, (0.0, 0.0))
    np.testing.assert_allclose(work.field_offset.sigma, 0.1 + 0.5 * work.window.speed)
    interpreted(correct_field_offset)(work)
    np.testing.assert_array_equal(work.field_offset.expected, (0.0, 0.0))


@pytest.mark.parametrize("nothing_to_tell", ["no prior", "no way", "velocity unknown"])
def test_what_tells_nothing_leaves_the_offset(nothing_to_tell: str) -> None:
    work = known_fields((0.0, 100.0), (3.0, 10.0))
    interpreted(predict_field_offset)(work)
    before = work.field_offset.expected.copy()
    if nothing_to_tell == "no prior":
        work.window.use_prior = 0
    elif nothing_to_tell == "no way":
        work.motion.predicted[:] = work.motion.last_state
    else:
        work.window.velocity_unknown = 1
    interpreted(correct_field_offset)(work)
    np.testing.assert_array_equal(work.field_offset.expected, before)
