"""Two links to Betaflight: by UDP, as its simulator target wants it, and by CRSF through a module's double."""

from benchmarks.flight.betaflight.world import BetaflightWorld
from matchset.control.command import Command
from matchset.links import crsf_frame as crsf
from matchset.links.crsf import telemetry
from matchset.links.crsf.crsf_link import CrsfLink
from matchset.links.link import Link, LinkStatus

LOW, MIDDLE, HIGH = 988, 1500, 2012  # microseconds, as a receiver has them
ARM_TIME = 0.5  # s for which the arm switch is low, then high without throttle
RECEIVER = 2  # serial port of the receiver
CRSF_SETTINGS = ("set serialrx_provider = CRSF", "serial 1 64 115200 57600 0 115200", "feature TELEMETRY")


class UdpSticks(Link):
    """Sticks by UDP; they act `delay` after they were sent, s."""

    def __init__(self, world: BetaflightWorld, delay: float) -> None:
        self.uri, self._world, self._delay = "udp://betaflight", world, delay
        self._waiting: list[tuple[float, list[int]]] = []
        self._armed = False
        world.hooks.append(self._deliver)

    def arm(self) -> None:
        """Arm."""
        for self._armed in (False, True):
            self.send(Command())
            self._world.pass_time(ARM_TIME)

    def send(self, command: Command) -> Command:
        """Send a command."""
        if not self._armed:
            command = Command()
        half = HIGH - MIDDLE
        sticks = [round(MIDDLE + half * each) for each in (command.roll, command.pitch, command.yaw)]
        throttle = round(LOW + (HIGH - LOW) * command.throttle)
        switches = [HIGH if self._armed else LOW] + [LOW] * 11
        self._waiting.append((self._world.now + self._delay, [*sticks[:2], throttle, sticks[2], *switches]))
        return command

    def status(self) -> LinkStatus:
        """Return the state."""
        return LinkStatus("armed" if self._armed else "locked", "Betaflight by UDP", 0, 0.0)

    def land(self, duration: float = 1.5) -> None:  # noqa: ARG002
        """Disarm: nothing here can be hurt."""
        self.cut()

    def cut(self) -> None:
        """Disarm."""
        self._armed = False
        self.send(Command())

    def close(self) -> None:
        """Disarm."""
        self.cut()

    def _deliver(self) -> None:
        while self._waiting and self._waiting[0][0] <= self._world.now:
            self._world.sitl.sticks(self._waiting.pop(0)[1])


class ModulePort:
    """A port with a module's double: the channels reach Betaflight's receiver port, its telemetry comes back.

    Parameters
    ----------
    world : BetaflightWorld
    delay : float
        From a frame at the module to the receiver, s.
    """

    def __init__(self, world: BetaflightWorld, delay: float) -> None:
        self._world, self._delay = world, delay
        self._parser = crsf.CrsfParser()
        self._waiting: list[tuple[float, bytes]] = []
        self._next, self._sent = 0.0, 0
        world.hooks.append(self._deliver)

    def write(self, data: bytes) -> None:
        """Take frames; only channels go on the air."""
        for kind, payload in self._parser.feed(data):
            if kind == crsf.CHANNELS_PACKED:
                self._waiting.append((self._world.now + self._delay, crsf.frame(kind, payload)))

    def read(self) -> bytes:
        """Return Betaflight's telemetry, and five times a second link statistics and timing."""
        said = self._world.sitl.read(RECEIVER)
        if self._world.now >= self._next:
            self._next = self._world.now + 0.2
            said += crsf.frame(telemetry.LINK, bytes((60, 60, 100, 10, 0, 7, 2, 55, 100, 10)))
            timing = (telemetry.HANDSET, telemetry.MODULE, 0x10)
            said += crsf.frame(telemetry.TIMING, bytes(timing) + (40_000).to_bytes(4, "big") + bytes(4))
        return said

    def close(self) -> None:
        """Do nothing: the world ends the program."""

    def _deliver(self) -> None:
        while self._waiting and self._waiting[0][0] <= self._world.now:
            self._world.sitl.write(RECEIVER, self._waiting.pop(0)[1])


def crsf_link(world: BetaflightWorld, delay: float) -> CrsfLink:
    """Open the link by CRSF; its frames leave in the world's time."""
    world.sitl.read(RECEIVER)
    port = ModulePort(world, delay)
    link = CrsfLink("crsf://betaflight", port, lambda: world.now, world.pass_time, threaded=False)
    world.hooks.append(link.module.turn)
    return link
