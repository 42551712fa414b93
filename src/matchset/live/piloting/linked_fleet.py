"""Real vehicles as a fleet: `LinkedFleet`."""

import time
from collections.abc import Sequence

from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import Pilot
from matchset.flight.linked.followers import LinkedFollowers
from matchset.image.errors import LinkError
from matchset.live.piloting.fleet import Fleet, FleetStep


class LinkedFleet(Fleet):
    """Vehicles with a camera and a link each; nobody knows the truth of their places.

    Parameters
    ----------
    followers : LinkedFollowers
        Belong to the fleet from here on.
    parameters : FlightParameters
        Its duration and its world do not count.
    """

    def __init__(self, followers: LinkedFollowers, parameters: FlightParameters | None = None) -> None:
        self.pilots, self._followers = followers.pilots, followers
        self._parameters = parameters or FlightParameters()
        followers.begin(time.monotonic())

    def step(self) -> FleetStep:
        """Take a step with everybody at once, at the rate of the slowest camera.

        Raises
        ------
        LinkError
            If a link is gone, or a camera, when nobody is in the air: until then it is one without pictures.
        """
        steps = self._followers.step()
        if words := self._followers.fault_on_ground(steps):
            raise LinkError(words)
        self._followers.land_with(steps)
        return FleetStep(max(step.now for step in steps), steps)

    def due(self, time: float) -> list[Pilot]:
        """Those at the end of the chain first, see `FlightParameters.stagger`."""
        return self._parameters.due(self.pilots, time)

    def arm(self, pilots: Sequence[Pilot]) -> None:
        """Arm pilots at once."""
        self._followers.arm(pilots)

    def close(self) -> None:
        """Land everybody at once, close links and cameras."""
        self._followers.close()
