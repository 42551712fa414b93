"""Parameters of a flight, and who is armed when: `FlightParameters`."""

from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.chain.long_chain import LongChainParameters, in_chain
from matchset.flight.chain.pilot import Pilot, PilotParameters
from matchset.flight.linked.parameters import LinkedParameters
from matchset.links.simulation_parameters import SimulationParameters
from matchset.numeric.arguments import require_at_least, require_within

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
        require_within(self, {"duration": (0.1, 3600.0)})
        if self.pilot.follower.commands == "speeds" and self.world.commands == "angles":
            raise ValueError('commands: [flight.world] commands = "speeds" is what changes it, or the link tello:')
        require_at_least(self, 1, "together")
        times = {"stagger": (0.0, 60.0), "stagger_delays": (0.0, 60.0), "sight_ahead": (0.0, 60.0)}
        require_within(self, times | {"sight_margin": (0.0, 10.0)})

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
