"""A vehicle that is told speeds: dead reckoning, sticks, the loops' margins, and a follower of it."""

import math

import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from matchset.control.chain.gain_schedule import Gains
from matchset.control.command import HOLD, Command
from matchset.control.ego_motion import EgoMotion, EgoState
from matchset.control.follower import Follower, FollowerParameters, RelativeSetpoint
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.safety import DesiredCommand
from matchset.control.stability.follower_loops import LOOPS, FollowerLoops, LoopConditions, LoopParameters
from matchset.control.stability.loop import Timing
from matchset.control.stability.margins import margins_of
from matchset.control.sticks.angle_sticks import AngleSticks, WantedMotion
from matchset.control.sticks.ego_parameters import GRAVITY, EgoMotionParameters, SpeedCommand
from matchset.control.sticks.speed_parameters import SpeedParameters
from matchset.control.sticks.speed_sticks import SpeedSticks, TakeOff
from matchset.localization.pose import Pose

Floats = npt.NDArray[np.float64]
FPS = 30
MODEL = EgoMotionParameters(speed_commands=True)
FOLLOWER = FollowerParameters(commands="speeds")
PLACE = RelativeSetpoint(heading=1.5)


def flown(command: SpeedCommand, seconds: float, model: EgoMotionParameters = MODEL) -> EgoMotion:
    own = EgoMotion(model)
    for k in range(round(seconds * FPS) + 1):
        own.update(command, k / FPS)
    return own


def slope(_: float, state: Floats, told: float, model: EgoMotionParameters) -> Floats:
    """Motors, tilt, its rate, speed and place of the equations in `ego_motion.py`."""
    motor, tilt, rate, speed, _ = state
    gravity, frequency = GRAVITY / model.effective_mass_ratio, 1.0 / model.tilt_time
    asked = math.atan((told - speed) / (model.speed_time * gravity))
    asked = min(max(asked, -model.full_tilt), model.full_tilt)
    turning = frequency * (frequency * (motor - tilt) - 2.0 * model.tilt_damping * rate)
    return np.array(((asked - motor) / model.tilt_lag, rate, turning, gravity * math.tan(tilt), speed))


@pytest.mark.parametrize("told", [0.2, -0.6, 1.0])
def test_a_level_speed_is_gone_over_to_as_the_equations_say(told: float) -> None:
    model = msgspec.structs.replace(MODEL, integration_step=1.0 / 480.0)
    own = EgoMotion(model)
    own.update(SpeedCommand(forward=told), 0.0)
    times = np.linspace(0.05, 0.3, 6)  # of the ring
    solved = solve_ivp(slope, (0.0, 1.0), np.zeros(5), t_eval=times, args=(told, model), rtol=1e-9, atol=1e-9)
    states = own.at_times((times + model.delay).tolist())
    assert [state.velocity.item(2) for state in states] == pytest.approx(solved.y[3].tolist(), abs=0.01 * abs(told))
    assert [state.pitch for state in states] == pytest.approx(solved.y[1].tolist(), abs=0.015 * abs(told))


def test_told_speeds_and_heights_are_reached_and_kept() -> None:
    own = flown(SpeedCommand(0.3, -0.2, 0.0, 0.4), 4.0)
    state = own.at(4.0)
    assert state.velocity == pytest.approx([0.3, -0.4, -0.2], abs=0.01)
    assert abs(state.roll) + abs(state.pitch) < 0.005
    later = own.at(4.4)
    assert later.position - state.position == pytest.approx(0.4 * state.velocity, abs=0.005)


def test_after_the_time_constant_and_the_tilt_s_lag_about_two_thirds_of_a_speed_are_flown() -> None:
    late = MODEL.delay + MODEL.speed_time + MODEL.tilt_lag + 2.0 * MODEL.tilt_damping * MODEL.tilt_time
    speed = flown(SpeedCommand(forward=0.5), 1.0).at(late).velocity.item(2)
    assert speed == pytest.approx(0.5 * 0.7, abs=0.06)
    climb = flown(SpeedCommand(up=0.5), 1.0).at(MODEL.delay + MODEL.rise_time + MODEL.lift_lag).velocity.item(1)
    assert climb == pytest.approx(-0.5 * 0.66, abs=0.04)


def test_a_speed_goes_where_the_vehicle_looks() -> None:
    own = flown(SpeedCommand(forward=0.5, yaw_rate=0.5 * math.pi), 1.0)
    for k in range(FPS + 1, 4 * FPS):
        own.update(SpeedCommand(forward=0.5), k / FPS)
    state = own.at(4.0)
    assert state.velocity.item(0) == pytest.approx(0.5 * math.sin(state.yaw), abs=0.01)
    assert state.velocity.item(2) == pytest.approx(0.5 * math.cos(state.yaw), abs=0.01)
    assert state.yaw == pytest.approx(0.5 * math.pi, abs=0.1)


def test_a_tilt_never_exceeds_the_largest_one() -> None:
    model = msgspec.structs.replace(MODEL, speed_time=0.05, tilt_damping=1.0)
    own = flown(SpeedCommand(forward=1.0), 0.5, model)
    tilts = [state.pitch for state in own.at_times(np.linspace(0.0, 0.5, 50).tolist())]
    assert 0.9 * model.full_tilt < max(tilts) <= model.full_tilt + 1e-9


def test_sticks_are_shares_of_the_full_speeds() -> None:
    model = msgspec.structs.replace(MODEL, full_speed=2.0, full_rise=0.8, full_yaw_rate=1.6)
    sticks = SpeedSticks(model)
    desired = sticks.command(WantedMotion(0.5, -1.0, 0.4, 0.4), HOLD, 1.0, (0.0, 0.0))
    assert desired == pytest.approx((0.25, -0.5, 0.25, 0.75))
    assert sticks.modeled_command(Command(*desired), WantedMotion(0.1, 0.0, 0.0, 0.1), HOLD) == pytest.approx(
        (0.4, -1.0, 0.3, 0.4)
    )
    assert sticks.command(WantedMotion(9.0, -9.0, 9.0, 0.0), HOLD, 0.8, (0.0, 0.0))[:2] == (0.8, -0.8)
    assert (
        sticks.command(WantedMotion(9.0, -9.0, 9.0, 0.0), HOLD, 0.8, (0.0, 0.0)).throttle < 1.0
    )  # all means: no thrust left


def test_before_lift_off_they_stand_still_and_without_throttle_nothing_is_told() -> None:
    sticks = SpeedSticks(MODEL)
    assert sticks.command(WantedMotion(0.5, -1.0, 0.4, 0.4), HOLD, 0.0, (0.0, 0.0)) == DesiredCommand(
        0.0, 0.0, 0.0, HOLD
    )
    assert sticks.modeled_command(Command(), WantedMotion(0.1, 0.1, 0.1, 0.1), HOLD) == SpeedCommand()
    assert sticks.hold_throttle == HOLD
    assert math.isnan(AngleSticks(EgoMotionParameters(), 0.5).hold_throttle)


def test_the_lag_is_made_up_for() -> None:
    sticks = SpeedSticks(MODEL)
    assert sticks.feedforward(0.2, 0.5) == pytest.approx(0.2 + 0.5 * MODEL.speed_time)
    assert sticks.feedforward(0.2, 0.5, upward=True) == pytest.approx(0.2 + 0.5 * MODEL.rise_time)
    assert AngleSticks(EgoMotionParameters(), 0.5).feedforward(0.2, 0.5) == 0.5


def test_it_flies_when_its_own_take_off_is_over() -> None:
    known = TakeOff(0.1, 5.0)
    known.sent(0.2, 0.0)
    assert known.lift_time == math.inf
    known.sent(HOLD, 1.0)
    known.sent(HOLD, 2.0)
    assert known.lift_time == pytest.approx(6.1)
    known.update(0.0, 1.0, 6.0)
    assert not known.airborne
    known.update(0.0, 1.0, 6.2)
    assert known.airborne
    known.reset()
    assert known.lift_time == math.inf
    assert (known.gain, known.sigma, known.airborne) == (1.0, 0.0, False)


def test_parameters_in_use_are_those_of_speeds_and_stay_so() -> None:
    used = FOLLOWER.in_use
    assert used.horizontal == FOLLOWER.speeds.horizontal
    assert used.vertical == FOLLOWER.speeds.vertical
    assert (used.hover_throttle, used.gain_schedule.weight, used.ego_motion.speed_commands) == (HOLD, 0.0, True)
    assert used.in_use == used
    assert FollowerParameters().in_use is not used
    assert FollowerParameters().in_use == FollowerParameters()
    with pytest.raises(ValueError, match="takeoff_duration"):
        SpeedParameters(takeoff_duration=-1.0)
    with pytest.raises(ValueError, match="oscillation_feedforward"):
        SpeedParameters(oscillation_feedforward=1.5)


def seen(place: tuple[float, float, float], time: float) -> Pose:
    """A ball whose marker looks here."""
    turn, spread = np.diag((-1.0, 1.0, -1.0)), np.diag((1e-6,) * 3 + (1e-4,) * 3)
    return Pose(position=np.array(place), rotation_matrix=turn, covariance=spread, observed="level", time=time)


class Flown:
    """A vehicle of the follower's own model, of which its ball is seen, and whose place may be pushed."""

    def __init__(self, parameters: FollowerParameters, place: tuple[float, float, float]) -> None:
        self.follower = Follower(PLACE, parameters)
        self.motion = EgoMotion(self.follower.parameters.ego_motion)
        self.ball = np.array(place)
        self.drift = np.zeros(3)
        self.desired: list[DesiredCommand] = []

    def fly(self, seconds: float, latency: float = 0.067) -> EgoState:
        for _ in range(round(seconds * FPS)):
            now = len(self.desired) / FPS
            own = self.motion.at(now - latency)
            place = own.rotation.T @ (self.ball - own.position - self.drift * max(now - latency, 0.0))
            turned = own.rotation.T @ np.diag((-1.0, 1.0, -1.0))
            pose = msgspec.structs.replace(seen(tuple(place), now - latency), rotation_matrix=turned)
            control = self.follower.update(pose, now)
            desired = control.desired if control else DesiredCommand(0.0, 0.0, 0.0, HOLD)
            self.desired.append(desired)
            self.follower.sent(Command(*desired), now)
            told = self.follower.sticks.modeled_command(Command(*desired), WantedMotion(0.0, 0.0, 0.0, 0.0), HOLD)
            self.motion.update(told, now)
        return self.motion.at(len(self.desired) / FPS)


@pytest.mark.parametrize("place", [(0.3, 0.0, 1.5), (-0.3, 0.2, 1.2), (0.0, -0.2, 1.9)])
def test_a_follower_goes_to_its_place_and_stays(place: tuple[float, float, float]) -> None:
    world = Flown(FOLLOWER, place)
    world.fly(0.4)
    side, down, ahead = place[0], place[1], place[2] - PLACE.heading
    first = world.desired[-1]
    for stick, way in ((first.roll, side), (first.pitch, ahead), (HOLD - first.throttle, down)):
        assert abs(way) < 0.05 or stick * way > 0.0
    state = world.fly(8.0)
    assert state.position == pytest.approx([side, down, ahead], abs=0.02)
    assert world.desired[-1] == pytest.approx((0.0, 0.0, 0.0, HOLD), abs=0.02)


def test_a_speed_flown_with_sticks_in_the_middle_is_flown_against_as_if_it_were_the_neighbor_s() -> None:
    world = Flown(FOLLOWER, (0.0, 0.0, 1.5))
    world.drift = np.array((0.08, 0.0, 0.0))  # it flies to the right by itself
    world.fly(25.0)
    off = world.motion.at(25.0).position.item(0) + 25.0 * 0.08
    assert abs(off) < 0.03
    assert world.desired[-1].roll == pytest.approx(-0.08, abs=0.02)


def steady_filter_gains() -> Floats:
    """Return the gains of a neighbor filter that has seen a ball for 10 s."""
    motion = NeighborFilter(FOLLOWER.neighbor_filter)
    still = EgoMotion(MODEL).at(0.0)
    for k in range(300):
        motion.update(seen((0.0, 0.0, 1.5), k / FPS), still)
    return motion.gains


@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.parametrize("latency", [0.067, 0.133, 0.2])
def test_the_loops_keep_their_margins(name: str, latency: float) -> None:
    used = FOLLOWER.in_use
    loops = FollowerLoops(LoopParameters(*(getattr(used, each) for each in LoopParameters._fields)))
    gains = Gains(used.horizontal, used.horizontal_feedforward, used.vertical_feedforward)
    timing = Timing(1.0 / FPS, latency, used.ego_motion.delay, used.stability.delay_uncertainty)
    loop = loops.loop(name, LoopConditions(gains, timing, steady_filter_gains()))
    margins = margins_of(loop.frequencies, loop.at_gains)
    assert margins.gain_db >= 6.0
    assert margins.phase_deg >= 40.0


def test_the_vehicle_of_the_loops_is_that_of_dead_reckoning() -> None:
    used = msgspec.structs.replace(FOLLOWER.in_use, ego_motion=msgspec.structs.replace(MODEL, integration_step=1e-3))
    loops = FollowerLoops(LoopParameters(*(getattr(used, each) for each in LoopParameters._fields)))
    gains = Gains(used.horizontal, used.horizontal_feedforward, used.vertical_feedforward)
    conditions = LoopConditions(gains, Timing(1.0 / FPS, 0.067, 0.03), steady_filter_gains())
    for name, axis, told in (("level", 2, SpeedCommand(forward=0.01)), ("rise", 1, SpeedCommand(up=-0.01))):
        _, vehicle = loops._axis(name, conditions)
        state, step = np.zeros(len(vehicle.input)), 1e-4
        for _ in range(1500):
            state = state + step * (vehicle.system @ state + vehicle.input * 0.01)
        own = EgoMotion(used.ego_motion)
        own.update(told, 0.0)
        assert own.at(used.ego_motion.delay + 0.15).velocity.item(axis) == pytest.approx(state[-2], rel=0.03)
