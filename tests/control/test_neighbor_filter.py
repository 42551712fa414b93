import math

import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from matchset.control.ego_motion import STATE, EgoState
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.neighbor_model import Forecast, NeighborFilterParameters
from matchset.localization.pose import Pose
from matchset.numeric.record import fields, new_block

Floats = npt.NDArray[np.float64]
STILL = EgoState(new_block(STATE))
SPREAD = np.diag([1e-6] * 3 + [1e-4] * 3)


def seen(place: tuple[float, float, float], time: float, way: float = math.pi) -> Pose:
    turn = Rotation.from_euler("y", way).as_matrix()
    return Pose(position=np.array(place), rotation_matrix=turn, covariance=SPREAD, observed="level", time=time)


def numbers(forecast: Forecast) -> Floats:
    return np.array([msgspec.structs.astuple(axis) for axis in msgspec.structs.astuple(forecast)])


def watched(motion: NeighborFilter, seconds: float, place: object) -> None:
    for k in range(round(seconds * 30)):
        motion.update(seen(place(k / 30), k / 30), STILL)  # type: ignore[operator]


def test_a_steady_flight_is_extrapolated() -> None:
    motion = NeighborFilter()
    watched(motion, 4.0, lambda t: (0.2 * t, 0.1, 1.5 - 0.1 * t))
    ahead = numbers(motion.at(4.2, 0.4))
    np.testing.assert_allclose(ahead[:3, 0], (0.84, 0.1, 1.08), atol=0.02)
    np.testing.assert_allclose(ahead[:3, 1], (0.2, 0.0, -0.1), atol=0.05)
    assert math.remainder(ahead[3, 0] - math.pi, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-3)


def test_a_swing_is_foreseen_half_a_second_ahead() -> None:
    w = 2.0 * math.pi / 2.2
    motion = NeighborFilter()
    watched(motion, 12.0, lambda t: (0.1 * math.sin(w * t), 0.0, 1.5))
    for gone in (0.1, 0.3, 0.5):
        time = 12.0 - 1 / 30 + gone
        assert numbers(motion.at(time, 0.4))[0, 0] == pytest.approx(0.1 * math.sin(w * time), abs=0.02)
        assert numbers(motion.at(time, 0.4))[0, 1] == pytest.approx(0.1 * w * math.cos(w * time), abs=0.06)


def test_unseen_for_long_its_drift_stands() -> None:
    motion = NeighborFilter(NeighborFilterParameters(oscillation_sigma=1e-4))
    watched(motion, 4.0, lambda t: (0.2 * t, 0.0, 1.5))
    late = [numbers(motion.at(4.0 + gone, 0.4))[0, 0] for gone in (0.5, 1.0, 1.4)]
    assert late[0] == pytest.approx(late[2], abs=0.01)
    assert numbers(motion.at(1e6, 0.4))[0, 1] == pytest.approx(0.0, abs=0.01)


def test_an_outlier_is_refused_and_a_new_place_is_believed_after_a_while() -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    assert not motion.update(seen((0.6, 0.0, 1.5), 3.0), STILL)
    assert motion.time < 3.0
    believed = [motion.update(seen((0.6, 0.0, 1.5), 3.0 + k / 30), STILL) for k in range(1, 12)]
    assert believed[-1]
    assert numbers(motion.at(3.4, 0.4))[0, 0] == pytest.approx(0.6, abs=0.05)


def test_the_marker_of_a_pose_that_is_refused_is_not_believed_either() -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    assert not motion.update(seen((0.6, 0.0, 1.5), 3.0, math.pi - 0.1), STILL)
    assert motion.yaw_time < 3.0
    assert motion.update(seen((0.0, 0.0, 1.5), 3.0 + 1 / 30, math.pi - 0.02), STILL)
    assert motion.yaw_time == 3.0 + 1 / 30
    turned = math.remainder(numbers(motion.at(3.1, 0.4))[3, 0] - math.pi, 2.0 * math.pi)
    assert -0.03 < turned < 0.0


@pytest.mark.parametrize("gone", [0.0, 0.5, 1.0, 2.0])
def test_the_ball_behind_the_neighbor_is_never_taken_for_it(gone: float) -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    assert not any(motion.update(seen((0.0, 0.0, 3.0), 3.0 + gone + k / 30), STILL) for k in range(20))
    assert motion.update(seen((0.02, 0.0, 1.5), 3.0 + gone + 0.7), STILL)


def drifted(x: float) -> EgoState:
    """A vehicle that stands still and whose dead reckoning says that it has moved to the side."""
    block = new_block(STATE)
    fields(block, STATE).position[0] = x
    return EgoState(block)


@pytest.mark.parametrize("off", [0.45, 0.8, 1.5])
def test_a_ball_that_is_seen_steadily_is_believed_however_far_dead_reckoning_has_drifted(off: float) -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    believed = [motion.update(seen((0.0, 0.0, 1.5), 3.0 + k / 30), drifted(off)) for k in range(12)]
    assert not believed[0]
    assert all(believed[10:])
    assert motion.time == 3.0 + 11 / 30
    assert motion.doubt == ""


def test_another_ball_is_known_by_its_distance_even_where_the_neighbor_is_expected() -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    block = new_block(STATE)
    fields(block, STATE).position[2] = -1.5
    assert not any(motion.update(seen((0.0, 0.0, 3.0), 3.0 + k / 30), EgoState(block)) for k in range(30))
    assert motion.doubt == "a ball is seen, but at the distance of another vehicle's"


def test_poses_that_do_not_agree_with_each_other_never_win() -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    sides = ((-1.0) ** k * 0.9 for k in range(15))
    assert not any(motion.update(seen((side, 0.0, 1.2), 3.0 + k / 30), STILL) for k, side in enumerate(sides))
    assert motion.doubt == "a ball is seen, but not where the neighbor should be"


def test_another_ball_in_between_does_not_keep_the_neighbor_from_being_believed() -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    believed = []
    for k in range(24):
        believed.append(motion.update(seen((0.0, 0.0, 1.5), 3.0 + k / 30), drifted(0.8)) if k % 2 else False)
        assert k % 2 or not motion.update(seen((0.2, 0.0, 3.1), 3.0 + k / 30), drifted(0.8))
    assert any(believed)


def test_the_gate_widens_with_each_pose_that_is_refused_and_agrees() -> None:
    def refused(widening: float) -> int:
        motion = NeighborFilter(NeighborFilterParameters(widening=widening))
        watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
        believed = [motion.update(seen((0.0, 0.0, 1.5), 3.0 + k / 30), drifted(0.22)) for k in range(12)]
        return believed.index(True)

    assert 0 < refused(1.0) < refused(1e-6) <= 10


def test_after_three_seconds_all_begins_anew() -> None:
    motion = NeighborFilter()
    watched(motion, 3.0, lambda _: (0.0, 0.0, 1.5))
    assert motion.update(seen((0.0, 0.0, 3.0), 6.1), STILL)


def test_the_way_of_the_marker_runs_on_past_half_a_turn() -> None:
    motion = NeighborFilter()
    for k in range(120):
        motion.update(seen((0.0, 0.0, 1.5), k / 30, math.pi - 0.2 + 0.1 * k / 30), STILL)
    assert numbers(motion.at(119 / 30, 0.4))[3, 0] == pytest.approx(math.pi - 0.2 + 0.1 * 119 / 30, abs=0.02)
    assert numbers(motion.at(119 / 30, 0.4))[3, 1] == pytest.approx(0.1, abs=0.05)


def test_poses_are_taken_to_the_frame_at_rest() -> None:
    block = new_block(STATE)
    fields(block, STATE).yaw = 0.5
    own = EgoState(block)
    motion = NeighborFilter()
    motion.update(seen((0.0, 0.0, 2.0), 0.0), own)
    np.testing.assert_allclose(
        numbers(motion.at(0.0, 0.4))[:3, 0], (2.0 * math.sin(0.5), 0.0, 2.0 * math.cos(0.5)), atol=1e-9
    )
    assert math.remainder(numbers(motion.at(0.0, 0.4))[3, 0] - math.pi - 0.5, 2.0 * math.pi) == pytest.approx(
        0.0, abs=1e-9
    )


def test_an_error_of_camera_or_diameter_does_not_decide_how_pictures_are_weighed() -> None:
    part = np.diag((0.01, 0.01, 0.04, 0.0, 0.0, 0.0))
    told, exact = NeighborFilter(), NeighborFilter()
    for k in range(30):
        pose = seen((0.1 * math.sin(k / 5), 0.0, 1.5), k / 30)
        exact.update(pose, STILL)
        whole = pose.covariance + part
        told.update(msgspec.structs.replace(pose, covariance=whole, systematic_covariance=part), STILL)
    np.testing.assert_allclose(numbers(told.at(1.1, 0.4)), numbers(exact.at(1.1, 0.4)), atol=1e-9)


def test_numbers_that_are_none_are_refused() -> None:
    with pytest.raises(ValueError, match="period"):
        NeighborFilterParameters(oscillation_period=0.0)
