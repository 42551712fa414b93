"""What is flown: the contract `Fleet`, and real vehicles by their cameras and links, `LinkedFleet`."""

import abc
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

from matchset.app.closing import Closing
from matchset.app.flight.pilot import Camera, Colors, Pilot, PilotParameters, PilotStep
from matchset.links.connect import connect
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

    def arming_time(self, follower: int) -> float:  # noqa: ARG002
        """How long after the first one a follower, from 0, takes off, s."""
        return 0.0

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


class LinkedFleet(Fleet):
    """Vehicles with a camera and a link each, as `Pilot` knows them: each pilot steps in a thread of its own.

    Parameters
    ----------
    pilots : sequence of Pilot
    """

    def __init__(self, pilots: Sequence[Pilot]) -> None:
        self.pilots = tuple(pilots)
        self._threads = ThreadPoolExecutor(len(self.pilots), "matchset pilot")

    def step(self) -> FleetStep:
        """Take a step with everybody at once, at the rate of the slowest camera."""
        steps = tuple(self._threads.map(Pilot.step, self.pilots))
        return FleetStep(max(step.now for step in steps), steps)

    def arm(self, pilots: Sequence[Pilot]) -> None:
        """Arm pilots at once: a link that hears nothing while another one is armed would stop its motors."""
        list(self._threads.map(Pilot.arm, pilots))

    def close(self) -> None:
        """Land everybody at once, and close the links."""
        landing = [self._threads.submit(pilot.link.close) for pilot in self.pilots]
        self._threads.shutdown()
        for each in landing:
            each.result()


def linked_fleet(camera: Camera, uri: str, colors: Colors, parameters: PilotParameters | None = None) -> LinkedFleet:
    """Make a fleet of one follower.

    Parameters
    ----------
    camera : Camera
    uri : str
        Of its link, as `matchset.links.connect.connect` opens it.
    colors : Colors
        Of the ball that it follows, and of the marker.
    parameters : PilotParameters, optional

    Raises
    ------
    ValueError, LinkError
        If the link cannot be opened.
    """
    return LinkedFleet([Pilot(camera, connect(uri), colors, parameters)])
