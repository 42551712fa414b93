"""A flight as a feed: `FlightFeed`; of the simulated chain: `simulated_flight`; of real vehicles: `linked_flight`."""

import time
from collections.abc import Callable
from pathlib import Path

from matchset.live.feed import Feed, News
from matchset.live.piloting.commander import IN_FLIGHT
from matchset.live.piloting.fleet import Fleet
from matchset.live.piloting.flight_loop import FlightLoop
from matchset.live.piloting.panel import FlightPanel


class FlightFeed(Feed):
    """Shows what every follower sees, and lets one page command. Closing it lands everybody.

    Parameters
    ----------
    title : str
    followers : int
    open_fleet : callable
        Returns a `Fleet` of so many followers, at the start; called in a thread, and again for every flight.
    news : callable
        Told of each picture.
    clock : callable
        By which a page is silent, s.
    """

    kind = "flight"

    def __init__(
        self,
        title: str,
        followers: int,
        open_fleet: Callable[[], Fleet],
        news: News,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.title = title
        self.loop = FlightLoop(followers, open_fleet, news, clock=clock)
        self.streams = self.loop.streams
        self.panels = (FlightPanel(self.loop),)

    @property
    def busy(self) -> str:
        """Why something else cannot be shown now: while somebody flies; else empty."""
        here = self.loop.commander.look()
        return f"{here.page} commands a flight: land first" if here.duty in IN_FLIGHT else ""

    def close(self) -> None:
        """Land everybody, and end the thread."""
        self.loop.close()


def simulated_flight(uri: str, news: News) -> FlightFeed:
    """Make the feed of a simulated chain.

    Parameters
    ----------
    uri : str
        ``sim://chain?vehicles=3&seed=7``.
    news : callable
        Told of each picture.

    Raises
    ------
    ValueError
        If the URI is none of a simulated chain, or a parameter is out of range.
    """
    from matchset.flight.chain.config import with_uri
    from matchset.flight.chain.flight_parameters import FlightParameters
    from matchset.live.piloting.simulated_fleet import SimulatedFleet

    parameters = with_uri(uri, FlightParameters())
    return FlightFeed(uri, parameters.world.vehicles - 1, lambda: SimulatedFleet(parameters), news)


def linked_flight(path: Path, news: News, note: Callable[[str], None]) -> FlightFeed:
    """Make the feed of real vehicles.

    Parameters
    ----------
    path : Path
        Settings that name them, as ``[[follower]]``.
    news : callable
        Told of each picture.
    note : callable
        Told what a person should know.

    Raises
    ------
    ValueError
        If the file names no vehicles, or one of the files that it names is not what it should be.
    """
    from matchset.flight.chain.config import read_flight, read_followers
    from matchset.flight.linked.opening import check_followers, open_followers, read_files
    from matchset.live.piloting.linked_fleet import LinkedFleet

    followers = read_followers(path)
    if not followers:
        raise ValueError(f"{path} names no real vehicle: it has no [[follower]] (docs/flight.md)")
    check_followers(followers)
    for follower in followers:
        read_files(follower)
    parameters = read_flight(path)

    def open_fleet() -> Fleet:
        opened, setup = open_followers(parameters, followers, dry=False)
        for words in opened.notes:
            note(words)
        return LinkedFleet(opened, setup.parameters)

    return FlightFeed("; ".join(follower.words for follower in followers), len(followers), open_fleet, news)
