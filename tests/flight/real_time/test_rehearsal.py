"""Before it is armed a pilot has done all that a step does, and a step that the link refuses is no flight."""

import gc
import weakref
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest
from fakes import FakePort

from matchset.control.command import Command
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.flight.real_time import memory
from matchset.flight.real_time.memory import steady_memory
from matchset.flight.recording.devices import RecordedCamera
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import SimulationParameters
from matchset.localization.markers.ball_colors import BallColors, learn_colors
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost, Track


class Filmed(msgspec.Struct):
    """What a camera saw, and what was learned from it."""

    camera: RecordedCamera
    colors: BallColors
    frames: list[Frame]


@pytest.fixture(scope="module")
def filmed() -> Filmed:
    chain = SimulatedChain(SimulationParameters(vehicles=2, seed=5))
    camera = chain.cameras[0]
    colors = learn_colors(camera.sample())
    frames = [frame for frame in (camera.read() for _ in range(10)) if frame is not None]
    chain.close()
    return Filmed(RecordedCamera(camera.model), colors, frames)


def transmitter() -> tuple[ArduinoLink, FakePort]:
    port = FakePort()
    port.clock.sleep(0.2)
    return ArduinoLink("serial:///fake", port, clock=port.clock, sleep=port.clock.sleep), port


def fly(pilot: Pilot, filmed: Filmed, port: FakePort, pause: float = 0.0, begin: float = 0.0) -> list[PilotStep]:
    """Fly through the pictures; with a pause of so many s before the fifth."""
    steps = []
    for number, frame in enumerate(filmed.frames):
        port.clock.sleep(1 / 30 + (pause if number == 4 else 0.0))
        image = frame.image ^ np.uint8(begin > 0.0)  # no picture of a camera comes twice
        filmed.camera.frame = msgspec.structs.replace(frame, image=image, time=begin + frame.time)
        filmed.camera.time = begin + frame.time + 0.067
        steps.append(pilot.step())
    return steps


@pytest.fixture
def rehearsed(monkeypatch: pytest.MonkeyPatch) -> list[PilotStep]:
    """The steps that pilots take."""
    steps: list[PilotStep] = []
    step = Pilot.step

    def noted(pilot: Pilot) -> PilotStep:
        steps.append(step(pilot))
        return steps[-1]

    monkeypatch.setattr(Pilot, "step", noted)
    return steps


def test_it_rehearses_what_a_flight_may_bring_and_forgets_it(filmed: Filmed, rehearsed: list[PilotStep]) -> None:
    link, port = transmitter()
    heard = len(port.heard)
    pilot = Pilot(filmed.camera, link, filmed.colors)
    assert {each.frame.image.shape for each in rehearsed if each.frame is not None} == {(480, 640, 3)}
    assert any(isinstance(each.ball, Track) and each.markers and isinstance(each.pose, Pose) for each in rehearsed)
    assert any(isinstance(each.ball, Track) and not each.markers for each in rehearsed)
    assert any(isinstance(each.ball, Lost) for each in rehearsed)
    assert any(each.frame is None for each in rehearsed)
    assert any(each.command.throttle > 0.1 for each in rehearsed)
    assert {each.safety.phase for each in rehearsed} >= {"locked", "flying", "holding"}
    assert (pilot.armed, len(port.heard)) == (False, heard)
    assert (pilot._follower.neighbor.time, pilot._safety.phase) == (-np.inf, "locked")


def test_gray_pictures_are_rehearsed_in_gray(filmed: Filmed, rehearsed: list[PilotStep]) -> None:
    gray = ColorModel(np.linspace(-4.0, 4.0, 256, dtype=np.float32))
    Pilot(filmed.camera, transmitter()[0], BallColors(gray, gray))
    assert {each.frame.image.shape for each in rehearsed if each.frame is not None} == {(480, 640)}


def test_a_pause_longer_than_the_failsafe_is_a_cut_with_its_reason(filmed: Filmed) -> None:
    link, port = transmitter()
    pilot = Pilot(filmed.camera, link, filmed.colors)
    pilot.arm()
    steps = fly(pilot, filmed, port, pause=0.3)
    assert port.state != "armed"
    assert [each.safety.phase for each in steps[:4]] == ["flying"] * 4
    late = steps[5:]
    assert {each.safety.phase for each in late} == {"cut"}
    assert {each.command for each in late} == {Command()}
    assert {each.safety.reason for each in late} == {steps[5].safety.reason}
    assert "the transmitter" in steps[5].safety.reason
    assert [bool(each.stopped) for each in steps].count(True) == 1
    pilot.arm()
    assert fly(pilot, filmed, port, begin=1.0)[-1].safety.phase == "flying"


def test_a_pause_shorter_than_the_failsafe_is_flown_through(filmed: Filmed) -> None:
    link, port = transmitter()
    pilot = Pilot(filmed.camera, link, filmed.colors)
    pilot.arm()
    assert {each.safety.phase for each in fly(pilot, filmed, port, pause=0.15)} == {"flying"}


def test_the_simulated_chain_is_cut_as_a_real_one() -> None:
    world = SimulationParameters(vehicles=3, seed=5, silent=0.4, silent_for=0.3)
    with Flight(FlightParameters(duration=1.0, together=2, world=world)) as flight:
        last = list(flight)[-1]
    for step in last.steps:
        assert (step.safety.phase, step.command) == ("cut", Command())
        assert "heard nothing" in step.safety.reason


@pytest.fixture
def nobody_flies(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As in a program: the tests themselves are one block of steady memory."""
    monkeypatch.setattr(memory, "_frozen", 0)
    gc.unfreeze()
    yield
    gc.freeze()


@pytest.mark.usefixtures("nobody_flies")
def test_garbage_is_collected_before_a_flight_and_in_it_only_what_is_new_is_looked_at() -> None:
    class Node:
        itself: object

    node, kept = Node(), [[k] for k in range(1000)]
    node.itself, gone = node, weakref.ref(node)
    del node
    with steady_memory():
        assert gone() is None
        with steady_memory():
            made = [kept]
        looked_at = {id(each) for each in gc.get_objects()}
        assert id(made) in looked_at
        assert not {id(each) for each in kept} & looked_at
    assert gc.get_freeze_count() == 0
    assert gc.isenabled()
