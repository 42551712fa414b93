"""Betaflight in lock-step: its airframe against closed forms, and, where it was built, its receiver and its motors.

`make fly-betaflight` builds it in a minute; without it the tests that need it are skipped, and say so.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from benchmarks.flight.betaflight.airframe import GRAVITY, Airframe, AirframeParameters, quaternion, turn
from benchmarks.flight.betaflight.sitl import BOOT, RATE, SETTINGS, Sitl, configure, is_built, settings
from benchmarks.flight.betaflight.sticks import CRSF_SETTINGS, crsf_link
from benchmarks.flight.betaflight.world import BetaflightWorld
from scipy.spatial.transform import Rotation

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.crsf.crsf_link import CrsfLink

ROOT = Path(__file__).resolve().parents[2]
STEP = 1.0 / 960.0
OFF = np.zeros(4)
needs_betaflight = pytest.mark.skipif(not is_built(), reason="Betaflight is not built: make fly-betaflight")


def flying(parameters: AirframeParameters | None = None) -> Airframe:
    one = Airframe(np.zeros(3), 0.0, parameters)
    one.held = False
    return one


def hover(one: Airframe) -> np.ndarray:
    return np.full(4, 1.0 / np.sqrt(one.parameters.thrust_to_weight))


def test_it_falls_as_mass_and_moved_air_let_it() -> None:
    parameters = AirframeParameters(ball_drag=0.0, frame_drag=0.0)
    one = flying(parameters)
    for _ in range(96):
        one.step(OFF, STEP)
    added = 1.5 * parameters.air * 4.0 / 3.0 * np.pi * parameters.ball_radius**3
    expected = GRAVITY * parameters.mass / (parameters.mass + added)
    assert one.velocity == pytest.approx((0.0, expected * 0.1, 0.0), rel=1e-9)


def test_at_hover_it_rests() -> None:
    one = flying()
    one.motors[:] = hover(one)
    for _ in range(960):
        one.step(hover(one), STEP)
    assert np.abs(one.position).max() < 1e-9
    assert np.abs(one.rates).max() < 1e-9


@pytest.mark.parametrize(
    ("stronger", "axis", "sign"),
    [
        ((1, 2), 2, 1.0),  # the left motors: it rolls to the right
        ((1, 3), 0, -1.0),  # those at the back: its nose goes down
        ((0, 1), 1, 1.0),  # front right and rear left: it turns clockwise
    ],
)
def test_motors_turn_it_as_betaflight_s_mixer_thinks(stronger: tuple[int, int], axis: int, sign: float) -> None:
    one = flying()
    one.motors[:] = hover(one)
    one.motors[list(stronger)] += 0.05
    one.step(one.motors.copy(), STEP)
    assert sign * one.rates[axis] > 0.0
    assert np.abs(np.delete(one.rates, axis)).max() < 1e-6 * abs(one.rates[axis])


def test_without_forces_its_momentum_stays() -> None:
    parameters = AirframeParameters(ball_drag=0.0, frame_drag=0.0, ball_radius=1e-6)
    one = flying(parameters)
    one.rates[:] = 3.0, 1.0, -2.0
    before = one.rotation @ (np.array(parameters.inertia) * one.rates)
    for _ in range(480):
        one.step(OFF, STEP)
    assert one.rotation @ (np.array(parameters.inertia) * one.rates) == pytest.approx(before, rel=5e-3)


def test_a_hand_holds_it_until_its_motors_pull() -> None:
    one = Airframe(np.zeros(3), 0.0)
    for _ in range(100):
        one.step(np.full(4, 0.3), STEP)
    assert one.held
    for _ in range(200):
        one.step(hover(one), STEP)
    assert not one.held


def test_quaternions_are_those_of_scipy_in_forward_right_down() -> None:
    rng = np.random.default_rng(1)
    order = np.array(((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    for _ in range(100):
        rotation = turn(rng.normal(0.0, 0.8, 3))
        x, y, z, w = Rotation.from_matrix(order @ rotation @ order.T).as_quat()
        ours, theirs = quaternion(rotation), np.array((w, x, y, z))
        assert min(np.abs(ours - theirs).max(), np.abs(ours + theirs).max()) < 1e-9


def test_the_settings_of_the_page_are_those_that_flew() -> None:
    page = (ROOT / "docs" / "crsf.md").read_text(encoding="utf-8")
    assert SETTINGS.read_text(encoding="utf-8") in page


class Bench:
    """A vehicle that stands still, for a link."""

    def __init__(self, folder: Path) -> None:
        self.hooks: list[Callable[[], None]] = []
        self.sitl = Sitl(folder)
        self.sitl.rest(BOOT)

    @property
    def now(self) -> float:
        return self.sitl.time

    def pass_time(self, seconds: float) -> None:
        for _ in range(max(round(seconds * RATE), 1)):
            self.sitl.rest(1.0 / RATE)
            for hook in self.hooks:
                hook()


@pytest.fixture(scope="module")
def configured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("betaflight")
    configure(folder, [*settings(), *CRSF_SETTINGS])
    return folder


@pytest.fixture
def bench(configured: Path) -> Iterator[Bench]:
    one = Bench(configured)
    with one.sitl:
        yield one


def link_to(bench: Bench) -> CrsfLink:
    return crsf_link(cast(BetaflightWorld, cast(Any, bench)), 0.0)


def fly(bench: Bench, link: CrsfLink, command: Command, seconds: float = 0.5) -> list[float]:
    for _ in range(round(30 * seconds)):
        link.send(command)
        bench.pass_time(1 / 30)
    return bench.sitl.motors


@needs_betaflight
def test_it_arms_and_flies_by_our_frames_and_its_telemetry_is_read(bench: Bench) -> None:
    link = link_to(bench)
    assert bench.sitl.motors == [0.0] * 4
    link.arm()
    mode = link.news.mode
    assert mode is not None
    assert mode.text == "ANGL"
    idle = max(bench.sitl.motors)
    assert 0.0 < idle < 0.2
    assert min(fly(bench, link, Command(throttle=0.5))) > 0.4
    right, _, left, _ = fly(bench, link, Command(throttle=0.5, roll=0.3), 0.2)
    assert left > right
    assert link.news.attitude is not None
    assert abs(link.news.attitude.roll) < 0.02
    assert link.module.bad == 0


@needs_betaflight
def test_a_cut_stops_its_motors(bench: Bench) -> None:
    link = link_to(bench)
    link.arm()
    fly(bench, link, Command(throttle=0.4))
    link.cut()
    bench.pass_time(0.05)
    assert bench.sitl.motors == [0.0] * 4


@needs_betaflight
def test_a_landing_is_confirmed_by_its_mode(bench: Bench) -> None:
    link = link_to(bench)
    link.arm()
    fly(bench, link, Command(throttle=0.4))
    link.land()
    assert bench.sitl.motors == [0.0] * 4
    assert link.news.mode is not None
    assert link.news.mode.disarmed


@needs_betaflight
def test_a_caller_that_falls_silent_is_disarmed_before_its_failsafe(bench: Bench) -> None:
    link = link_to(bench)
    link.arm()
    fly(bench, link, Command(throttle=0.4))
    bench.pass_time(0.3)  # 0.24 s and the way
    assert bench.sitl.motors == [0.0] * 4
    assert link.status().state == "failsafe"


@needs_betaflight
def test_no_frames_at_all_end_in_its_own_failsafe(bench: Bench) -> None:
    link = link_to(bench)
    link.arm()
    fly(bench, link, Command(throttle=0.4))
    bench.hooks.clear()  # the cable is cut
    bench.pass_time(3.0)
    assert bench.sitl.motors == [0.0] * 4


@needs_betaflight
def test_another_arm_channel_is_noticed(bench: Bench) -> None:
    link = link_to(bench)
    link.parameters = link.module.parameters = type(link.parameters)(arm_channel=9)
    with pytest.raises(LinkError, match="it did not arm"):
        link.arm()
    assert bench.sitl.motors == [0.0] * 4
