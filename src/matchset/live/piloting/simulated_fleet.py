"""The simulated chain as a fleet, at the rate of a clock: `SimulatedFleet`."""

from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pacer import Pacer
from matchset.flight.chain.pilot import Pilot
from matchset.links.simulation_parameters import FPS
from matchset.live.piloting.fleet import Fleet, FleetStep


class SimulatedFleet(Fleet):
    """A simulated chain; until its pilots are armed a hand holds each vehicle at its start.

    Parameters
    ----------
    parameters : FlightParameters
        Its duration does not count.
    real_time : bool
        Whether a step waits for the time of its picture.
    """

    def __init__(self, parameters: FlightParameters, real_time: bool = True) -> None:
        self._flight = Flight(parameters)
        self.pilots = self._flight.pilots
        self._pacer: Pacer | None = None
        self._real_time = real_time

    def step(self) -> FleetStep:
        """Take a step with everybody, in lock step."""
        if self._real_time:
            self._pacer = self._pacer or Pacer(1.0 / FPS)
            self._pacer.wait()
        step = self._flight.step()
        return FleetStep(step.time, step.steps, step.truth, tuple(each.description for each in step.crashes))

    def due(self, time: float) -> list[Pilot]:
        """Those next to the rope first, see `FlightParameters.stagger`."""
        return self._flight.parameters.due(self.pilots, time)

    def close(self) -> None:
        """Land everybody and let go of the world."""
        self._flight.close()
