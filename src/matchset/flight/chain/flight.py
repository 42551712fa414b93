"""A chain in flight, an iterable of `ChainStep`s: `ChainFlight`, simulated: `Flight`."""

import abc
import itertools
from collections.abc import Iterable, Iterator

import numpy as np
import numpy.typing as npt

from matchset.flight.chain.chain_step import ChainStep, Crash, FlightSetup
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.outline_pilot import OutlinePilot
from matchset.flight.chain.pilot import Pilot
from matchset.flight.chain.score import FlightScorer
from matchset.flight.real_time.memory import steady_memory
from matchset.image.frame import Frame
from matchset.links.simulated import SimulatedChain
from matchset.localization.markers.ball_colors import BallColors, learn_colors
from matchset.media.closing import Closing
from matchset.sim.world import relative_position

Floats = npt.NDArray[np.float64]


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

    def succeeded(self, scorer: FlightScorer) -> bool:
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
    colors : tuple of BallColors
        None where the world is quick and there are no pictures.
    pilots : tuple of Pilot
        One per follower; each knows its own camera and its own link only.
    """

    def __init__(self, parameters: FlightParameters | None = None) -> None:
        self.parameters = parameters or FlightParameters()
        self.chain = SimulatedChain(self.parameters.world, self.parameters.pilot.place)
        cameras, links = self.chain.cameras, self.chain.links
        self.samples: tuple[Frame, ...] = tuple(camera.sample() for camera in cameras)
        models, world = tuple(camera.model for camera in cameras), self.parameters.world
        self.setup = FlightSetup(self.parameters, models, self.samples, fps=world.fps)
        self._index, pilot = 0, self.parameters.loop
        self.colors: tuple[BallColors, ...] = ()
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
                for pilot in self.parameters.due(self.pilots, index / self.parameters.world.fps):
                    pilot.arm()
                yield self.step()

    @property
    def length(self) -> int:
        """Number of steps of the flight."""
        return max(round(self.parameters.duration * self.parameters.world.fps), 1)

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
