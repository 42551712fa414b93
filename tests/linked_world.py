"""A flight by links on the clock of a simulated world, whatever the link: no test of it waits for a device."""

import threading
from collections.abc import Callable

import msgspec
from fakes import Clock

from matchset.control.command import Command
from matchset.flight.chain.chain_step import FlightSetup
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import Pilot
from matchset.flight.linked.dry_link import DryLink
from matchset.flight.linked.followers import LinkedFollowers
from matchset.flight.linked.linked_flight import LinkedFlight
from matchset.flight.real_time.rehearsal import RehearsalLink
from matchset.links.link import Link
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import SimulationParameters
from matchset.localization.markers.ball_colors import learn_colors

WORLD = SimulationParameters(vehicles=2, seed=5, width=320, height=240)
COUNTDOWN, DURATION, DESCENT = 0.5, 3.0, 2.0


class WorldClock(Clock):
    """The time of a simulated world, and what somebody has slept besides."""

    def __init__(self, chain: SimulatedChain) -> None:
        super().__init__()
        self._chain = chain

    def __call__(self) -> float:
        return self._chain.now() + self.now


class HeldLink(RehearsalLink):
    """A link to a vehicle that a hand holds: nothing that it is told moves the ball.

    Parameters
    ----------
    happens : callable, optional
        Called with the number of each command that comes.

    Attributes
    ----------
    commands : list of Command
    was_cut : threading.Event
    """

    def __init__(self, happens: Callable[[int], None] | None = None) -> None:
        self.commands, self.was_cut, self._happens = list[Command](), threading.Event(), happens

    def send(self, command: Command) -> Command:
        self.commands.append(command)
        if self._happens is not None:
            self._happens(len(self.commands))
        return command

    def cut(self) -> None:
        self.was_cut.set()


def believing(flight: FlightParameters) -> FlightParameters:
    """Make its pilots believe pictures that do not answer to the sticks."""
    follower = flight.pilot.follower
    answers = msgspec.structs.replace(follower.motion_consistency, max_evidence=100.0)
    follower = msgspec.structs.replace(follower, motion_consistency=answers)
    return msgspec.structs.replace(flight, pilot=msgspec.structs.replace(flight.pilot, follower=follower))


def made(
    chain: SimulatedChain, link: Link | None = None, dry: bool = False, flight: FlightParameters | None = None
) -> LinkedFlight:
    """A flight of the first follower of a chain, which cannot tell it from a real one.

    Parameters
    ----------
    chain : SimulatedChain
    link : Link, optional
        In place of that to the follower's vehicle, which stays in a hand then.
    dry : bool
    flight : FlightParameters, optional
        Its world does not count.
    """
    camera, link = chain.cameras[0], chain.links[0] if link is None else link
    sample = camera.sample()
    flight = FlightParameters(duration=DURATION) if flight is None else flight
    flight = msgspec.structs.replace(flight, world=msgspec.structs.replace(WORLD, commands=flight.world.commands))
    colors = learn_colors(sample)
    pilot = Pilot(camera, DryLink(link) if dry else link, colors, flight.loop)
    kind, countdown = ("dry run", 0.0) if dry else ("flight", COUNTDOWN)
    seen = (camera.model,), (sample,)
    named = {"kind": kind, "countdown": countdown, "colors": (colors,), "devices": (f"camera 0, {link.uri}",)}
    setup = FlightSetup(flight, *seen, **named)  # type: ignore[arg-type]
    return LinkedFlight(LinkedFollowers([pilot]), setup)
