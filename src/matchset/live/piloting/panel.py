"""The panel of a flight: hands what pages ask for to its loop (`FlightPanel`)."""

from matchset.live.feed import Panel
from matchset.live.piloting.flight_loop import FlightLoop
from matchset.live.piloting.messages import MESSAGES, Alive, Arm, Kill, Land, Order
from matchset.live.piloting.state import FlightState


class FlightPanel(Panel):
    """Takes orders.

    Parameters
    ----------
    loop : FlightLoop
    """

    name = "flight"
    messages = MESSAGES

    def __init__(self, loop: FlightLoop) -> None:
        self._loop = loop

    def take(self, message: Order, page: str) -> None:
        """Do what a page asks for.

        Raises
        ------
        ValueError
            If it may not, or it cannot be done now; stopping the motors always can.
        """
        if isinstance(message, Kill):
            self._loop.kill(page or "a program")
        elif isinstance(message, Alive):
            self._loop.alive(page, message.sequence)
        elif isinstance(message, Arm):
            self._loop.arm(page)
        elif isinstance(message, Land):
            self._loop.land(page)
        else:
            self._loop.again()

    def state(self) -> FlightState:
        """Return what there is to say of the flight."""
        return self._loop.state()
