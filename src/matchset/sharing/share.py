"""Tells other computers what this one sees, and what they see: `Share`, over Zenoh."""

import secrets
import threading
import time
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from matchset.image.errors import LinkError
from matchset.media.closing import Closing
from matchset.numeric.arguments import check_kind
from matchset.numeric.copies import NotCopied
from matchset.numeric.words import one_line
from matchset.sharing.clock_offset import ExchangeParameters
from matchset.sharing.connection import DISCOVERIES, Connection, Discovery, zenoh_settings
from matchset.sharing.messages import (
    ENCODING,
    FORMAT,
    MOST_TARGETS,
    ClockMessage,
    ForeignMessageError,
    OffsetMessage,
    TargetsMessage,
    read_clock,
    read_targets,
    written,
)
from matchset.sharing.partner import Partner, PartnerParameters, PartnerState
from matchset.sharing.ros2.ros_sender import ROUTER, RosSender
from matchset.sharing.sent_targets import Named, ages_of, sent_targets, target_message
from matchset.sharing.shared_target import AgeParameters, SharedTarget

DEFAULT_KEY = "matchset"
NOT_IN_A_NAME = "/*$?#%"  # format: characters with a meaning in keys of Zenoh and ROS
MOST_LINES = 100  # format: lines that wait to be read
JOIN = 5.0  # format: s, in which the thread that compares clocks must have ended


class ShareParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How is shared.

    Parameters
    ----------
    ages : AgeParameters
    clock : ExchangeParameters
    partner : PartnerParameters
    look : float
        Time between two looks whether a partner is silent, s. Chosen by hand: a quarter of `PartnerParameters.silence`.
    """

    ages: AgeParameters = AgeParameters()
    clock: ExchangeParameters = ExchangeParameters()
    partner: PartnerParameters = PartnerParameters()
    look: float = 0.25


class Share(NotCopied, Closing):
    """Shares targets and poses with other computers. Nothing here waits for another computer, nor is stopped by one.

    Parameters
    ----------
    name : str
        Of this computer, among those that share: 1 to 64 characters, without ``/ * $ ? # %``.
    key : str
        Only those with the same key share: a key of Zenoh, such as ``matchset`` or ``lab/chain``.
    discovery : str or None
        How others are found. "loopback", the default: those on this computer, and nothing else can reach it.
        "network": those on the same network, by multicast. "off": those at the endpoints. None: "loopback", or as
        `config` has it if that is a file.
    listen, connect : sequence of str
        Endpoints, in Zenoh's words: ``tcp/192.168.1.5:7447``, ``tls/host:7447``.
    config : Path, str, mapping or None
        A configuration file of Zenoh, or names and values of its settings: user and password, certificates.
    ros_domain : int or None
        Given, all is sent as messages of ROS 2, too, in this ROS_DOMAIN_ID: see `RosSender`. Without an endpoint to
        connect to, or a configuration file, that is the router of rmw_zenoh on this computer.
    parameters : ShareParameters, optional

    Raises
    ------
    ValueError
        If a name, key or setting cannot be.
    LinkError
        If Zenoh is not installed, or an endpoint cannot be used.
    """

    def __init__(
        self,
        name: str,
        *,
        key: str = DEFAULT_KEY,
        discovery: Discovery | None = None,
        listen: Sequence[str] = (),
        connect: Sequence[str] = (),
        config: Path | str | Mapping[str, Any] | None = None,
        ros_domain: int | None = None,
        parameters: ShareParameters | None = None,
    ) -> None:
        """Eight parameters: who, under which key, four of the network, ROS, and the numbers."""
        self.name, self.key, self.run = checked_name(name), checked_key(key), secrets.randbits(62)
        self.parameters = parameters or ShareParameters()
        self._lock, self._ends = threading.RLock(), False
        self._wake, self._arrived = threading.Event(), threading.Event()
        self._partners: dict[str, Partner] = {}
        self._lines: deque[str] = deque(maxlen=MOST_LINES)
        self._number, self._failed, self._said = 0, False, set[str]()
        if ros_domain is not None and not connect and not isinstance(config, str | Path):
            connect = [ROUTER]
        self.connection = _opened(discovery, listen, connect, config)
        try:
            self._declare()
            self._ros = None if ros_domain is None else RosSender(self.connection, name, ros_domain)
        except BaseException:
            self.connection.close()
            raise
        self._thread = threading.Thread(target=self._compare_clocks, name="matchset share", daemon=True)
        self._thread.start()

    def publish(self, found: Named, time: float | Mapping[str, float], now: float | None = None) -> None:
        """Tell all partners what was found in a picture; it takes the place of what was told before.

        Parameters
        ----------
        found : Track, Pose, Lost, mapping of str to these, or iterable of Target or Neighbor
            One target; several by their names, each a track, a pose, or both in a tuple; or what `MultiTracker` and
            `Neighbors` answer.
        time : float or mapping of str to float
            When the picture was taken, s: `Frame.time`; by the names of targets if they were seen by several cameras.
        now : float, optional
            What the clock of `time` shows now; `time.monotonic`, on which live cameras have their times, if not given.

        Raises
        ------
        ValueError, TypeError
            If that cannot be shared: too many, a name too long, a number that is not finite. The network raises none.
        """
        targets = sent_targets(found)
        with self._lock:
            number, self._number = self._number, self._number + 1
        sent = monotonic()
        ages = ages_of(targets, time, sent if now is None else now)
        message = TargetsMessage(
            format=FORMAT,
            name=self.name,
            run=self.run,
            number=number,
            sent=sent,
            offsets=self._offsets(sent),
            targets=[target_message(each, sent - age) for each, age in zip(targets, ages, strict=True)],
        )
        data = written(message)
        try:
            read_targets(data)  # what others could not read is not sent
        except ForeignMessageError as error:
            raise ValueError(f"this cannot be shared: it {error}") from None
        try:
            self._send(data, None)
            if self._ros is not None:
                self._ros.send(targets, ages)
        except LinkError as error:
            if not self._failed:
                self._failed = True
                self._say([f"{self.name}: {error}"])

    def others(self) -> list[SharedTarget]:
        """Return the targets of all partners, by partner and in its order, as they are known now.

        What is too old, or of a time that is not known, is false in a condition and has no pose.
        """
        with self._lock:
            now = monotonic()
            ages = self.parameters.ages
            return [each for _, partner in sorted(self._partners.items()) for each in partner.targets(now, ages)]

    def wait(self, timeout: float) -> bool:
        """Wait until something of a partner has come since the last call, at most so long, s; whether it has."""
        came = self._arrived.wait(timeout)
        self._arrived.clear()
        return came

    def partners(self) -> list[PartnerState]:
        """Return how it stands with each partner, by name."""
        with self._lock:
            now = monotonic()
            return [partner.state(now) for _, partner in sorted(self._partners.items())]

    def news(self) -> list[str]:
        """Return what has happened since the last call, a line each: who came, went, is silent or cannot be read."""
        with self._lock:
            lines = list(self._lines)
            self._lines.clear()
        return lines

    def close(self) -> None:
        """Share nothing more; partners see that this one is gone."""
        self._ends = True
        self._wake.set()
        self._thread.join(JOIN)
        self.connection.close()

    @one_line
    def __repr__(self) -> str:
        there = ", ".join(sorted(self._partners)) or "nobody yet"
        return f"Share({self.name!r}, key {self.key!r}, with {there})"

    def _declare(self) -> None:
        key, name = self.key, self.name
        self._send = self.connection.publisher(f"{key}/targets/{name}", ENCODING)
        self.connection.answer(f"{key}/clock/{name}", self._tell_time)
        self.connection.listen(f"{key}/targets/*", self._take)
        self.connection.watch(f"{key}/alive/*", self._see)
        self.connection.appear(f"{key}/alive/{name}")

    def _tell_time(self) -> bytes:
        received = monotonic()
        return written(
            ClockMessage(
                format=FORMAT, name=self.name, run=self.run, received=received, answered=monotonic(), wall=time.time()
            )
        )

    def _take(self, key: str, data: bytes) -> None:
        """Take what came under a key; called by a thread of the network."""
        now, name = monotonic(), key.rpartition("/")[2]
        with self._lock:
            if name == self.name:
                self._say_once(
                    "name", f"{name}: another computer shares under this name, too: nobody can tell the two apart"
                )
            partner = self._partner(name)
            if partner is None:
                return
            try:
                message = read_targets(data)
            except ForeignMessageError as error:
                self._say(partner.once("foreign", f"{error}; left out"))
                return
            new = partner.run != message.run
            self._say(partner.take(message, now))
        self._arrived.set()
        if new:
            self._wake.set()

    def _see(self, key: str, there: bool) -> None:
        """Somebody appeared or vanished; called by a thread of the network."""
        name = key.rpartition("/")[2]
        if name == self.name:
            return
        with self._lock:
            partner = self._partner(name)
            if partner is not None:
                self._say(partner.come() if there else partner.leave())
        self._wake.set()

    def _partner(self, name: str) -> Partner | None:
        """Return a partner, a new one if there is room; None for this computer's own name."""
        if name == self.name:
            return None
        if name not in self._partners:
            if not is_name(name):
                self._say_once("misnamed", f"{name!r:.80}: left out, that is no name")
                return None
            if len(self._partners) >= MOST_TARGETS:
                gone = [each for each, partner in self._partners.items() if not partner.here]
                if not gone:
                    self._say_once("many", f"{name}: left out, {MOST_TARGETS} partners are heard at most")
                    return None
                del self._partners[gone[0]]
            clock, silence = self.parameters.clock, self.parameters.partner
            self._partners[name] = Partner(name, (self.name, self.run), clock, silence)
        return self._partners[name]

    def _say(self, lines: list[str]) -> None:
        self._lines.extend(lines)

    def _say_once(self, kind: str, line: str) -> None:
        """Say a line unless one of this kind was said before."""
        if kind not in self._said:
            self._said.add(kind)
            self._say([line])

    def _offsets(self, now: float) -> list[OffsetMessage]:
        """How the clocks of all partners stand, for those who could not measure it."""
        with self._lock:
            known = [(each, each.offset.at(now)) for each in self._partners.values() if each.here]
        return [
            OffsetMessage(partner=each.name, run=each.run, offset=at.seconds, uncertainty=at.uncertainty)
            for each, at in known
            if at is not None and each.run is not None
        ]

    def _compare_clocks(self) -> None:
        """Compare the clock of each partner with the own one, again and again; the thread's work."""
        due: dict[str, float] = {}
        while not self._ends:
            self._wake.wait(self.parameters.look)
            self._wake.clear()
            with self._lock:
                now = monotonic()
                for partner in self._partners.values():
                    self._say(partner.look(now))
                waiting = [(each, each.offset.at(now) is None) for each in self._partners.values() if each.here]
            for partner, unknown in waiting:
                if now >= due.get(partner.name, now) or unknown:
                    due[partner.name] = now + self.parameters.clock.interval
                    self._compare(partner)
            due = {name: each for name, each in due.items() if name in self._partners}

    def _compare(self, partner: Partner) -> None:
        clock = self.parameters.clock
        for _ in range(clock.exchanges):
            asked = monotonic()
            data = None if self._ends else self.connection.ask(f"{self.key}/clock/{partner.name}", clock.patience)
            returned = monotonic()
            if data is None:
                return
            with self._lock:
                try:
                    self._say(partner.compare(asked, read_clock(data), returned, time.time()))
                except ForeignMessageError as error:
                    self._say(partner.once("foreign", f"{error}; left out"))


def is_name(text: str) -> bool:
    """Whether a partner may be called so; what else comes under a key is not shown to anybody."""
    try:
        return bool(checked_name(text))
    except ValueError:
        return False


def monotonic() -> float:
    """Return the time on the clock of the messages, s."""
    return time.monotonic()


def checked_name(name: str) -> str:
    """Return a name under which is shared.

    Raises
    ------
    ValueError
        If it cannot be one.
    """
    check_kind("the name to share under", name, str)
    if not 0 < len(name) <= 64 or set(name) & set(NOT_IN_A_NAME) or not name.isprintable() or " " in name:
        wrong = f"1 to 64 characters without spaces and {' '.join(NOT_IN_A_NAME)}"
        raise ValueError(f"the name to share under has {wrong}, got {name!r:.80}")
    return name


def checked_key(key: str) -> str:
    """Return a key under which is shared.

    Raises
    ------
    ValueError
        If it cannot be one.
    """
    check_kind("the key to share under", key, str)
    if not all(key.split("/")) or set(key) & set("*$?#@") or not key.isprintable():
        raise ValueError(f"the key to share under is like matchset or lab/chain, without * $ ? # @, got {key!r:.80}")
    return key


def _opened(
    discovery: Discovery | None,
    listen: Sequence[str],
    connect: Sequence[str],
    config: Path | str | Mapping[str, Any] | None,
) -> Connection:
    if discovery is not None and discovery not in DISCOVERIES:
        raise ValueError(f"discovery is {', '.join(DISCOVERIES)}, got {discovery!r}")
    for each in (listen, connect):
        check_kind("endpoints", each, (list, tuple), "a list of them")
    if isinstance(config, str | Path):
        endpoints = {"listen/endpoints": list(listen), "connect/endpoints": list(connect)}
        named = {name: each for name, each in endpoints.items() if each}
        return Connection(named if discovery is None else zenoh_settings(discovery, listen, connect), Path(config))
    return Connection(zenoh_settings(discovery or "loopback", listen, connect) | dict(config or {}))
