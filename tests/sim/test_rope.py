import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from matchset.sim.rope import Rope, RopeParameters

STEP = 1.0 / 480.0


def swung(parameters: RopeParameters, seconds: float, seed: int = 0) -> tuple[Rope, np.ndarray]:
    rope = Rope(parameters, (1.0, -1.0, 2.0), np.random.default_rng(seed))
    places = []
    for _ in range(round(seconds / STEP)):
        rope.step(STEP)
        places.append(rope.position)
    return rope, np.array(places) - (1.0, -1.0, 2.0)


def period_of(places: np.ndarray) -> float:
    """Mean time between upward zero crossings along the plane of the swing."""
    level = places[:, [0, 2]]
    along = level @ np.linalg.svd(level, full_matrices=False)[2][0]
    up = np.flatnonzero((along[:-1] < 0.0) & (along[1:] >= 0.0))
    times = up + along[up] / (along[up] - along[up + 1])
    return float(np.diff(times).mean()) * STEP


@pytest.mark.parametrize("swing", [0.02, 0.1, 0.6])
def test_its_period_is_that_of_a_pendulum(swing: float) -> None:
    length = 1.2
    _, places = swung(RopeParameters(length=length, swing=swing, damping=0.0), 20.0)
    largest = math.asin(swing / length)
    exact = 2.0 * math.pi * math.sqrt(length / 9.81) * (1.0 + largest**2 / 16.0 + 11.0 * largest**4 / 3072.0)
    # the start is that of a small swing: its speed makes a wide one a little wider
    assert period_of(places) == pytest.approx(exact, rel=2e-4 if swing <= 0.1 else 3e-2)


def test_without_damping_its_energy_stays() -> None:
    rope, places = swung(RopeParameters(swing=0.5, damping=0.0), 30.0)
    start = Rope(RopeParameters(swing=0.5, damping=0.0), (1.0, -1.0, 2.0), np.random.default_rng(0))
    energy = [0.5 * each.state.velocity @ each.state.velocity - 9.81 * each.position[1] for each in (start, rope)]
    assert energy[1] == pytest.approx(energy[0], abs=1e-5)
    np.testing.assert_allclose(np.linalg.norm(places, axis=1), 1.2, atol=1e-12)


def test_damping_takes_its_share() -> None:
    _, places = swung(RopeParameters(swing=0.1, damping=0.02), 30.0)
    level = np.hypot(places[:, 0], places[:, 2])
    assert level[:1440].max() == pytest.approx(0.1, rel=0.05)
    assert level[-1440:].max() == pytest.approx(0.1 * math.exp(-0.02 * 28.5), rel=0.05)


def test_its_yaw_stays_within_twenty_degrees_and_uses_them() -> None:
    for seed in range(5):
        rope = Rope(RopeParameters(), (0.0, 0.0, 0.0), np.random.default_rng(seed))
        yaws = np.degrees([rope.yaw(0.05 * k) for k in range(4000)])
        assert 17.0 < np.abs(yaws).max() <= 20.0


def test_it_hangs_along_its_rope_and_looks_where_its_yaw_says() -> None:
    rope, _ = swung(RopeParameters(swing=0.4), 1.3)
    turn = rope.rotation(1.3)
    np.testing.assert_allclose(turn.T @ turn, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    np.testing.assert_allclose(turn[:, 1], (rope.position - rope.state.anchor) / 1.2, atol=1e-12)
    assert math.atan2(turn[0, 2], turn[2, 2]) == pytest.approx(rope.yaw(1.3), abs=0.05)


@pytest.mark.parametrize("time", [0.3, 1.3, 2.9])
def test_its_rotation_is_that_of_scipy(time: float) -> None:
    rope, _ = swung(RopeParameters(swing=0.6), time)
    down, ahead = rope.position - rope.state.anchor, (math.sin(rope.yaw(time)), 0.0, math.cos(rope.yaw(time)))
    expected, _ = Rotation.align_vectors([down, ahead], [(0.0, 1.0, 0.0), (0.0, 0.0, 1.0)], weights=[np.inf, 1.0])
    np.testing.assert_allclose(rope.rotation(time), expected.as_matrix(), atol=1e-12)


@pytest.mark.parametrize(
    ("field", "value"), [("length", 0.0), ("swing", 2.0), ("yaw_deg", -1.0), ("damping", math.nan)]
)
def test_a_rope_that_is_none_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        RopeParameters(**{field: value})  # type: ignore[arg-type]
