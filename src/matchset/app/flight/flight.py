"""A chain in flight, an iterable of `ChainStep`s: `ChainFlight`, simulated: `Flight`; what is fixed: `FlightSetup`."""

import abc
import itertools
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.closing import Closing
from matchset.app.flight.linked.parameters import LinkedParameters
from matchset.app.flight.outline_pilot import OutlinePilot
from matchset.app.flight.pilot import Pilot, PilotParameters, PilotStep
from matchset.app.flight.real_time.memory import steady_memory
from matchset.camera.camera_model import CameraModel
from matchset.control.chain.long_chain import LongChainParameters, in_chain
from matchset.image.frame import Frame
from matchset.links.simulated import FPS, SimulatedChain, SimulationParameters
from matchset.localization.markers.ball_colors import Colors, learn_colors
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import relative_position

if TYPE_CHECKING:
    from matchset.app.flight.score import FlightScorer

Floats = npt.NDArray[np.float64]


class FlightParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of a flight, as `flight.toml` has them.

    Parameters
    ----------
    duration : float
        Length, s. More takes longer to simulate; less hides errors that grow slowly.
    world : SimulationParameters
        The world, its cameras and its links.
    pilot : PilotParameters
        Every follower's loop, in a short chain.
    long_chain : LongChainParameters
        What is otherwise in a long one.
    linked : LinkedParameters
        Times of a real flight.
    together : int
        Number of followers that are armed at once, those next to the rope. Each learns in its first second the throttle
        that hovers, from how it moves beside its neighbor: two that begin at once fall side by side and see nothing of
        it (decision 111).
    stagger, stagger_delays : float
        How much later each of the others is armed than the one that it watches, s, and how many of the delays from
        picture to effect besides, as they are told: the longer they are, the longer a neighbor takes to come to rest.
        More lets it do so: with 1.2 s in all a follower is released while its neighbor still rushes to its own place,
        at 1 m/s and 0.7 m off, and chains of ten fall at 133 ms. With 2.2 s at 67 ms, and 3.2 s in general, the
        neighbor has moved out of sight of one that a hand holds. Chosen by: rendered chains of ten, 1.7 s at 67 ms and
        2.2 s at 133 ms, docs/log/control.md#releases.
    sight_ahead, sight_margin : float
        One that waits is armed sooner if the middle of the ball that it watches will be so near to the border of its
        picture, in radii of the ball, in so long, s. More begins beside a neighbor that moves faster; less loses more.
    """

    duration: float = 60.0
    together: int = 1
    stagger: float = 1.0
    stagger_delays: float = 7.5
    sight_ahead: float = 0.6
    sight_margin: float = 2.0
    world: SimulationParameters = SimulationParameters()
    pilot: PilotParameters = PilotParameters()
    long_chain: LongChainParameters = LongChainParameters()
    linked: LinkedParameters = LinkedParameters()

    def __post_init__(self) -> None:
        if not 0.1 <= self.duration <= 3600.0:
            raise ValueError(f"duration must be within 0.1 ... 3600, got {self.duration}")
        if self.pilot.follower.commands == "speeds" and self.world.commands == "angles":
            raise ValueError('commands: [flight.world] commands = "speeds" is what changes it, or the link tello:')
        if self.together < 1:
            raise ValueError(f"together must be 1 or more, got {self.together}")
        if not 0.0 <= self.stagger <= 60.0:
            raise ValueError(f"stagger must be within 0 ... 60, got {self.stagger}")
        if not 0.0 <= self.stagger_delays <= 60.0:
            raise ValueError(f"stagger_delays must be within 0 ... 60, got {self.stagger_delays}")
        if not 0.0 <= self.sight_ahead <= 60.0:
            raise ValueError(f"sight_ahead must be within 0 ... 60, got {self.sight_ahead}")
        if not 0.0 <= self.sight_margin <= 10.0:
            raise ValueError(f"sight_margin must be within 0 ... 10, got {self.sight_margin}")

    @property
    def loop(self) -> PilotParameters:
        """Every follower's loop in a chain of this length."""
        follower = self.pilot.follower
        if self.world.commands == "speeds":
            follower = msgspec.structs.replace(follower, commands="speeds")
        follower = in_chain(follower.in_use, self.world.vehicles - 1, self.long_chain)
        return msgspec.structs.replace(self.pilot, follower=follower)

    def arming_time(self, follower: int) -> float:
        """When a follower, from 0, is armed at the latest, s: until then a hand holds it."""
        behind = self.world.vehicles - 2 - follower
        delay = self.world.picture_times.told + self.pilot.follower.ego_motion.delay
        apart = self.stagger + self.stagger_delays * delay
        return apart * max(behind - self.together + 1, 0)

    def due(self, pilots: Sequence[Pilot], time: float) -> list[Pilot]:
        """Those who are to be armed now: not yet in the air, and neither stopped nor told to land.

        Parameters
        ----------
        pilots : sequence of Pilot
            All of the chain, the first follower first.
        time : float
            Since the first one was armed, s.
        """
        found = []
        for number, pilot in enumerate(pilots):
            if pilot.armed or pilot.killed or pilot.landing:
                continue
            leads = number + 1 < len(pilots) and pilots[number + 1].armed  # its neighbor flies
            sooner = leads and pilot.is_losing_sight(self.sight_ahead, self.sight_margin)
            if sooner or time >= self.arming_time(number):
                found.append(pilot)
        return found


class Crash(msgspec.Struct, frozen=True):
    """The end of a vehicle.

    Parameters
    ----------
    time : float
        s.
    vehicle : int
        Which, from 1.
    what : str
        What happened, in words: "hit the floor".
    """

    time: float
    vehicle: int
    what: str

    @property
    def description(self) -> str:
        """Who, what and when: ``vehicle 1 hit the floor at 3.2 s``."""
        return f"vehicle {self.vehicle} {self.what} at {self.time:.1f} s"


class ChainStep(msgspec.Struct, frozen=True, kw_only=True):
    """One step of every follower's loop, and the truth, which the simulator alone knows: one picture of every camera.

    Vehicles are counted as in the paper, the first follower first; `steps` has one entry per follower, the truth one
    per vehicle, so ``truth[-1]`` hangs on the rope and ``steps[i]`` watches ``truth[i + 1]``.

    Parameters
    ----------
    index : int
        Of the pictures, from 1.
    time : float
        When the commands were sent, s on the clock of the pictures.
    steps : tuple of PilotStep
        What each follower measured, decided and sent.
    truth : tuple of VehiclePose
        True pose of every vehicle, and position of its ball, at `time`, in the room: x right, y down, z forward, m.
        Empty where nobody knows.
    truth_at_exposure : tuple of VehiclePose
        The same at the middle of the pictures' exposure: what `steps` should have measured.
    true_positions : ndarray of shape (followers, 3)
        True side, height and heading of each follower's camera in the level frame of its neighbor's ball, at `time`, m
        (Epstein & Feldman, Eq. 6-8). NaN where nobody knows.
    in_view : tuple of bool
        Whether the middle of the neighbor's ball was inside each camera's picture, and nothing hid it on purpose. Where
        nobody knows: whether a picture came.
    crashes : tuple of Crash
        Of this flight so far.
    """

    index: int
    time: float
    steps: tuple[PilotStep, ...]
    truth: tuple[VehiclePose, ...]
    truth_at_exposure: tuple[VehiclePose, ...]
    true_positions: Floats
    in_view: tuple[bool, ...]
    crashes: tuple[Crash, ...]

    @property
    def down(self) -> bool:
        """Whether everyone's motors have stopped for good; who was told to land before it flew never will."""
        return all(
            step.safety.phase == "cut" or (step.safety.phase == "locked" and step.landing) for step in self.steps
        )


FlightKind = Literal["simulated", "flight", "dry run"]
"""What flew: a simulated chain; real vehicles; real ones that were sent no throttle."""


class FlightSetup(NamedTuple):
    """What does not change during a flight, one that is flown or one that is replayed.

    Attributes
    ----------
    parameters : FlightParameters
    cameras : tuple of CameraModel
        One per follower.
    samples : tuple of Frame
        A picture of each camera from before the flight.
    kind : FlightKind
    colors : tuple of Colors
        What each follower looks for; empty: what it learns from its sample.
    countdown : float
        When the first follower is armed, s.
    fps : float
        Pictures a second of the slowest camera, about.
    devices : tuple of str
        Camera and link of each follower, for people; empty where they are simulated.
    """

    parameters: FlightParameters
    cameras: tuple[CameraModel, ...]
    samples: tuple[Frame, ...]
    kind: FlightKind = "simulated"
    colors: tuple[Colors, ...] = ()
    countdown: float = 0.0
    fps: float = FPS
    devices: tuple[str, ...] = ()

    @property
    def followers(self) -> int:
        """Number of followers: all vehicles but the last."""
        return len(self.cameras)

    @property
    def radius(self) -> float:
        """Radius of the balls, m."""
        return self.parameters.pilot.target.radius

    @property
    def has_truth(self) -> bool:
        """Whether the simulator knows where everybody is."""
        return self.kind == "simulated"


class ChainFlight(Closing):
    """A chain in flight, simulated or real: `for chain_step in flight`. Leaving its `with` block lands everyone.

    Attributes
    ----------
    parameters : FlightParameters
    pilots : tuple of Pilot
        One per follower; each knows its own camera and its own link only.
    setup : FlightSetup
    fault : str
        Why it ended before its time, where a device is to blame; else empty.
    """

    parameters: FlightParameters
    pilots: tuple[Pilot, ...]
    setup: FlightSetup
    fault: str = ""

    @abc.abstractmethod
    def __iter__(self) -> Iterator[ChainStep]:
        """Arm, and fly for the duration."""

    def land(self, reason: str) -> bool:  # noqa: ARG002 - closing the simulated world lands
        """Bring everybody down by the safety filter's descent; False where closing the flight is what lands."""
        return False

    def briefing(self, keys: bool) -> Iterable[str]:
        """Say what a person must know before it begins, a line each; `keys`: whether the space key is read."""
        return ["space stops all motors at once"] if keys else []

    def debriefing(self) -> Iterable[str]:
        """Say what else there is to say of it at its end, a line each."""
        return []

    def succeeded(self, scorer: "FlightScorer") -> bool:
        """Whether everyone flew to the end."""
        return scorer.score().survived

    def cut(self, reason: str) -> None:
        """Stop everyone's motors at once; may be called by another thread or a signal handler."""
        for pilot in self.pilots:
            pilot.cut(reason)


class Flight(ChainFlight):
    """A simulated chain with a pilot for every follower, in lock step: `for chain_step in flight`.

    The constructor compiles everything, so that nobody is armed before the loops can answer a picture at once. Leaving
    its `with` block lands everyone. The same parameters give the same flight, bit for bit.

    Parameters
    ----------
    parameters : FlightParameters, optional

    Attributes
    ----------
    parameters : FlightParameters
    chain : SimulatedChain
        The world, its cameras and its links.
    samples : tuple of Frame
        The pictures from which each pilot learned its colors.
    colors : tuple of Colors
        None where the world is quick and there are no pictures.
    pilots : tuple of Pilot
        One per follower; each knows its own camera and its own link only.
    """

    def __init__(self, parameters: FlightParameters | None = None) -> None:
        self.parameters = parameters or FlightParameters()
        self.chain = SimulatedChain(self.parameters.world, self.parameters.pilot.place)
        cameras, links = self.chain.cameras, self.chain.links
        self.samples: tuple[Frame, ...] = tuple(camera.sample() for camera in cameras)
        self.setup = FlightSetup(self.parameters, tuple(camera.model for camera in cameras), self.samples)
        self._index, pilot = 0, self.parameters.loop
        self.colors: tuple[Colors, ...] = ()
        self.pilots: tuple[Pilot, ...]
        if self.parameters.world.quick:
            self.pilots = tuple(OutlinePilot(*each, pilot) for each in zip(cameras, links, strict=True))
            return
        self.colors = tuple(learn_colors(sample) for sample in self.samples)
        self.pilots = tuple(Pilot(*each, pilot) for each in zip(cameras, links, self.colors, strict=True))

    def __iter__(self) -> Iterator[ChainStep]:
        """Arm one after the other and fly for the duration."""
        with steady_memory():
            for index in range(self.length):
                for pilot in self.parameters.due(self.pilots, index / FPS):
                    pilot.arm()
                yield self.step()

    @property
    def length(self) -> int:
        """Number of steps of the flight."""
        return max(round(self.parameters.duration * FPS), 1)

    def close(self) -> None:
        """Land everyone and let go of the world."""
        for link in self.chain.links:
            link.close()
        self.chain.close()

    def step(self) -> ChainStep:
        """Take one step of every follower's loop; arms nobody."""
        self._index += 1
        index = self._index
        steps = tuple(pilot.step() for pilot in self.pilots)
        truth, truth_at_exposure = self.chain.truth(), self.chain.truth(index)
        return ChainStep(
            index=index,
            time=self.chain.now(),
            steps=steps,
            truth=truth,
            truth_at_exposure=truth_at_exposure,
            true_positions=np.array([relative_position(me, other) for me, other in itertools.pairwise(truth)]),
            in_view=tuple(self.chain.inside(follower, index) for follower in range(len(steps))),
            crashes=tuple(Crash(time, vehicle + 1, what) for time, vehicle, what in self.chain.world.crashes),
        )
