import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.command import Command
from matchset.control.ego_motion import EgoMotion
from matchset.control.follower import Follower
from matchset.control.learned.common_motion import CommonMotionParameters, hand_over
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.sticks.ego_parameters import AttitudeCommand
from matchset.localization.pose import Pose

STEP, LATENCY = 1.0 / 30.0, 0.067
MOVES = np.array((0.2, -0.3, -0.1))  # m/s
SPREAD = np.diag([1e-4] * 3 + [1e-3] * 3)
TURNS = np.diag((-1.0, 1.0, -1.0))  # the ball frame of a vehicle that looks along +z
NEVER = CommonMotionParameters(horizontal_time=1e9, vertical_time=1e9, takeoff_duration=0.0)


def moved(seconds: float, parameters: CommonMotionParameters) -> tuple[EgoMotion, NeighborFilter]:
    """Dead reckoning and filter of a vehicle that moves steadily, believes that it stands, and sees a ball at rest."""
    own, neighbor = EgoMotion(), NeighborFilter()
    for k in range(round(seconds / STEP)):
        now = k * STEP
        own.update(AttitudeCommand(), now)
        taken = now - LATENCY
        pose = Pose(
            position=np.array((0.0, 0.0, 1.5)) - MOVES * taken,
            rotation_matrix=TURNS,
            covariance=SPREAD,
            observed="level",
            time=taken,
        )
        assert neighbor.update(pose, own.at(taken))
        hand_over(own, (neighbor,), max(taken, 0.0), STEP, parameters)
    return own, neighbor


def test_at_takeoff_a_vertical_speed_becomes_the_vehicles_own_at_once() -> None:
    own, neighbor = moved(1.4, CommonMotionParameters(horizontal_time=1e9))
    assert own.at(1.3).velocity == pytest.approx((0.0, MOVES[1], 0.0), abs=0.06)
    assert neighbor.velocity == pytest.approx((-MOVES[0], 0.0, -MOVES[2]), abs=0.06)


def test_later_every_velocity_does_with_its_time_constant() -> None:
    slow = CommonMotionParameters(horizontal_time=1.0, vertical_time=1.5, takeoff_duration=0.0)
    own, neighbor = moved(8.0, slow)
    assert own.at(8.0).velocity == pytest.approx(MOVES, abs=0.11)  # drag takes some of it away again
    assert np.linalg.norm(neighbor.velocity) < 0.3 * np.linalg.norm(MOVES)


def test_in_a_hand_velocities_stay_whose_they_are() -> None:
    own, neighbor = moved(1.4, NEVER)
    assert neighbor.velocity == pytest.approx(-MOVES, abs=0.06)
    before = neighbor.velocity
    for lifted in (-math.inf, -1e-6, math.nan):
        hand_over(own, (neighbor,), lifted, STEP, CommonMotionParameters())
    np.testing.assert_array_equal(neighbor.velocity, before)
    np.testing.assert_allclose(own.at(1.3).velocity, np.zeros(3), atol=1e-6)


@given(st.floats(0.0, 20.0), st.floats(1e-3, 1.0))
def test_what_is_handed_over_changes_no_difference_of_velocities(lifted: float, since: float) -> None:
    own, neighbor = moved(0.5, NEVER)
    other = NeighborFilter()
    before, place = neighbor.velocity, own.at(neighbor.time).position.copy()
    hand_over(own, (neighbor, other), lifted, since, CommonMotionParameters())
    after = own.at(neighbor.time + 0.1)
    times = np.array((3.0, 0.3 if lifted < 1.5 else 10.0, 3.0))
    np.testing.assert_allclose(neighbor.velocity, before * np.exp(-since / times), atol=1e-9)
    np.testing.assert_allclose(other.velocity, neighbor.velocity - before, atol=1e-12)
    np.testing.assert_allclose(neighbor.velocity - after.velocity, before, rtol=0.05, atol=1e-3)  # drag: 3 % in 0.1 s
    np.testing.assert_allclose(own.at(neighbor.time).position, place, atol=2e-3)
    np.testing.assert_allclose(after.position, place + 0.1 * after.velocity, rtol=0.04, atol=2e-3)


def test_a_speed_is_added_to_what_comes_after_and_to_nothing_before() -> None:
    plain, changed = EgoMotion(), EgoMotion()
    for k in range(30):
        for motion in (plain, changed):
            motion.update(AttitudeCommand(0.1, -0.05, 0.2, 0.5), k * STEP)
    kick = np.array((0.1, 0.4, -0.2))
    changed.add_velocity(kick, 0.6)
    for time in (0.3, 0.59):
        np.testing.assert_array_equal(changed.at(time).block, plain.at(time).block)
    for time in (0.7, 0.9, 1.05):
        late, was = changed.at(time), plain.at(time)
        np.testing.assert_allclose(late.velocity - was.velocity, kick, rtol=0.05)
        np.testing.assert_allclose(late.position - was.position, kick * (time - 0.6), rtol=0.05)
        assert np.count_nonzero(late.block - was.block) == 6
    EgoMotion().add_velocity(kick, 0.6)  # nothing was sent yet: nothing happens


def test_sticks_stay_in_the_middle_until_the_thrust_suffices() -> None:
    follower = Follower()
    for k in range(40):
        now, taken = k * STEP, k * STEP - LATENCY
        place = np.array((0.4, 0.19, 1.9))  # far off: every stick is wanted
        pose = Pose(position=place, rotation_matrix=TURNS, covariance=SPREAD, observed="level", time=taken)
        output = follower.update(pose, now)
        if output is None:
            continue
        sticks = output.desired[:3]
        lifts = now + follower.ego_motion.delay >= follower.thrust.lift_time
        assert lifts == any(sticks), (k, sticks)
        follower.sent(Command(throttle=min(0.05 * k, 0.6)), now)
    assert follower.thrust.lift_time == pytest.approx(9 * STEP + 0.03 + 2 * 0.05)  # 0.45 of 0.59: 0.7 and more
    follower.sent(Command(), 41 * STEP)
    assert follower.thrust.lift_time == math.inf


@pytest.mark.parametrize(
    ("bad", "name"),
    [
        ({"takeoff_duration": -1.0}, "takeoff_duration"),
        ({"takeoff_duration": math.nan}, "takeoff_duration"),
        ({"takeoff_time": 0.0}, "takeoff_time"),
        ({"horizontal_time": 0.0}, "horizontal_time"),
        ({"vertical_time": math.inf}, "vertical_time"),
    ],
)
def test_times_that_are_none_are_refused(bad: dict[str, float], name: str) -> None:
    with pytest.raises(ValueError, match=name):
        CommonMotionParameters(**bad)


def test_what_the_controllers_integrate_in_the_hand_is_forgotten() -> None:
    follower = Follower()
    for k in range(60):
        now, taken = k * STEP, k * STEP - LATENCY
        place = np.array((0.1, 0.19, 1.6))  # within the integral's zone
        output = follower.update(
            Pose(position=place, rotation_matrix=TURNS, covariance=SPREAD, observed="level", time=taken), now
        )
        follower.sent(Command(throttle=0.3), now)  # too little to lift
    assert output is not None
    assert max(abs(terms.integral) for terms in (output.right, output.forward, output.yaw)) < 0.02
    assert follower.ego_motion.at(now).velocity[[0, 2]] == pytest.approx(0.0, abs=0.02)
