"""A flight of links and cameras, step by step, on the clock of a simulated world: no test waits for a device."""

import re
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest

from linked_world import COUNTDOWN, DESCENT, DURATION, WORLD, made
from matchset.control.command import Command
from matchset.control.safety import SafetyState
from matchset.flight.chain.chain_step import FlightSetup
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.chain.score import FlightCounters, FlightScorer
from matchset.flight.fly.live_view import text_line
from matchset.flight.linked.followers import LinkedFollowers
from matchset.flight.linked.linked_flight import LinkedFlight
from matchset.flight.linked.live_camera import LiveCamera
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.replay import Replay
from matchset.flight.recording.writer import RecordingWriter
from matchset.image.errors import LinkError
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import SimulationParameters
from matchset.tracking.track import Lost

END = COUNTDOWN + DURATION
PHASES = (COUNTDOWN, "flying"), (END, "descending"), (END + DESCENT, "cut")


@pytest.fixture
def chain() -> Iterator[SimulatedChain]:
    opened = SimulatedChain(WORLD)
    yield opened
    opened.close()


def test_it_counts_down_then_flies_and_ends_in_time(chain: SimulatedChain) -> None:
    scorer = FlightScorer(FlightParameters(world=WORLD))
    with made(chain) as flight:
        steps = list(flight)
        for step in steps:
            scorer.add(step)
            phase, throttle = step.steps[0].safety.phase, step.steps[0].command.throttle
            assert step.truth == ()
            assert any(phase == _phase_at(step.time + slack) for slack in (-0.1, 0.1))
            assert (throttle > 0.0) == (phase in ("flying", "descending"))
        assert steps[-1].time == pytest.approx(COUNTDOWN + DURATION + DESCENT, abs=0.1)
        assert steps[-1].steps[0].safety.phase == "cut"
        assert flight.in_time
        assert flight.succeeded(scorer)
    assert chain.links[0]._state == "locked"
    assert not flight.fault


def _phase_at(time: float) -> str:
    begun = [phase for begin, phase in PHASES if begin <= time]
    return begun[-1] if begun else "locked"


def test_being_stopped_is_a_descent(chain: SimulatedChain) -> None:
    with made(chain) as flight:
        throttles = []
        for step in flight:
            if step.time > COUNTDOWN + 1.0:
                throttles.append(step.steps[0].command.throttle)
                if not flight.land("stopped"):
                    break
        assert throttles[0] > 0.3
        assert throttles[1:] == sorted(throttles[1:], reverse=True)
        assert len(throttles) == pytest.approx(30 * DESCENT, abs=3)
        assert throttles[-1] == 0.0
        assert not flight.succeeded(FlightScorer(flight.parameters))


def test_a_dry_run_sends_zero_and_begins_again_after_a_cut(chain: SimulatedChain) -> None:
    parameters = msgspec.structs.replace(WORLD, cable=0.5)
    with made(chain, dry=True) as flight:
        phases, wanted, counters = [], [], FlightCounters(1)
        for step in flight:
            counters.add(step)
            phases.append(step.steps[0].safety.phase)
            wanted.append(step.steps[0].safety.command.throttle)
            assert step.steps[0].command == Command()
            if len(phases) == 20:
                flight.pilots[0].land("a try")
        assert {"flying", "descending", "cut", "locked"} <= set(phases)
        assert phases[-1] == "flying"
        assert max(wanted) > 0.3
        said = text_line(step, counters, dry=True)
        assert re.search(r"flying, 1\.\d\d m.*would send roll [+-]0\.\d\d pitch .* throttle 0\.[2-9]", said), said
        assert flight.succeeded(FlightScorer(FlightParameters(world=parameters)))


@pytest.mark.parametrize("dry", [False, True])
def test_its_recording_comes_out_bit_for_bit(chain: SimulatedChain, tmp_path: Path, dry: bool) -> None:
    path = tmp_path / "flight.mcap"
    with made(chain, dry=dry) as flight, RecordingWriter(path, flight.setup) as recording:
        for step in flight:
            recording.write(step, [pilot.armed for pilot in flight.pilots])
            if step.time > 1.5 and not flight.pilots[0].landing and not dry:
                flight.land("enough")
            if step.index == 20 and dry:
                flight.pilots[0].land("a try")
    replay = Replay(RecordingReader(path))
    phases = [step.steps[0].safety.phase for step in replay]
    assert not replay.differences
    assert replay.steps == len(phases) > 80
    assert "cut" in phases


def test_a_link_that_breaks_ends_it_with_its_words(chain: SimulatedChain) -> None:
    with made(chain) as flight:
        for step in flight:
            if step.time > COUNTDOWN + 0.5:
                flight.pilots[0].link.send = _broken  # type: ignore[method-assign]
        assert flight.fault == "the port has gone"


def _broken(command: Command) -> Command:
    raise LinkError("the port has gone")


class ScriptedPilot:
    """A pilot that flies until it is told to land, or comes down by itself at a step."""

    def __init__(self, down_at: int = 10**9) -> None:
        self.armed, self.killed, self.landing = False, "", ""
        self.calls: list[str] = []
        self.camera: Any = SimpleNamespace(model=None)
        self.link = SimpleNamespace(close=lambda: self.calls.append("close"))
        self._count, self._down_at = 0, down_at

    def arm_link(self) -> None:
        self.calls.append("arm link")

    def arm(self) -> None:
        self.armed = True
        self.calls.append(f"arm at {self._count}")

    def land(self, reason: str) -> None:
        self.landing = reason

    def is_losing_sight(self, ahead: float, margin: float) -> bool:  # noqa: ARG002
        return False

    def step(self) -> PilotStep:
        self._count += 1
        down = self._count >= self._down_at or self.landing
        phase: Any = "locked" if not self.armed else "cut" if down else "flying"
        now = self._count / 30.0
        lost: Lost[Any] = Lost("", now)
        state = SafetyState(phase, "", now)
        return PilotStep(
            now=now,
            frame=None,
            ball=lost,
            markers=(),
            pose=lost,
            control=None,
            command=Command(),
            safety=state,
            age=0.0,
            stage_times=(0.0,) * 6,
            landing=self.landing,
        )


def scripted(*pilots: ScriptedPilot) -> LinkedFlight:
    world = SimulationParameters(vehicles=len(pilots) + 1)
    parameters = FlightParameters(duration=5.0, world=world)
    setup = FlightSetup(parameters, (), (), kind="flight", countdown=0.2)
    followers = LinkedFollowers(pilots)  # type: ignore[arg-type]
    return LinkedFlight(followers, setup)


def test_when_one_has_come_down_the_others_land() -> None:
    first, second = ScriptedPilot(), ScriptedPilot(down_at=40)
    with scripted(first, second) as flight:
        steps = list(flight)
    assert first.landing == "vehicle 2 came down"
    assert steps[-1].down
    assert len(steps) == 41
    assert first.calls[-1] == second.calls[-1] == "close"


def test_links_are_armed_together_and_pilots_one_after_the_other() -> None:
    pilots = [ScriptedPilot() for _ in range(4)]
    with scripted(*pilots) as flight:
        for step in flight:
            if step.time > 4.8:
                break
    assert [pilot.calls[0] for pilot in pilots] == ["arm link"] * 4
    assert pilots[0].calls[1:] == ["close"]  # its time has not come
    begun = [int(pilot.calls[1].split()[-1]) for pilot in pilots[1:]]
    assert begun == pytest.approx([110, 58, 6], abs=1)  # 0.2 s, and 1.7 s for each that waits


def test_one_that_waits_and_is_told_to_land_is_never_armed_and_the_flight_ends() -> None:
    first, second = ScriptedPilot(), ScriptedPilot()
    with scripted(first, second) as flight:
        steps = []
        for step in flight:
            steps.append(step)
            if len(steps) == 20:
                assert flight.land("the user wants to")
    assert first.calls == ["arm link", "close"]
    assert second.calls == ["arm link", "arm at 6", "close"]
    assert len(steps) == 21
    assert steps[-1].down


class AwayCamera(LiveCamera):
    """A camera without pictures, which is still being opened again at so many looks."""

    def __init__(self, looks: int) -> None:
        self._looks = looks

    @property
    def fault(self) -> str:
        return "the camera has delivered no picture for 3.0 s"

    @property
    def may_return(self) -> bool:
        self._looks -= 1
        return self._looks >= 0

    def begin(self, start: float) -> None:
        pass

    def close(self) -> None:
        pass


def test_on_the_ground_a_camera_that_is_opened_again_is_waited_for() -> None:
    patient, impatient = ScriptedPilot(), ScriptedPilot()
    impatient.camera, patient.camera = AwayCamera(3), AwayCamera(10**6)
    with scripted(patient) as flight:
        assert any(step.steps[0].safety.phase == "flying" for step in flight)
    with scripted(impatient) as flight:
        assert len(list(flight)) == 4
        assert flight.fault == impatient.camera.fault


def test_a_flight_that_is_over_says_at_once_that_its_camera_is_away() -> None:
    pilot = ScriptedPilot(down_at=40)
    pilot.camera = AwayCamera(10**6)
    with scripted(pilot) as flight:
        assert len(list(flight)) == 40
        assert flight.fault == pilot.camera.fault
