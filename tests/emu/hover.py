"""The whole chain: a simulated toy that hears the emulated board alone, flown by the follower's own loop.

Renderer -> tracker -> localizer -> follower -> CRSF -> pseudo-terminal -> ATmega328P -> nRF24 -> receiver -> world.
"""

from collections.abc import Callable
from types import TracebackType
from typing import Self

import msgspec
from cable import Cable, CountingPort
from emulator import Board
from receiver import Quadcopter

from flight import BOUND
from matchset.control.command import Command
from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.image.frame import Frame
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.simulated import SimulatedCamera, SimulatedChain
from matchset.links.simulation_parameters import FPS, STEPS_PER_FRAME, SimulationParameters
from matchset.localization.markers.ball_colors import learn_colors
from matchset.numeric.record import fields
from matchset.sim.quadrotor import STATE
from matchset.sim.vehicle import toy
from matchset.sim.world import RATE


class Hover:
    """One follower that watches a swinging ball, its commands on the air of an emulated radio.

    Parameters
    ----------
    seed : int
        Of the world.

    Attributes
    ----------
    board : Board
    quadcopter : Quadcopter
        The receiver in the toy.
    chain : SimulatedChain
        The world; its own radio is left out: no delay, no failsafe.
    link : ArduinoLink
    pilot : Pilot
    """

    def __init__(self, seed: int) -> None:
        plain = msgspec.structs.replace(toy(), radio_delay=0.0, failsafe=1e3)
        self.chain = SimulatedChain(SimulationParameters(vehicles=2, seed=seed, vehicle=plain))
        self.board, self.quadcopter = Board(), Quadcopter()
        self.quadcopter.listen(self.board.run(BOUND))
        self.cable = Cable(self.board)
        self.port = CountingPort(self.cable.path)
        self.link = ArduinoLink(self.cable.path, self.port, clock=lambda: self.board.time, sleep=self._run)
        self._ahead = 0.0  # of the board's clock before the world's, s
        camera = self.chain.cameras[0]
        self.pilot = Pilot(AirCamera(self, camera), self.link, learn_colors(camera.sample()))

    def fly(self, seconds: float) -> list[PilotStep]:
        """Fly on for a time; returns what happened in each turn of the loop."""
        if not self.pilot.armed:
            self.pilot.arm()
            self._ahead = self.board.time - self.chain.now()
        return [self.pilot.step() for _ in range(round(seconds * FPS))]

    def coast(self, seconds: float) -> None:
        """Let time pass with nobody at the sticks, the cable in or out."""
        step = self.chain.world.step + round(seconds * RATE)
        self.follow(step, lambda passed: self.quadcopter.listen(self.board.run(passed)))

    def pass_until(self, step: int) -> None:
        """Let time pass on board and in the world until a step of the world, bytes moving on the cable."""
        self.follow(step, self._run)

    def follow(self, step: int, run: Callable[[float], None]) -> None:
        """Let time pass until a step of the world, the toy's sticks being what its receiver has heard."""
        world = self.chain.world
        while world.step < step:
            run(max((world.step + 1) / RATE + self._ahead - self.board.time, 0.0))
            world.send(0, heard(self.quadcopter, self.board.time))
            world.advance(world.step + 1)

    @property
    def thrust(self) -> float:
        """Of the toy's motors, N."""
        return float(fields(self.chain.world.states[0], STATE).thrust)

    @property
    def falling(self) -> float:
        """Speed of the toy toward the floor, m/s."""
        return float(fields(self.chain.world.states[0], STATE).velocity[1])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.chain.close()
        self.board.close()

    def _run(self, seconds: float) -> None:
        before = len(self.board.packets)
        self.cable.step(self.port, seconds)
        self.quadcopter.listen(self.board.packets[before:])


class AirCamera:
    """The follower's camera; while a picture is worked on, time passes on the board too.

    Attributes
    ----------
    model : CameraModel
    """

    def __init__(self, hover: Hover, camera: SimulatedCamera) -> None:
        self.model, self._hover, self._camera, self._index = camera.model, hover, camera, 0

    def read(self) -> Frame | None:
        """Return the next picture."""
        self._index += 1
        latency = round(1e-3 * self._hover.chain.parameters.latency_ms * RATE)
        self._hover.pass_until(STEPS_PER_FRAME * self._index + latency)
        return self._camera.read()

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return self._camera.now()


def heard(quadcopter: Quadcopter, time: float) -> Command:
    """Sticks that the toy's receiver passes on at a time, s."""
    last, throttle = quadcopter.last, quadcopter.motors(time)
    if last is None or throttle == 0:
        return Command()
    return Command(last.roll / 127, last.pitch / 127, last.yaw / 127, throttle / 255)
