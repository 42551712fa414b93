import itertools
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from matchset.control.command import Command
from matchset.control.control_output import ControlOutput
from matchset.control.ego_motion import EgoMotion
from matchset.control.follower import Follower, FollowerParameters, RelativeSetpoint
from matchset.control.sticks.ego_parameters import GRAVITY, AttitudeCommand
from matchset.localization.pose import UNOBSERVED_VARIANCE, Pose
from matchset.tracking.track import Lost

STEP, LATENCY = 1.0 / 30.0, 0.067
SPREAD = np.diag([1e-4] * 3 + [1e-3] * 3)
TURNS = Rotation.from_euler("y", math.pi).as_matrix()  # the ball frame of a vehicle that looks along +z


class World:
    """A vehicle that obeys the follower's own model, biased, and a neighbor that does as it is told."""

    def __init__(
        self, follower: Follower, start: tuple[float, float, float], bias: float = 0.0, turning: float = 0.0
    ) -> None:
        self.follower, self.bias, self.turning = follower, bias, turning
        self.motion = EgoMotion(follower.parameters.ego_motion)
        self.start = np.array(start)
        self.neighbor, self.neighbor_yaw = np.zeros(3), 0.0

    def see(self, time: float) -> Pose:
        state = self.motion.at(time)
        turn = state.rotation
        ball = Rotation.from_euler("y", self.neighbor_yaw).as_matrix() @ TURNS
        return Pose(
            position=turn.T @ (self.neighbor - self.start - state.position),
            rotation_matrix=turn.T @ ball,
            covariance=SPREAD,
            observed="level",
            time=time,
        )

    def obey(self, command: Command, now: float) -> None:
        limits = self.follower.parameters
        tilt = limits.ego_motion.full_tilt
        lift = GRAVITY * (command.throttle / limits.hover_throttle * 0.95 - 1.0)
        turning = limits.ego_motion.full_yaw_rate * command.yaw + self.turning
        self.motion.update(
            AttitudeCommand(tilt * command.roll + self.bias, tilt * command.pitch - self.bias, turning, lift), now
        )

    def place(self, time: float) -> tuple[float, float, float]:
        """Side, height and heading in the level frame of the neighbor's ball."""
        away = self.start + self.motion.at(time).position - self.neighbor
        out = -np.array((math.sin(self.neighbor_yaw), 0.0, math.cos(self.neighbor_yaw)))
        return float(away @ np.array((out[2], 0.0, -out[0]))), -float(away[1]), float(away @ out)


def run(world: World, seconds: float, begin: float = 0.0, lost: bool = False) -> list[ControlOutput | None]:
    answers = []
    for k in range(round(seconds / STEP)):
        taken = begin + k * STEP
        now = taken + LATENCY
        pose = Lost[Pose]("hidden", taken) if lost else world.see(taken)
        answer = world.follower.update(pose, now)
        answers.append(answer)
        desired = None if answer is None else answer.desired
        command = Command(throttle=0.55) if desired is None else clipped(desired)
        world.follower.sent(command, now)
        world.obey(command, now)
    return answers


def clipped(desired: tuple[float, ...]) -> Command:
    roll, pitch, yaw = (min(max(value, -1.0), 1.0) for value in desired[:3])
    return Command(roll, pitch, yaw, min(max(desired[3], 0.0), 1.0))


def test_it_goes_to_its_place_and_stays_with_biased_sticks() -> None:
    world = World(Follower(RelativeSetpoint(side=0.1, height=-0.2, heading=1.5)), (0.5, 0.5, -2.0), bias=0.035)
    run(world, 12.0)
    assert world.place(12.0) == pytest.approx((0.1, -0.2, 1.5), abs=0.02)
    run(world, 3.0, 12.0)
    assert world.place(15.0) == pytest.approx((0.1, -0.2, 1.5), abs=0.01)


def test_it_goes_around_a_neighbor_that_turns_and_turns_with_it() -> None:
    world = World(Follower(), (0.0, 0.0, -1.5))
    run(world, 2.0)
    world.neighbor_yaw = 0.35
    answers = run(world, 25.0, 2.0)  # a turn looks like a trim at first, which takes 10 s to unlearn
    assert world.place(14.0) == pytest.approx((0.0, 0.0, 1.5), abs=0.02)
    assert world.motion.at(27.0).yaw == pytest.approx(0.35, abs=0.02)
    answer = answers[-1]
    assert answer is not None
    assert abs(answer.bearing) < 0.02
    assert (answer.side, answer.height, answer.heading) == pytest.approx(world.place(27.0), abs=0.02)


@pytest.mark.parametrize("trim", [0.175, -0.175])
def test_a_yaw_trim_of_ten_degrees_a_second_is_learned(trim: float) -> None:
    world = World(Follower(), (0.0, 0.0, -1.5), turning=trim)
    answer = run(world, 50.0)[-1]
    assert answer is not None
    assert abs(answer.bearing) < 0.04
    assert answer.yaw.integral == pytest.approx(-trim, abs=0.02)
    assert world.place(50.0) == pytest.approx((0.0, 0.0, 1.5), abs=0.03)


def test_with_the_ball_hidden_it_flies_on_for_a_while_and_then_has_no_answer() -> None:
    world = World(Follower(), (0.2, 0.1, -1.7))
    run(world, 8.0)
    answers = run(world, 2.0, 8.0, lost=True)
    known = [answer is not None for answer in answers]
    assert all(known[:30])
    assert not any(known[40:])
    assert world.place(9.0) == pytest.approx((0.0, 0.0, 1.5), abs=0.1)


def test_it_tells_where_the_ball_should_be_in_the_picture() -> None:
    world = World(Follower(), (0.0, 0.1, -1.5))
    assert world.follower.expected(0.0) is None
    run(world, 4.0)
    there = world.follower.expected(4.2)
    assert there is not None
    np.testing.assert_allclose(there, world.see(4.2).position, atol=0.03)
    assert world.follower.expected(9.0) is None


def test_a_neighbor_that_turns_back_and_forth_is_followed_closely() -> None:
    world, off = World(Follower(), (0.0, 0.0, -1.5), bias=0.035), []
    for k in range(round(24.0 / STEP)):
        world.neighbor_yaw = 0.3 * math.sin(2.0 * math.pi * k * STEP / 8.0)
        run(world, STEP, k * STEP)
        if k * STEP > 8.0:
            off.append(world.place(k * STEP)[0])
    assert np.sqrt(np.mean(np.square(off))) < 0.06


def test_before_the_first_sight_and_without_a_marker_it_has_no_answer() -> None:
    follower = Follower()
    assert follower.update(Lost("nothing there", 0.0), 0.1) is None
    alone = Pose(
        position=np.array((0.0, 0.0, 2.0)), rotation_matrix=None, covariance=SPREAD, observed="position", time=0.2
    )
    assert follower.update(alone, 0.3) is None


def test_bad_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="hover_throttle"):
        FollowerParameters(hover_throttle=1.5)
    with pytest.raises(ValueError, match="max_extrapolation"):
        FollowerParameters(max_extrapolation=math.nan)


def seen_at(position: tuple[float, float, float], yaw: float, time: float) -> Pose:
    turn = Rotation.from_euler("y", yaw).as_matrix() @ TURNS
    return Pose(
        position=np.array(position), rotation_matrix=turn, covariance=SPREAD, observed="level", time=time
    )  # fmt: skip


def hovering(turning: float) -> tuple[Follower, float]:
    """A follower in level flight that has turned to the right for a while; and the time."""
    follower, now = Follower(), 0.0
    for k in range(60):
        now = k * STEP
        follower.sent(Command(throttle=0.59, yaw=turning if k < 30 else 0.0), now)
    return follower, now


@pytest.mark.parametrize("quarters", [1.0, -1.0])
def test_where_it_looks_makes_no_difference_to_what_it_does(quarters: float) -> None:
    """A neighbor that moves sideways, away and up, and turns; seen alike by a follower that has turned before."""
    (straight, begin), (half, _) = hovering(0.0), hovering(0.5)
    turned, _ = hovering(0.5 * quarters * (math.pi / 2.0) / half.ego_motion.at(begin).yaw)
    assert turned.ego_motion.at(begin).yaw == pytest.approx(quarters * math.pi / 2.0)
    for k in range(1, 25):
        taken, now = begin + (k - 1) * STEP, begin + k * STEP
        pose = seen_at((0.1 + 0.02 * k, -0.01 * k, 1.6 + 0.015 * k), 0.02 * k, taken)
        one, other = straight.update(pose, now), turned.update(pose, now)
        assert one is not None
        assert other is not None
        np.testing.assert_allclose(other.desired, one.desired, atol=1e-5)
        np.testing.assert_allclose(other[1:5], one[1:5], atol=1e-5)
        for follower in (straight, turned):
            follower.sent(Command(throttle=0.59), now)


def test_a_pose_that_was_used_is_not_used_again() -> None:
    followers = [Follower(), Follower()]
    for k in range(30):
        taken, now = k * STEP, k * STEP + LATENCY
        pose = seen_at((0.02 * k, 0.0, 1.6), 0.01 * k, taken)
        second: list[Pose | Lost[Pose]] = [pose, Lost[Pose]("the same picture", taken)]
        for follower, again in zip(followers, second, strict=True):
            follower.update(pose, now)
            follower.sent(Command(throttle=0.59), now)
            follower.update(again, now + 0.01)
            follower.update(again, now + 0.02)
    one, other = (follower.update(Lost("hidden", 1.0), 1.05) for follower in followers)
    assert one == other
    assert one is not None


def test_a_tilted_vehicle_gets_more_throttle_and_its_lift_is_that_of_the_controller() -> None:
    world = World(Follower(), (0.6, 0.4, -2.4))
    tilted = 0.0
    for k in range(30):
        (answer,) = run(world, STEP, k * STEP)
        hover = world.follower.hover_throttle
        assert answer is not None
        now = k * STEP + LATENCY
        parameters = world.follower.parameters
        state = world.follower.ego_motion.at(now + parameters.ego_motion.delay)
        gravity = GRAVITY / parameters.ego_motion.effective_mass_ratio
        upright = math.cos(state.roll) * math.cos(state.pitch)
        lift = hover * (1.0 + answer.up.output / gravity)
        assert answer.desired.throttle == pytest.approx(lift / upright, rel=0.01)
        tilted = max(tilted, 1.0 - upright)
    assert tilted > 0.02


def test_with_the_motors_off_it_forgets_what_it_had_learned_on_every_axis() -> None:
    world = World(Follower(), (0.1, 0.1, -1.6), bias=0.035)
    answer = run(world, 6.0)[-1]
    assert answer is not None
    assert min(abs(terms.integral) for terms in (answer.right, answer.forward)) > 0.05
    assert world.follower.hover_throttle == pytest.approx(0.59 / 0.95, rel=0.02)
    world.follower.sent(Command(), 6.0 + LATENCY)
    again = world.follower.update(world.see(6.0), 6.0 + LATENCY)
    assert again is not None
    assert max(abs(terms.integral) for terms in (again.right, again.forward)) < 0.03
    assert world.follower.hover_throttle == 0.59


def without_marker(world: World, seconds: float) -> tuple[list[ControlOutput], list[tuple[float, float, float]]]:
    """Fly for 5 s with the marker in view, then without it."""
    answers, places = [], []
    run(world, 5.0)
    see = world.see

    def seen(time: float) -> Pose:
        pose = see(time)
        hidden = pose.covariance + np.diag([0.0] * 3 + [UNOBSERVED_VARIANCE] * 3)
        return Pose(
            position=pose.position, rotation_matrix=None, covariance=hidden, observed="position", time=pose.time
        )

    world.see = seen  # type: ignore[method-assign]
    for k in range(round(seconds)):
        for answer in run(world, 1.0, begin=5.0 + k):
            assert answer is not None
            answers.append(answer)
        places.append(world.place(6.0 + k))
    return answers, places


@pytest.mark.parametrize("place", [RelativeSetpoint(), RelativeSetpoint(side=0.6, height=0.1, heading=1.2)])
def test_a_vehicle_that_has_not_seen_the_marker_for_long_is_held_by_the_ball_alone(place: RelativeSetpoint) -> None:
    follower = Follower(place)
    answers, places = without_marker(World(follower, (-place.side, -place.height, -place.heading), turning=0.08), 20.0)
    assert not answers[5].doubt
    assert answers[-1].doubt == "no marker for 20 s, held by the ball alone"
    assert answers[-1].words.startswith(answers[-1].doubt)
    away = [math.hypot(side, heading) for side, _, heading in places]
    assert away == pytest.approx([math.hypot(place.side, place.heading)] * len(away), abs=0.05)
    assert [height for _, height, _ in places] == pytest.approx([place.height] * len(places), abs=0.03)
    steps = [math.hypot(a[0] - b[0], a[2] - b[2]) for a, b in itertools.pairwise(places)]
    assert max(steps) < 0.05  # m within a second: it does not fly around the neighbor


def test_the_direction_of_the_marker_is_the_less_known_the_older_it_is() -> None:
    follower = Follower()
    run(World(follower, (0.0, 0.0, -1.5)), 5.0)
    known = [
        follower.neighbor.yaw_sigma(follower.neighbor.yaw_time + gone) for gone in (-0.1, 0.0, 0.1, 0.5, 1.0, 20.0)
    ]
    assert known[0] == known[1] < 0.1
    assert known == sorted(known)
    assert known[3] < follower.parameters.max_yaw_sigma < known[4]
