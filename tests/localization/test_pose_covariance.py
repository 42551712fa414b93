import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from matchset.localization.pose import UNOBSERVED_VARIANCE, Pose, viewpoint_covariance, yaw_variance


def pose_at(seed: int) -> Pose:
    rng = np.random.default_rng(seed)
    root = 1e-3 * rng.standard_normal((6, 6))
    return Pose(
        position=rng.uniform((-1.0, -1.0, 0.5), (1.0, 1.0, 3.0)),
        rotation_matrix=Rotation.random(random_state=seed).as_matrix(),
        covariance=root @ root.T,
        observed="full",
        time=0.0,
    )


@settings(max_examples=10)
@given(st.integers(0, 10_000))
def test_spreads_are_those_of_a_sample(seed: int) -> None:
    pose = pose_at(seed)
    assert pose.rotation_matrix is not None
    errors = np.random.default_rng(seed).multivariate_normal(np.zeros(6), pose.covariance, 20_000)
    places = pose.position + errors[:, :3]
    turns = Rotation.from_rotvec(errors[:, 3:]) * Rotation.from_matrix(pose.rotation_matrix)
    seen = -turns.inv().apply(places)
    spread = viewpoint_covariance(pose)
    assert spread is not None
    assert np.cov(seen.T) == pytest.approx(spread, abs=0.05 * np.trace(spread))
    assert np.var(np.arctan2(places[:, 0], places[:, 2])) == pytest.approx(yaw_variance(pose), rel=0.1)
    assert pose.side == pytest.approx(seen[:, 0].mean(), abs=0.02)


def test_without_a_rotation_there_is_no_place_to_be_sure_of() -> None:
    covariance = np.diag((1e-4, 1e-4, 1e-4, UNOBSERVED_VARIANCE, UNOBSERVED_VARIANCE, UNOBSERVED_VARIANCE))
    pose = Pose(
        position=np.array((0.0, 0.0, 1.0)), rotation_matrix=None, covariance=covariance, observed="position", time=0.0
    )
    assert viewpoint_covariance(pose) is None
    assert yaw_variance(pose) == pytest.approx(1e-4)
