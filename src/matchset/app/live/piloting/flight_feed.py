"""A flight as a feed: `FlightFeed`; that of the simulated chain: `simulated_flight`."""

from collections.abc import Callable

from matchset.app.live.feed import Feed, News
from matchset.app.live.piloting.commander import IN_FLIGHT
from matchset.app.live.piloting.fleet import Fleet
from matchset.app.live.piloting.flight_loop import FlightLoop
from matchset.app.live.piloting.panel import FlightPanel


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
    """

    kind = "flight"

    def __init__(self, title: str, followers: int, open_fleet: Callable[[], Fleet], news: News) -> None:
        self.title = title
        self.loop = FlightLoop(followers, open_fleet, news)
        self.streams = self.loop.streams
        self.panels = (FlightPanel(self.loop),)

    @property
    def busy(self) -> str:
        """Why something else cannot be shown now: while somebody flies; else empty."""
        here = self.loop.helm.look()
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
    from matchset.app.flight.config import with_uri
    from matchset.app.flight.flight import FlightParameters
    from matchset.app.live.piloting.simulated_fleet import SimulatedFleet

    parameters = with_uri(uri, FlightParameters())
    return FlightFeed(uri, parameters.world.vehicles - 1, lambda: SimulatedFleet(parameters), news)
