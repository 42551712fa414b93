"""The dialog with a Tello: commands and answers at UDP port 8889, states at 8890; `TelloClient`.

Commands are words, answered by ``ok``, ``error`` with or without a reason, or a number; ``rc`` and ``emergency`` are
not answered. Answers are not numbered, so one is asked for at a time.
"""

import errno
import socket
from collections.abc import Callable
from typing import Protocol
from urllib.parse import parse_qsl

import msgspec

from matchset.image.errors import LinkError
from matchset.links.datagrams import LAST_PORT, arrived, quiet
from matchset.links.link import wait_until
from matchset.links.tello.tello_state import TelloState, parse_state
from matchset.numeric.copies import NotCopied

SCHEME = "tello:"
HOST = "192.168.10.1"  # format: of a Tello in its own Wi-Fi
COMMANDS, STATES, VIDEO = 8889, 8890, 11111  # format: UDP ports


class TelloAddress(msgspec.Struct, frozen=True):
    """Where a Tello is.

    Attributes
    ----------
    host : str
    commands, states, video : int
        UDP ports: its own for commands, those of this computer for states and pictures.
    """

    host: str = HOST
    commands: int = COMMANDS
    states: int = STATES
    video: int = VIDEO


def parse_tello(uri: str) -> TelloAddress:
    """Read ``tello:``, ``tello:192.168.1.23`` or ``tello:192.168.1.23?states=8891&video=11112``.

    Raises
    ------
    ValueError
        If it has another form.
    """
    host, _, question = uri.removeprefix(SCHEME).partition("?")
    ports = dict(parse_qsl(question, keep_blank_values=True))
    known = set(TelloAddress.__struct_fields__) - {"host"}
    right = uri.startswith(SCHEME) and ":" not in host and "/" not in host and ports.keys() <= known
    if not right or not all(
        text.isascii() and text.isdecimal() and 0 < int(text) <= LAST_PORT for text in ports.values()
    ):
        raise ValueError(f"a Tello is named like tello:, tello:192.168.1.23 or tello:?states=8891, got {uri!r}")
    return TelloAddress(host or HOST, **{name: int(text) for name, text in ports.items()})


class Sockets(Protocol):
    """The contract of what carries the bytes. All but `close` raise `OSError` when the network is gone."""

    def send(self, data: bytes) -> None:
        """Send a command."""

    def answers(self) -> list[bytes]:
        """Return the answers since the last time; never waits."""

    def states(self) -> list[bytes]:
        """Return the states since the last time; never waits."""

    def close(self) -> None:
        """Close them."""


class UdpSockets(NotCopied):
    """Two UDP sockets; what comes from another address than the Tello's is left out.

    Parameters
    ----------
    address : TelloAddress

    Raises
    ------
    LinkError
        If a port is in use, or there is no such address.
    """

    def __init__(self, address: TelloAddress) -> None:
        self._commands = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._states = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._host = socket.gethostbyname(address.host)
            self._commands.setblocking(False)
            self._states.setblocking(False)
            self._states.bind(("", address.states))
            self._commands.connect((self._host, address.commands))
        except OSError as error:
            self.close()
            in_use = error.errno == errno.EADDRINUSE
            words = f"another program uses port {address.states}" if in_use else error.strerror or str(error)
            raise LinkError(f"cannot reach the Tello {address.host}: {words}") from error

    def send(self, data: bytes) -> None:
        """Send a command."""
        with quiet():
            self._commands.send(data)

    def answers(self) -> list[bytes]:
        """Return the answers since the last time; never waits."""
        return self._from_it(self._commands)

    def states(self) -> list[bytes]:
        """Return the states since the last time; never waits."""
        return self._from_it(self._states)

    def close(self) -> None:
        """Close both."""
        self._commands.close()
        self._states.close()

    def _from_it(self, there: socket.socket) -> list[bytes]:
        return [data for data, sender in arrived(there) if sender[0] == self._host]


class TelloParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Times and limits of the link; all chosen by hand, `tests/links/tello` shows a change.

    Parameters
    ----------
    timeout : float
        Longest time without a state, s; then the link is broken. There are ten a second: shorter detects a fault
        sooner but fails on bad Wi-Fi.
    startup_timeout : float
        How long it may take to answer at first, s.
    answer_timeout : float
        How long any other answer may take, s.
    takeoff_timeout, landing_timeout : float
        How long it may take to take off or to land, s. It answers when it has.
    takeoff_time : float
        How long it takes to take off, about, s: until then a follower learns nothing.
    repeat_period : float
        Time after which a first command that was not answered is sent again, s.
    poll_period : float
        Time between looks for answers while waiting, s.
    hold_time : float
        Time without a command, s, after which its sticks are made neutral: it would fly on by the last ones.
    silence_time : float
        Time without a command, s, after which it is landed. It would do so by itself after 15 s only.
    settle_time : float
        Time after the command to land, s, in which an answer may be that of a command before.
    grounded_time : float
        How long it must be on the floor, s, until it is believed that it has landed by itself.
    floor : float
        Largest distance to what is below it that is the floor, m: it says 0.1 there.
    least_battery : float
        Charge below which it is not armed, 0 ... 1: it refuses itself below 0.1.
    low_battery : float
        Charge below which a warning says so, 0 ... 1.
    cuts : int
        How often the motors are stopped after `cut`, since packets get lost and nothing says that they stand.
    """

    timeout: float = 1.0
    startup_timeout: float = 5.0
    answer_timeout: float = 3.0
    takeoff_timeout: float = 20.0
    landing_timeout: float = 15.0
    takeoff_time: float = 5.0
    repeat_period: float = 1.0
    poll_period: float = 0.01
    hold_time: float = 0.3
    silence_time: float = 2.0
    settle_time: float = 0.5
    grounded_time: float = 1.5
    floor: float = 0.15
    least_battery: float = 0.1
    low_battery: float = 0.2
    cuts: int = 10


class TelloClient:
    """Sends commands and hears answers and states; it knows nothing of sticks.

    Parameters
    ----------
    name : str
        Name of the link in error messages.
    sockets : Sockets
    parameters : TelloParameters
    clock, sleep : callables
        The time, s, and a function that waits.

    Attributes
    ----------
    state : TelloState or None
        The last one.
    strange : int
        Packets that are no state.
    answer : str
        The last answer to the last command that was sent by `say`; empty before it comes.
    broken : bool
        The network is gone or the Tello silent.
    """

    def __init__(
        self,
        name: str,
        sockets: Sockets,
        parameters: TelloParameters,
        clock: Callable[[], float],
        sleep: Callable[[float], None],
    ) -> None:
        self.name, self.parameters = name, parameters
        self.state: TelloState | None = None
        self.strange, self.answer, self.broken = 0, "", False
        self._sockets, self._clock, self._sleep = sockets, clock, sleep
        self._heard_at = clock()

    def find(self, address: TelloAddress) -> None:
        """Begin the dialog: ``command``, then wait for a state.

        Raises
        ------
        LinkError
            If it does not answer, or no state comes.
        """
        p = self.parameters
        said = self._clock()
        self.say("command")

        def repeat() -> None:
            nonlocal said
            if self._clock() - said > p.repeat_period:
                said = self._clock()
                self.say("command")
            self._pause()

        if not wait_until(lambda: bool(self.answer), p.startup_timeout, self._clock, repeat):
            waited = f"(waited {p.startup_timeout:g} s)"
            raise LinkError(f"{self.name}: nobody answers: is this computer in its Wi-Fi? {waited}")
        self._check("command")
        if (address.states, address.video) != (STATES, VIDEO):
            self.ask(f"port {address.states} {address.video}")
        if not wait_until(lambda: self.state is not None, p.answer_timeout, self._clock, self._pause):
            raise LinkError(f"{self.name}: it answers but sends no state to port {address.states}: a firewall?")

    def say(self, words: str) -> None:
        """Send a command whose answer is to come into `answer`.

        Raises
        ------
        LinkError
            If the network is gone.
        """
        self.receive()
        self.answer = ""
        self.send(words)

    def send(self, words: str) -> None:
        """Send a command.

        Raises
        ------
        LinkError
            If the network is gone.
        """
        try:
            self._sockets.send(words.encode())
        except OSError as error:
            raise self._gone(error) from error

    def ask(self, words: str) -> str:
        """Send a command and wait for its answer.

        Raises
        ------
        LinkError
            If it is refused, with the answer, or not answered.
        """
        self.say(words)
        if not wait_until(lambda: bool(self.answer), self.parameters.answer_timeout, self._clock, self._pause):
            raise LinkError(f"{self.name}: {words!r} is not answered")
        self._check(words)
        return self.answer

    def _pause(self) -> None:
        self._sleep(self.parameters.poll_period)
        self.receive()

    def receive(self) -> None:
        """Read what has arrived; never waits.

        Raises
        ------
        LinkError
            If the network is gone.
        """
        try:
            answers, states = self._sockets.answers(), self._sockets.states()
        except OSError as error:
            raise self._gone(error) from error
        for data in answers:
            self.answer = data.decode("utf-8", "replace").strip() or self.answer
        for data in states:
            state = parse_state(data)
            if state is None:
                self.strange += 1
            else:
                self.state, self._heard_at = state, self._clock()

    def check(self) -> TelloState:
        """Receive, and return the last state; never waits.

        Raises
        ------
        LinkError
            If the network is gone or the Tello silent for too long.
        """
        self.receive()
        silence = self._clock() - self._heard_at
        if silence > self.parameters.timeout:
            self.broken = True
            raise LinkError(f"{self.name} has been silent for {silence:.1f} s")
        assert self.state is not None  # `find` waited for it
        return self.state

    def close(self) -> None:
        """Close the sockets."""
        self._sockets.close()

    def _check(self, words: str) -> None:
        if self.answer.lower().startswith(("error", "unknown")):
            raise LinkError(f"{self.name}: {words!r} refused: {self.answer}")

    def _gone(self, error: OSError) -> LinkError:
        self.broken = True
        return LinkError(f"{self.name} has gone (Wi-Fi?): {error.strerror or error}")
