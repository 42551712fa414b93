"""The radio to one simulated vehicle, with the failsafe of the real transmitter: `SimulatedLink`."""

import math
from typing import TYPE_CHECKING

import numpy as np

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.link import Link, LinkStatus, State
from matchset.sim.on_board.radio import quantized

if TYPE_CHECKING:
    from matchset.links.simulated import SimulatedChain

SCHEME = "sim://"
LANDING_RATE = 30  # format: commands a second while it lands
NEUTRAL = 0.104  # format: s without a command after which the firmware makes the sticks neutral: 26 ticks of 4 ms


class SimulatedLink(Link):
    """The radio to one simulated vehicle; implements `matchset.links.link.Link`.

    Like the firmware it disarms when it has heard nothing for `VehicleParameters.failsafe`, and stays so until `arm`.
    Unlike there, the time begins with the first command after `arm`: before it the simulated time stands still, or
    jumps by the latency of the first picture.

    Parameters
    ----------
    chain : SimulatedChain
    who : int
        Which follower, from 0.

    Attributes
    ----------
    uri : str
    chain : SimulatedChain
    """

    def __init__(self, chain: "SimulatedChain", who: int) -> None:
        self.uri = f"{SCHEME}chain#{who + 1}"
        self.chain, self._who = chain, who
        self._losses = np.random.default_rng((chain.parameters.seed, 0x1057, who))
        self._state: State = "locked"
        self._heard = math.inf  # when a command was last heard, s
        self._open, self._cut, self._sent = True, False, Command()

    def arm(self) -> None:
        """Enable the throttle."""
        self._check()
        self._state, self._heard, self._cut = "armed", math.inf, False

    def send(self, command: Command) -> Command:
        """Send a command; returns what the vehicle receives, all zero once the transmitter has refused."""
        self._check()
        self._pass()
        command, parameters = command if self._armed else Command(), self.chain.parameters
        if 0.0 <= self.chain.now() - parameters.silent < parameters.silent_for:
            self._sent = quantized(command, parameters.vehicle.stick_levels)
        else:
            self._sent = self._transmit(command)
            self._heard = self.chain.now()
            self._state = "armed" if self._armed else self._state
        return self._sent

    def _transmit(self, command: Command) -> Command:
        """Send by radio, which loses some; the transmitter does not notice."""
        share, parameters = self.chain.parameters.conditions.commands_lost, self.chain.parameters
        if share > 0.0 and self._losses.random() < share:
            return quantized(command, parameters.vehicle.stick_levels)
        return self.chain.world.send(self._who, command)

    def status(self) -> LinkStatus:
        """Return the state, with crashes as warnings."""
        self._check()
        self._pass()
        fallen = [what for _, who, what in self.chain.world.crashes if who == self._who]
        return LinkStatus(self._state, "simulated", 0, max(self._age, 0.0), tuple(fallen))

    def land(self, duration: float = 1.5) -> None:
        """Lower the throttle to zero over so many seconds of simulated time, then disarm."""
        self._check()
        self._pass()
        steps = max(round(duration * LANDING_RATE), 1) if self._armed else 0
        for k in range(1, steps + 1):
            command = Command(throttle=self._sent.throttle * (1.0 - k / steps))
            self.chain.world.send(self._who, command, after=duration * k / steps)
        self._state, self._sent = "locked", Command()

    def cut(self) -> None:
        """Disarm; the next command is the first that stops the motors."""
        self._cut = True

    def close(self) -> None:
        """Land and close the link."""
        if self._open:
            self.land()
            self._open = False

    @property
    def _armed(self) -> bool:
        return self._state in ("armed", "holding")

    @property
    def _age(self) -> float:
        """Age of the last command that was heard, s; -inf before the first."""
        return self.chain.now() - self._heard

    def _pass(self) -> None:
        """Let the transmitter's failsafe act."""
        if self._cut:
            self._state = "locked"
        elif self._armed and self._age >= self.chain.parameters.vehicle.failsafe:
            self._state = "failsafe"
        elif self._state == "armed" and self._age >= NEUTRAL:
            self._state = "holding"

    def _check(self) -> None:
        if not self._open:
            raise LinkError(f"{self.uri} is closed")
