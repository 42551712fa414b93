"""A rope, a camera and a vehicle that Betaflight flies, in one time: `BetaflightWorld`, `BetaflightCamera`."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from benchmarks.flight.betaflight.airframe import Airframe, quaternion, turn
from benchmarks.flight.betaflight.sitl import BOOT, RATE, Sitl
from matchset.control.follower import RelativeSetpoint
from matchset.image.frame import Frame
from matchset.links.simulation_parameters import STEPS_PER_FRAME, SimulationParameters
from matchset.sim.cameras import FIELD, WorldCameras
from matchset.sim.scene.furniture import FLOOR
from matchset.sim.scene.room import BACK, BEHIND, HALF_WIDTH
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import RATE as WORLD_RATE
from matchset.sim.world import World

Floats = npt.NDArray[np.float64]
PER_STEP = RATE // WORLD_RATE  # steps of Betaflight in one of the world
LEVEL_ERROR = math.radians(2.0)  # of its attitude, in a direction of the seed
GYRO_NOISE = math.radians(0.3)  # rad/s, standard deviation of a sample
KEPT = WORLD_RATE  # poses that are remembered


class BetaflightWorld(World):
    """The world of a rope, whose first vehicle is another's: Betaflight's.

    Parameters
    ----------
    parameters : SimulationParameters
        Two vehicles.
    folder : Path
        With Betaflight's settings.
    place : RelativeSetpoint
        Where the vehicle begins beside the rope's.

    Attributes
    ----------
    sitl : Sitl
    airframe : Airframe
    hooks : list of callables
        What is called in each step of 1/960 s.
    crash : str
        What happened to the vehicle, and when; empty if nothing.
    """

    def __init__(self, parameters: SimulationParameters, folder: Path, place: RelativeSetpoint) -> None:
        self.hooks: list[Callable[[], None]] = []
        self.crash, self.fine = "", 0
        self._mine: dict[int, VehiclePose] = {}
        super().__init__(parameters.chain(place), parameters.seed)
        first = super().poses(0)[0]
        yaw = math.atan2(first.rotation[0, 2], first.rotation[2, 2])
        self.airframe = Airframe(first.position, yaw)
        self._random = np.random.default_rng((parameters.seed, 0xBE7A))
        direction = self._random.uniform(0.0, 2.0 * math.pi)
        self._level = turn(LEVEL_ERROR * np.array((math.cos(direction), 0.0, math.sin(direction))))
        self._mine[0] = self._pose()
        self.sitl = Sitl(folder)
        self.sitl.rest(BOOT)

    @property
    def now(self) -> float:
        """Time of the finest step, s."""
        return self.fine / RATE

    def advance(self, step: int) -> None:
        """Let time pass until a step of 1/480 s."""
        while self.fine < PER_STEP * step:
            self._step()

    def pass_time(self, seconds: float) -> None:
        """Let time pass, s: at least a step."""
        for _ in range(max(round(seconds * RATE), 1)):
            self._step()

    def poses(self, step: int) -> list[VehiclePose]:
        """Poses of both vehicles at a step of the last second."""
        others = super().poses(step)
        return [self._mine[max(step, 0)], *others[1:]] if self._mine else others

    def _step(self) -> None:
        frame = self.airframe
        rates = frame.rates + GYRO_NOISE * self._random.standard_normal(3)
        right, down, ahead = frame.felt
        self.sitl.step(quaternion(frame.rotation @ self._level), rates[[2, 0, 1]], np.array((ahead, -right, -down)))
        if not self.crash:
            frame.step(np.array(self.sitl.motors), 1.0 / RATE)
        self.fine += 1
        if self.fine % PER_STEP == 0:
            super().advance(self.fine // PER_STEP)
            self._mine[self.step] = self._pose()
            self._mine.pop(self.step - KEPT, None)
            self._look_for_a_crash()
        for hook in self.hooks:
            hook()

    def _pose(self) -> VehiclePose:
        frame = self.airframe
        return VehiclePose(frame.position.copy(), frame.rotation.copy(), frame.ball)

    def _look_for_a_crash(self) -> None:
        x, y, z = self.airframe.position
        scale, radius = self.room_scale, self.airframe.parameters.ball_radius
        what = ""
        if y > FLOOR - 0.03:
            what = "floor"
        elif self.airframe.ball[1] < radius - FLOOR:
            what = "ceiling"
        elif abs(x) > scale * HALF_WIDTH - radius or not scale * BEHIND + radius < z < scale * BACK - radius:
            what = "wall"
        elif np.linalg.norm(self.airframe.position - super().poses(self.step)[1].position) < 0.25:
            what = "the other vehicle"
        if what and not self.crash:
            self.crash = f"{what} at {self.now:.1f} s"
            self.airframe.velocity[:] = self.airframe.rates[:] = 0.0


class BetaflightCamera:
    """The camera of the vehicle; reading it lets the time of exposure, link and computing pass.

    Parameters
    ----------
    world : BetaflightWorld
    parameters : SimulationParameters

    Attributes
    ----------
    model : CameraModel
    index : int
        Of the last picture.
    """

    def __init__(self, world: BetaflightWorld, parameters: SimulationParameters) -> None:
        self.model, self.index, self._world = parameters.camera, 0, world
        self.images = WorldCameras(world, self.model, parameters.pal)
        self._latency = max(round(1e-3 * parameters.latency_ms * WORLD_RATE), FIELD)

    def read(self) -> Frame:
        """Return the next picture; those that were missed while nobody looked are left out."""
        self.index = max(self.index + 1, (self._world.step - self._latency) // STEPS_PER_FRAME + 1)
        taken = STEPS_PER_FRAME * self.index
        self._world.advance(taken + self._latency)
        return Frame(self.images.image(0, taken), taken / WORLD_RATE, self.index)

    def sample(self) -> Frame:
        """Return a picture of a ball held 1 m before the camera, to learn the colors from."""
        return Frame(self.images.held_ball(0), 0.0, 0)

    def now(self) -> float:
        """Return the time, s."""
        return self._world.now
