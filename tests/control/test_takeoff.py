import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.control.command import Command
from matchset.control.ego_motion import AttitudeCommand, EgoMotion
from matchset.control.follower import Follower
from matchset.control.learned.takeoff import TakeoffParameters, attribute_vertical_speed
from matchset.control.neighbor_filter import NeighborFilter
from matchset.localization.pose import Pose

STEP, LATENCY, RISES = 1.0 / 30.0, 0.067, 0.3
SPREAD = np.diag([1e-4] * 3 + [1e-3] * 3)
TURNS = np.diag((-1.0, 1.0, -1.0))  # the ball frame of a vehicle that looks along +z


def risen(seconds: float, parameters: TakeoffParameters) -> tuple[EgoMotion, NeighborFilter]:
    """Dead reckoning and filter of a vehicle that rises steadily, believes that it hovers, and sees a ball at rest."""
    own, neighbor = EgoMotion(), NeighborFilter()
    for k in range(round(seconds / STEP)):
        now = k * STEP
        own.update(AttitudeCommand(), now)
        taken = now - LATENCY
        pose = Pose(
            position=np.array((0.0, RISES * taken, 1.5)),
            rotation_matrix=TURNS,
            covariance=SPREAD,
            observed="level",
            time=taken,
        )
        assert neighbor.update(pose, own.at(taken))
        attribute_vertical_speed(own, neighbor, taken, STEP, parameters)
    return own, neighbor


def test_a_speed_that_dead_reckoning_misses_becomes_the_vehicles_own() -> None:
    own, neighbor = risen(1.4, TakeoffParameters())
    assert own.at(1.3).velocity[1] == pytest.approx(-RISES, abs=0.06)
    assert neighbor.vertical_speed == pytest.approx(0.0, abs=0.06)


def test_before_it_lifts_off_and_later_speeds_stay_whose_they_are() -> None:
    own, neighbor = risen(1.4, TakeoffParameters(duration=0.0))
    assert own.at(1.3).velocity[1] == 0.0
    assert neighbor.vertical_speed == pytest.approx(RISES, abs=0.06)
    for lifted in (-math.inf, -1e-6, 1.5, math.inf):
        attribute_vertical_speed(own, neighbor, lifted, STEP, TakeoffParameters())
        assert own.at(1.3).velocity[1] == 0.0


@settings(deadline=None)
@given(st.floats(0.0, 1.49), st.floats(1e-3, 1.0))
def test_what_is_handed_over_changes_no_difference_of_speeds(lifted: float, since: float) -> None:
    own, neighbor = risen(0.5, TakeoffParameters(duration=0.0))
    before = neighbor.vertical_speed, own.at(neighbor.time).position.copy()
    attribute_vertical_speed(own, neighbor, lifted, since, TakeoffParameters())
    after = own.at(neighbor.time + 0.1)
    assert neighbor.vertical_speed == pytest.approx(before[0] * math.exp(-since / 0.3), abs=1e-9)
    speed = float(after.velocity[1])
    assert neighbor.vertical_speed - speed == pytest.approx(before[0], rel=0.04)  # drag slows by 3 % in 0.1 s
    np.testing.assert_allclose(own.at(neighbor.time).position, before[1], atol=2e-3)
    assert after.position[1] == pytest.approx(before[1][1] + 0.1 * speed, rel=0.04, abs=2e-3)


def test_a_speed_is_added_to_what_comes_after_and_to_nothing_before() -> None:
    plain, changed = EgoMotion(), EgoMotion()
    for k in range(30):
        for motion in (plain, changed):
            motion.update(AttitudeCommand(0.1, -0.05, 0.2, 0.5), k * STEP)
    changed.add_vertical_speed(0.4, 0.6)
    for time in (0.3, 0.59):
        np.testing.assert_array_equal(changed.at(time).block, plain.at(time).block)
    for time in (0.7, 0.9, 1.05):
        late = changed.at(time).block - plain.at(time).block
        assert changed.at(time).velocity[1] - plain.at(time).velocity[1] == pytest.approx(0.4, rel=0.05)
        assert changed.at(time).position[1] - plain.at(time).position[1] == pytest.approx(0.4 * (time - 0.6), rel=0.05)
        assert np.count_nonzero(late) == 2
    EgoMotion().add_vertical_speed(0.4, 0.6)  # nothing was sent yet: nothing happens


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


@pytest.mark.parametrize("bad", [{"duration": -1.0}, {"duration": math.nan}, {"time_constant": 0.0}])
def test_times_that_are_none_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        TakeoffParameters(**bad)


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
