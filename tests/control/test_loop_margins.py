"""Margins of loops against closed forms, SciPy, and a slow simulation in which a loop is driven until it oscillates."""

import math

import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from scipy import signal
from scipy.linalg import expm

from matchset.control.chain.gain_schedule import Gains, GainScheduleParameters, interpolated
from matchset.control.ego_motion import STATE, EgoState
from matchset.control.feedforward import SpeedFeedforward
from matchset.control.follower import FollowerParameters
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.pid import Pid
from matchset.control.stability.follower_loops import LOOPS, FollowerLoops, LoopConditions, LoopParameters
from matchset.control.stability.loop import FilterGains, Loop, Timing, _going_on, _transition, horizontal_vehicle
from matchset.control.stability.margins import margins_of, robustness_of
from matchset.localization.pose import Pose
from matchset.numeric.record import new_block

Floats = npt.NDArray[np.float64]

FOLLOWER = FollowerParameters()
STEP = 1.0 / 30.0
DELAY = STEP
"""From sending a command to its first effect, s."""
STILL = EgoState(new_block(STATE))
LATENCIES = (0.067, 0.1, 0.133, 0.2)


def seen(place: tuple[float, float, float], time: float) -> Pose:
    """A ball whose marker looks here."""
    turn, spread = np.diag((-1.0, 1.0, -1.0)), np.diag((1e-6,) * 3 + (1e-4,) * 3)
    return Pose(position=np.array(place), rotation_matrix=turn, covariance=spread, observed="level", time=time)


def steady_filter_gains() -> Floats:
    """Return the gains of a neighbor filter that has seen a ball for 10 s."""
    motion = NeighborFilter(FOLLOWER.neighbor_filter)
    for k in range(300):
        motion.update(seen((0.0, 0.0, 1.5), k * STEP), STILL)
    return motion.gains


FILTER_GAINS = steady_filter_gains()[[0, 1, 0]]  # the slow twin moves along x


def loops(follower: FollowerParameters = FOLLOWER) -> FollowerLoops:
    return FollowerLoops(LoopParameters(*(getattr(follower, name) for name in LoopParameters._fields)))


def gains(share: float) -> Gains:
    """The gains of the schedule, of which there is a share of the high ones."""
    low = Gains(FOLLOWER.horizontal, FOLLOWER.horizontal_feedforward, FOLLOWER.vertical_feedforward)
    return interpolated(low, GainScheduleParameters(), share)


def conditions(latency: float, share: float, error: float = 0.0, tilt: float = 1.0) -> LoopConditions:
    timing = Timing(STEP, latency, DELAY, error)
    return LoopConditions(gains(share), timing, FILTER_GAINS, tilt=tilt)


@pytest.mark.parametrize("delay", [0.0, 0.05, 0.2])
def test_margins_of_a_plain_loop_are_those_of_scipy(delay: float) -> None:
    frequencies = np.geomspace(0.05, 100.0, 4000)
    system = signal.TransferFunction([3.0, 4.0], [0.05, 1.0, 0.1, 0.0])
    response = signal.freqresp(system, frequencies)[1] * np.exp(-1j * frequencies * delay)
    found = margins_of(frequencies, response)
    level, phase = np.abs(response), np.unwrap(np.angle(response))
    crossing = int(np.flatnonzero((level[:-1] > 1.0) & (level[1:] <= 1.0))[0])
    assert found.phase_deg == pytest.approx(180.0 + math.degrees(phase[crossing]), abs=0.5)
    assert found.delay == pytest.approx(math.radians(found.phase_deg) / frequencies[crossing], rel=0.01)
    turned = np.flatnonzero((phase[:-1] > -math.pi) & (phase[1:] <= -math.pi))
    expected = -20.0 * math.log10(level[turned[0]]) if len(turned) else math.inf
    assert found.gain_db == pytest.approx(expected, abs=0.05)


def test_an_integrator_behind_a_delay_has_the_margins_of_the_textbook() -> None:
    frequencies = np.geomspace(0.01, 100.0, 2000)
    found = margins_of(frequencies, 2.0 * np.exp(-0.25j * frequencies) / (1j * frequencies))
    assert found.gain_db == pytest.approx(20.0 * math.log10(math.pi / 2.0 / 0.25 / 2.0), abs=0.01)
    assert found.phase_deg == pytest.approx(90.0 - math.degrees(0.5), abs=0.05)
    assert found.delay == pytest.approx(math.pi / 4.0 - 0.25, abs=1e-3)


def test_a_factor_takes_its_decibels_of_the_gain_margin() -> None:
    loop = loops().loop("level", conditions(0.067, 1.0, 0.03))
    whole, doubled = (margins_of(loop.frequencies, loop.at_gains, factor) for factor in (1.0, 2.0))
    assert doubled.gain_db == pytest.approx(whole.gain_db - 20.0 * math.log10(2.0), abs=1e-9)


def exponential(matrix: Floats) -> Floats:
    """e to the power of a matrix, written out: its series, of a small part of it, squared again and again."""
    part = matrix / 64.0
    term = result = np.eye(len(matrix))
    for k in range(1, 12):
        term = term @ part / k
        result = result + term
    for _ in range(6):
        result = result @ result
    return np.asarray(result)


def test_a_vehicle_goes_on_by_its_matrix_exponential() -> None:
    vehicle = horizontal_vehicle(FOLLOWER.ego_motion)
    order = len(vehicle.input)
    block = np.zeros((order + 1, order + 1))
    block[:order, :order], block[:order, order] = vehicle.system, vehicle.input
    for time in (1 / 30, 0.4):
        moved, added = _going_on(vehicle, time)
        whole = exponential(time * block)
        np.testing.assert_allclose(moved, whole[:order, :order], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(added, whole[:order, order], rtol=1e-12, atol=1e-12)


def test_the_neighbor_goes_on_by_its_matrix_exponential() -> None:
    model = FOLLOWER.neighbor_filter
    w, decay, lasting = 2.0 * math.pi / model.oscillation_period, model.oscillation_damping, model.acceleration_time
    system = np.zeros((5, 5))
    system[0, 1] = system[1, 2] = 0.2  # s, of the drift
    system[2, 2] = -0.2 / lasting
    system[3, 4] = 0.5  # s, of the oscillation
    system[4, 3:] = -0.5 * w * w, -0.5 * 2.0 * decay * w
    found = _transition(FilterGains(np.zeros(5), model, lasting), 0.2, 0.5)
    np.testing.assert_allclose(found, exponential(system), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("latency", LATENCIES)
@pytest.mark.parametrize("name", LOOPS)
def test_the_default_gains_keep_their_margins_at_every_latency(name: str, latency: float) -> None:
    follower, schedule = FOLLOWER, FOLLOWER.gain_schedule
    delay = latency + follower.ego_motion.delay
    share = min(max((schedule.longest_delay - delay) / (schedule.longest_delay - schedule.delay), 0.0), 1.0)
    loop = loops().loop(name, conditions(latency, share, follower.stability.delay_uncertainty))
    found = margins_of(loop.frequencies, loop.at_gains)
    assert found.gain_db >= follower.stability.gain_margin_db
    assert found.phase_deg >= follower.stability.phase_margin_deg


def test_with_a_right_model_the_delay_is_not_in_the_gain_margin_but_in_that_of_the_vehicle() -> None:
    short, long = (loops().loop("level", conditions(latency, 0.0)) for latency in (0.067, 0.2))
    np.testing.assert_allclose(short.at_gains, long.at_gains)
    near, far = (robustness_of(each.frequencies, each.at_vehicle) for each in (short, long))
    assert far.gain_db < near.gain_db


def test_both_cuts_close_the_same_loop() -> None:
    loop = loops().loop("level", conditions(0.067, 1.0, 0.03))
    opened = 1.0 + loop.own - loop.seen * loop.model
    np.testing.assert_allclose((1.0 + loop.at_vehicle) * opened, 1.0 + loop.at_gains, rtol=1e-9)


class SlowTwin:
    """The level loop picture by picture: the package's own filter and controller beside a ball at rest.

    Vehicle and dead reckoning are the differential equations of `ego_motion.py`, solved exactly 240 times a second. The
    vehicle answers later, and tilts more. Delays are whole steps.
    """

    FINE = 8  # steps a picture

    def __init__(
        self, latency: float, share: float, factor: float = 1.0, error: float = 0.0, tilt: float = 1.0
    ) -> None:
        known = gains(share)
        level = msgspec.structs.replace(known.horizontal, max_error=math.inf, output_limit=math.inf, integral=0.0)
        self.pid, self.speed = Pid(level), SpeedFeedforward(known.horizontal_feedforward)
        self.filter = NeighborFilter(FOLLOWER.neighbor_filter)
        self.shown = [self.steps(latency + DELAY), self.steps(latency + DELAY + error)]
        self.latency, self.factor, self.tilt = latency, factor, tilt
        self.moved, self.added = self.solved(STEP / self.FINE)
        self.led, self.held = self.solved(FOLLOWER.horizontal_lead)
        self.states, self.command = [np.zeros(5)] * 200, 0.0

    def steps(self, time: float) -> int:
        """A time in fine steps."""
        return round(time * self.FINE / STEP)

    @staticmethod
    def solved(time: float) -> tuple[Floats, Floats]:
        """What a state becomes in a time, and what a command adds."""
        model = FOLLOWER.ego_motion
        w, lag, damping = 1.0 / model.tilt_time, model.tilt_lag, 2.0 * model.tilt_damping / model.tilt_time
        system = np.zeros((6, 6))
        system[0, [0, 5]] = -1.0 / lag, 1.0 / lag  # motors
        system[1, 2], system[2, :3] = 1.0, (w * w, -w * w, -damping)  # tilt
        system[3, [1, 3]], system[4, 3] = (1.0, -1.0 / model.drag_time), 1.0  # speed and place
        whole = expm(system * time)
        return whole[:5, :5], whole[:5, 5]

    def oscillates(self, seconds: float = 40.0) -> bool:
        """Whether a nudge of the ball by 10 um is not forgotten, but grows."""
        nudge, count = 1e-5, round(seconds / STEP)
        places = np.array([self.step(k * STEP, nudge if k > 60 else 0.0) for k in range(count)])
        second, last = (np.ptp(places[k * count // 4 : (k + 1) * count // 4]) for k in (1, 3))
        return bool(last > second or last > 100.0 * nudge)

    def step(self, now: float, ball: float) -> float:
        """Answer a picture of a ball at a place; where the vehicle was in it."""
        believed, truly = (float(self.states[-1 - steps][4]) for steps in self.shown)
        taken, acts = now - self.latency, now + DELAY
        self.filter.update(seen((ball - self.tilt * truly + believed, 0.0, 1.5), taken), STILL)
        led = acts + FOLLOWER.horizontal_lead
        now_there, then_there = self.filter.at_times((acts, led), FOLLOWER.max_extrapolation)
        mine = self.led @ self.states[-1] + self.held * self.command
        self.speed.update(now_there.x.speed, STEP)
        rate = float(mine[3]) - self.speed.output(then_there.x.speed)
        asked = self.pid.update(0.0, float(mine[4]) - then_there.x.value, STEP, rate)
        asked += FOLLOWER.oscillation_feedforward * then_there.x.oscillation_acceleration
        asked += FOLLOWER.drift_feedforward * then_there.x.drift_acceleration
        self.command = self.factor * asked
        for _ in range(self.FINE):
            self.states.append(self.moved @ self.states[-1] + self.added * self.command)
        return self.tilt * truly


def level_loop(latency: float, share: float, error: float = 0.0, tilt: float = 1.0) -> Loop:
    """The same loop, without its integral."""
    known = conditions(latency, share, error, tilt)
    level = msgspec.structs.replace(known.gains.horizontal, integral=0.0)
    return loops().loop("level", known._replace(gains=known.gains._replace(horizontal=level)))


SETTINGS = ((2, 1.0, 0.0), (2, 1.0, 1.0), (2, 1.0, 1.5), (6, 0.0, 1.0), (6, 0.0, 2.0))
"""Latency, pictures; share of the high gains; by how many pictures later than told the vehicle answers."""
TOLERANCE = 1.1


@pytest.mark.parametrize(("pictures", "share", "later"), SETTINGS)
def test_the_gain_margin_is_where_the_slow_twin_oscillates(pictures: int, share: float, later: float) -> None:
    latency, error = pictures * STEP, later * STEP
    loop = level_loop(latency, share, error)
    factor = 10.0 ** (margins_of(loop.frequencies, loop.at_gains).gain_db / 20.0)
    assert not SlowTwin(latency, share, factor / TOLERANCE, error).oscillates()
    assert SlowTwin(latency, share, factor * TOLERANCE, error).oscillates()


@pytest.mark.parametrize(("pictures", "share"), [(2, 1.0), (2, 0.0), (6, 0.0)])
def test_the_vehicles_gain_and_delay_margins_are_where_the_slow_twin_oscillates(pictures: int, share: float) -> None:
    latency = pictures * STEP
    loop = level_loop(latency, share)
    found = robustness_of(loop.frequencies, loop.at_vehicle)
    tilt = 10.0 ** (found.gain_db / 20.0)
    assert not SlowTwin(latency, share, tilt=tilt / TOLERANCE).oscillates()
    assert SlowTwin(latency, share, tilt=tilt * TOLERANCE).oscillates()
    assert not SlowTwin(latency, share, error=found.delay / TOLERANCE).oscillates()
    assert SlowTwin(latency, share, error=found.delay * TOLERANCE).oscillates()
