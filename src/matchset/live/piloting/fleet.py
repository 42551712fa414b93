"""What is flown: the contract `Fleet`, and its steps."""

import abc
from collections.abc import Sequence
from typing import NamedTuple

from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.media.closing import Closing
from matchset.sim.vehicle import VehiclePose


class FleetStep(NamedTuple):
    """One step of every follower's loop.

    Attributes
    ----------
    time : float
        When the commands were sent, s, on the clock of the pictures.
    steps : tuple of PilotStep
        One per follower.
    truth : tuple of VehiclePose
        True pose of every vehicle at `time`; empty if nobody knows them.
    crashes : tuple of str
        In words.
    """

    time: float
    steps: tuple[PilotStep, ...]
    truth: tuple[VehiclePose, ...] = ()
    crashes: tuple[str, ...] = ()


class Fleet(Closing):
    """Followers that fly at the same time; closing it lands everybody.

    Attributes
    ----------
    pilots : sequence of Pilot
        One per follower; none is armed.
    """

    pilots: Sequence[Pilot]

    @abc.abstractmethod
    def step(self) -> FleetStep:
        """Take a step with everybody; waits for pictures, and arms nobody.

        Raises
        ------
        LinkError
            If a camera or a link is gone.
        """

    @abc.abstractmethod
    def due(self, time: float) -> list[Pilot]:
        """Those who are to be armed now, so long after the first one, s."""

    def arm(self, pilots: Sequence[Pilot]) -> None:
        """Arm pilots.

        Raises
        ------
        LinkError
            If a link refuses.
        """
        for pilot in pilots:
            pilot.arm()

    def cut(self, reason: str) -> None:
        """Stop all motors at once; never waits, in any thread."""
        for pilot in self.pilots:
            pilot.cut(reason)
