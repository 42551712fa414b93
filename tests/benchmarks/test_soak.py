"""The soak: each invariant notices a made-up violation, a plan is the same again, and some seconds are flown."""

import math
from array import array
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest
from benchmarks.soak.__main__ import soak
from benchmarks.soak.faults import FaultyCamera, limited_files
from benchmarks.soak.fly import fly, quantiles
from benchmarks.soak.invariants import ALONE, PAIRS, InvariantParameters, Rules, Seen, covariance_wrong, violation
from benchmarks.soak.plan import Fault, Plan, make_plan
from benchmarks.soak.resources import ResourceParameters, Resources, growth, measure

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.control.safety import SafetyParameters, SafetyState
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import PilotStep
from matchset.image.frame import Frame
from matchset.links.simulation_parameters import SimulationParameters
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track

RULES = Rules(SafetyParameters(max_tilt=0.8))
IMAGE = np.zeros((120, 160, 3), np.uint8)
ANGLES = np.linspace(0.0, 2.0 * math.pi, 32)
CIRCLE = Circle(80.0, 60.0, 20.0)
EDGES = np.column_stack((80.0 + 20.0 * np.cos(ANGLES), 60.0 + 20.0 * np.sin(ANGLES)))


def track(**changes: object) -> Track[Circle]:
    whole = Track(CIRCLE, np.diag((0.01, 0.01, 0.02)), 0.9, EDGES, 1.0)
    return msgspec.structs.replace(whole, **changes)


def pose(**changes: object) -> Pose:
    whole = Pose(
        position=np.array((0.0, 0.1, 1.5)),
        rotation_matrix=np.eye(3),
        covariance=0.01 * np.eye(6),
        observed="full",
        time=1.0,
    )
    return msgspec.structs.replace(whole, **changes)


def step(phase: str = "flying", **changes: object) -> PilotStep:
    whole = PilotStep(
        now=1.1,
        frame=Frame(IMAGE, 1.0, 30),
        ball=track(),
        markers=(),
        pose=pose(),
        control=None,
        command=Command(throttle=0.5),
        safety=SafetyState(phase, "why", 1.1),  # type: ignore[arg-type]
        age=0.1,
        stage_times=(0.0,) * 6,
    )
    return msgspec.structs.replace(whole, **changes)


def seen(phase: str = "flying", **changes: object) -> Seen:
    """A step in flight in which nothing is wrong, but for some changes of the step or of what is seen beside it."""
    beside = {name: changes.pop(name) for name in list(changes) if name in Seen._fields}
    good = Seen(step(phase, **changes), True, picture=1.0, confirmed=1.0, throttle=0.5, silent=0.03, thrust=1.0)
    return good._replace(**beside)  # type: ignore[arg-type]


def before(phase: str = "flying", **changes: object) -> Seen:
    """The step before it."""
    earlier = {"now": 1.1 - 1.0 / 30.0, "frame": Frame(IMAGE, 1.0 - 1.0 / 30.0, 29), "picture": 1.0 - 1.0 / 30.0}
    return seen(phase, **(earlier | changes))


OFF = Command()
BAD_ALONE: dict[str, list[Callable[[], Seen]]] = {
    "not_a_number": [
        lambda: seen(pose=pose(position=np.array((0.0, math.nan, 1.5)))),
        lambda: seen(ball=track(support=math.nan)),
        lambda: seen(pose=pose(position=np.array((0.0, math.inf, 1.5)))),
        lambda: seen(age=math.nan),
    ],
    "throttle_while_disarmed": [lambda: seen(armed=False), lambda: seen("locked"), lambda: seen("cut")],
    "refusal_unnoticed": [
        lambda: seen(refused=1.0),
        lambda: seen(refused=1.0, command=OFF),
        lambda: seen("cut", refused=1.0),
    ],
    "motors_on_for_too_long": [lambda: seen("descending", picture=-1.6), lambda: seen(confirmed=-2.2)],
    "frozen_picture_flown": [lambda: seen(frozen=0.65), lambda: seen("holding", frozen=0.65)],
    "motors_turn_after_the_end": [
        lambda: seen("cut", stopped=0.5, command=OFF),
        lambda: seen("cut", refused=0.5, command=OFF),
        lambda: seen("cut", stopped=0.1, command=OFF, throttle=0.0),
        lambda: seen("cut", stopped=0.1, command=OFF, silent=1.0),
    ],
    "ball_not_confirmed": [
        lambda: seen(frame=None),
        lambda: seen(fault="noise"),
        lambda: seen(ball=track(time=0.9)),
        lambda: seen(ball=track(support=0.0)),
        lambda: seen(ball=track(match_set=np.empty((0, 2)))),
        lambda: seen(ball=track(match_set=EDGES + 100.0)),
        lambda: seen(ball=track(shape=Circle(80.0, 60.0, 26.0))),
        lambda: seen(ball=track(covariance=np.diag((0.01, -0.01, 0.02)))),
        lambda: seen(markers=(track(support=2.0),)),
        lambda: seen(pose=pose(position=np.array((0.0, 0.1, -1.5)))),
        lambda: seen(pose=pose(rotation_matrix=-np.eye(3))),
        lambda: seen(pose=pose(covariance=np.zeros((6, 6)))),
    ],
}
LEFT = Command(roll=-0.5, throttle=0.5)
BAD_PAIRS: dict[str, list[tuple[Callable[[], Seen], Callable[[], Seen]]]] = {
    "rising_descent": [(before, lambda: seen("descending", command=Command(throttle=0.51)))],
    "sticks_over_cap": [
        (
            lambda: before(command=Command(roll=0.8, throttle=0.5)),
            lambda: seen(command=Command(roll=0.85, throttle=0.5)),
        ),
        (before, lambda: seen(command=LEFT)),
        (before, lambda: seen(command=Command(throttle=0.62))),
        (lambda: before(command=Command(throttle=0.9)), lambda: seen(command=Command(throttle=0.95))),
    ],
    "armed_by_itself": [(lambda: before("cut", command=OFF), lambda: seen("locked", command=OFF))],
    "time_backward": [
        (lambda: before(now=1.1), seen),
        (lambda: before(picture=1.0), seen),
        (before, lambda: seen(frame=Frame(IMAGE, 1.2, 31))),
    ],
}


def test_every_invariant_has_a_violation() -> None:
    assert set(BAD_ALONE) == {rule.__name__ for rule in ALONE}
    assert set(BAD_PAIRS) == {rule.__name__ for rule in PAIRS}


def test_a_good_flight_violates_nothing() -> None:
    good = (
        seen(),
        seen("descending", command=Command(throttle=0.49)),
        seen("cut", command=OFF, refused=1.1, stopped=1.1),
        seen("cut", command=OFF, stopped=0.0, throttle=0.0, thrust=0.0),
        seen(armed_again=True),
        seen(frozen=0.75),
        seen("descending", command=Command(throttle=0.49), frozen=0.5),
    )
    for each in good:
        assert violation(before(), each, RULES) == ""
        assert violation(None, each, RULES) == ""
    assert violation(before("cut", command=OFF), seen("locked", command=OFF, armed_again=True), RULES) == ""


@pytest.mark.parametrize(("name", "make"), [(name, make) for name, makes in BAD_ALONE.items() for make in makes])
def test_a_made_up_violation_is_noticed(name: str, make: Callable[[], Seen]) -> None:
    rule = next(rule for rule in ALONE if rule.__name__ == name)
    assert rule(make(), RULES)
    assert violation(None, make(), RULES)


@pytest.mark.parametrize(("name", "pair"), [(name, pair) for name, pairs in BAD_PAIRS.items() for pair in pairs])
def test_a_made_up_violation_of_two_steps_is_noticed(
    name: str, pair: tuple[Callable[[], Seen], Callable[[], Seen]]
) -> None:
    rule = next(rule for rule in PAIRS if rule.__name__ == name)
    first, second = pair[0](), pair[1]()
    assert rule(first, second, RULES)
    assert violation(first, second, RULES)


@pytest.mark.parametrize(
    "matrix", [np.full((2, 2), math.nan), np.array(((1.0, 0.5), (0.4, 1.0))), np.ones((2, 2)), np.zeros((2, 2))]
)
def test_a_matrix_that_is_no_covariance_is_noticed(matrix: np.ndarray) -> None:
    assert covariance_wrong(matrix)
    assert not covariance_wrong(np.diag((1e-12, 1e6)))


@pytest.mark.parametrize(
    ("now", "what"),
    [
        (Resources(700.0, 5, 3), "memory"),
        (Resources(500.0, 6, 3), "open files"),
        (Resources(500.0, 5, 4), "threads"),
        (Resources(590.0, 5, 3), ""),
        (Resources(400.0, 4, 2), ""),
    ],
)
def test_growth_is_noticed(now: Resources, what: str) -> None:
    grown = growth(Resources(500.0, 5, 3), now, ResourceParameters(memory=100.0))
    assert grown.startswith(what)
    assert bool(grown) == bool(what)


def test_an_open_file_is_counted(tmp_path: Path) -> None:
    held = measure()
    with (tmp_path / "file").open("w"):
        more = measure()
    assert held.memory > 0.0
    assert not held.handles or more.handles == held.handles + 1


def test_a_plan_is_the_same_again_and_others_differ() -> None:
    plans = [make_plan(7, number) for number in range(60)]
    assert plans == [make_plan(7, number) for number in range(60)]
    assert plans != [make_plan(8, number) for number in range(60)]
    assert all(10.0 <= plan.flight.duration <= 60.0 for plan in plans)
    assert {kind for plan in plans for kind, count in plan.count().items() if count} >= {
        "frozen",
        "stale",
        "dropped",
        "noise",
        "gust",
        "hidden",
        "cable",
        "silent",
        "full recorder",
    }
    assert not any(plan.armings for plan in plans if plan.recorded)  # a replay does not arm again


class _Pictures:
    """A camera whose pictures are numbered by their gray."""

    def __init__(self) -> None:
        self.model, self.index = CameraModel.from_fov(8, 6, 1.0), 0

    def read(self) -> Frame:
        self.index += 1
        return Frame(np.full((6, 8), self.index, np.uint8), self.index / 30.0, self.index)

    def now(self) -> float:
        return self.index / 30.0


@pytest.mark.parametrize(
    ("kind", "grays"), [("frozen", [9, 9, 9]), ("stale", [4, 5, 6]), ("dropped", [-1, -1, -1]), ("gust", [10, 11, 12])]
)
def test_faults_of_pictures(kind: str, grays: list[int]) -> None:
    fault = Fault(kind, 10.0 / 30.0 - 1e-6, 3.0 / 30.0, (0.2, 0.0, 0.0))
    camera = FaultyCamera(_Pictures(), (fault,), (0,))
    frames = [camera.read() for _ in range(14)]
    shown = [-1 if frame is None else int(frame.image[0, 0]) for frame in frames]
    assert shown == [*range(1, 10), *grays, 13, 14]
    assert all(frame is None or frame.time == k / 30.0 for k, frame in enumerate(frames, 1))


def test_a_file_is_full(tmp_path: Path) -> None:
    pytest.importorskip("resource", reason="files are limited on Unix only")
    with pytest.raises(OSError, match="large"), limited_files(0.01):
        (tmp_path / "file").write_bytes(bytes(20_000))
    (tmp_path / "file").write_bytes(bytes(20_000))


def test_quantiles() -> None:
    assert quantiles(array("d", [3.0, 1.0, 2.0]))[::2] == (2.0, 3.0)
    assert math.isnan(quantiles(array("d"))[0])


def test_some_seconds_hold(tmp_path: Path) -> None:
    small = SimulationParameters(vehicles=2, width=320, height=240, silent=3.0, silent_for=0.5)
    noisy = Plan(
        seed=1,
        number=0,
        flight=FlightParameters(duration=5.0, world=small),
        faults=(Fault("noise", 1.0, 0.3), Fault("gust", 1.5, 0.3, (1.0, 0.0, 0.5)), Fault("dropped", 2.3, 0.2)),
        armings=1,
    )
    recorded = Plan(
        seed=1,
        number=1,
        flight=FlightParameters(duration=3.0, world=msgspec.structs.replace(small, silent=2.0)),
        faults=(Fault("frozen", 0.6, 0.6), Fault("stale", 1.5, 0.1, (0.3, 0.0, 0.0))),
        recorded=True,
    )
    full = msgspec.structs.replace(recorded, number=2, room=5.0)
    lines: list[str] = []
    totals = soak((noisy, recorded, full), 1000.0, lines.append)
    assert totals.violation is None, totals.violation
    assert len(lines) == totals.flights == 3
    assert totals.flown.full == 1
    assert totals.flown.simulated > 10.0
    assert totals.flown.replayed > 100
    assert len(totals.flown.elapsed) > 250


def test_a_violation_ends_a_flight_and_says_where(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks.soak import fly as module

    strict = InvariantParameters(off_outline=0.0)
    monkeypatch.setattr(module, "_limits_of", lambda *_: strict)
    small = SimulationParameters(vehicles=2, width=320, height=240)
    flown = fly(Plan(seed=3, number=4, flight=FlightParameters(duration=1.0, world=small)), tmp_path)
    assert flown.violation is not None
    assert flown.violation[:3] == (3, 4, 1)
    assert "off the outline" in flown.violation.what
