"""Tells other computers what this one sees, and what they see: `Share`, over Zenoh."""

import secrets
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from matchset.image.errors import LinkError
from matchset.media.closing import Closing
from matchset.numeric.arguments import check_kind
from matchset.numeric.copies import NotCopied
from matchset.numeric.words import one_line
from matchset.sharing.clock import Clock, PictureAges
from matchset.sharing.clock_offset import ExchangeParameters
from matchset.sharing.connection import DISCOVERIES, Connection, Discovery, zenoh_settings
from matchset.sharing.inbox import Inbox, InboxParameters, Waiting
from matchset.sharing.lines import LineParameters, Lines
from matchset.sharing.messages import (
    ENCODING,
    FORMAT,
    MOST_BYTES,
    MOST_TARGETS,
    ClockMessage,
    ForeignMessageError,
    OffsetMessage,
    TargetsMessage,
    read_clock,
    read_targets,
    written,
)
from matchset.sharing.names import checked_key, checked_name, is_name
from matchset.sharing.partner import Partner, PartnerParameters, PartnerState
from matchset.sharing.ros2.ros_sender import ROUTER, RosSender
from matchset.sharing.sent_targets import Named, sent_targets, target_message
from matchset.sharing.shared_target import AgeParameters, SharedTarget

DEFAULT_KEY = "matchset"
JOIN = 5.0  # format: s, in which the thread that compares clocks must have ended


class ShareParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How is shared.

    Parameters
    ----------
    ages : AgeParameters
    clock : ExchangeParameters
    partner : PartnerParameters
    inbox : InboxParameters
    lines : LineParameters
    look : float
        Time between two looks whether a partner is silent, or one whose clock is not known has come, s. Chosen by hand:
        a quarter of `PartnerParameters.silence`.
    """

    ages: AgeParameters = AgeParameters()
    clock: ExchangeParameters = ExchangeParameters()
    partner: PartnerParameters = PartnerParameters()
    inbox: InboxParameters = InboxParameters()
    lines: LineParameters = LineParameters()
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
    clock : Clock, optional
        The clock of the messages, and that of pictures.

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
        clock: Clock | None = None,
    ) -> None:
        """Nine parameters: who, under which key, four of the network, ROS, the numbers, and by which clock."""
        self.name, self.key, self.run = checked_name(name), checked_key(key), secrets.randbits(62)
        self.parameters = parameters or ShareParameters()
        self.clock = clock or Clock()
        self._ages, self._asleep = PictureAges(self.clock), self.clock.asleep
        self._lock, self._ends, self._arrived = threading.RLock(), threading.Event(), threading.Event()
        self._partners: dict[str, Partner] = {}
        self._inbox, self._lines = Inbox(self.parameters.inbox), Lines(self.parameters.lines)
        self._number, self._told_dropped = 0, 0
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
            What was taken before this computer slept is as old as it is, whichever clock that is.

        Raises
        ------
        ValueError, TypeError
            If that cannot be shared: too many, a name too long, a number that is not finite. The network raises none.
        """
        targets = sent_targets(found)
        with self._lock:
            sent = self._now()
            ages = self._ages.of(targets, time, now)
            run, number, self._number = self.run, self._number, self._number + 1
        message = TargetsMessage(
            format=FORMAT,
            name=self.name,
            run=run,
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
                self._ros.send(targets, ages, sent)
        except LinkError as error:
            with self._lock:
                self._lines.say_once("ended", f"{self.name}: {error}")

    def others(self) -> list[SharedTarget]:
        """Return the targets of all partners, by partner and in its order, as they are known now.

        What is too old, or of a time that is not known, is false in a condition and has no pose.
        """
        with self._lock:
            now, ahead = self._read(), self.clock.ahead
            ages = self.parameters.ages
            return [each for _, partner in sorted(self._partners.items()) for each in partner.targets(now, ages, ahead)]

    def wait(self, timeout: float) -> bool:
        """Wait until something of a partner has come since the last call, at most so long, s; whether it has."""
        came = self._arrived.wait(timeout)
        self._arrived.clear()
        return came

    def partners(self) -> list[PartnerState]:
        """Return how it stands with each partner, by name."""
        with self._lock:
            now = self._read()
            return [partner.state(now) for _, partner in sorted(self._partners.items())]

    def news(self) -> list[str]:
        """Return what has happened since the last call, a line each: who came, went, is silent or cannot be read.

        Of what is too much (`LineParameters`) the number is told.
        """
        with self._lock:
            return self._lines.take(self._read())

    def close(self) -> None:
        """Share nothing more; partners see that this one is gone."""
        self._ends.set()
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
        self.connection.listen(f"{key}/targets/*", self._take, MOST_BYTES)
        self.connection.watch(f"{key}/alive/*", self._see)
        self.connection.appear(f"{key}/alive/{name}")

    def _tell_time(self) -> bytes:
        received, run = self.clock.now(), self.run
        answered, wall = self.clock.now(), time.time()
        return written(
            ClockMessage(format=FORMAT, name=self.name, run=run, received=received, answered=answered, wall=wall)
        )

    def _take(self, key: str, data: bytes | None) -> None:
        """Keep what came under a key until somebody looks; called by a thread of the network, which must not wait."""
        name = key.rpartition("/")[2]
        partner = self._partners.get(name)
        if self._inbox.put(name, data, self.clock.now(), partner is not None and partner.here):
            self._arrived.set()

    def _see(self, key: str, there: bool) -> None:
        """Keep who appeared or vanished until somebody looks; called by a thread of the network."""
        name = key.rpartition("/")[2]
        if name != self.name and is_name(name):
            self._inbox.see(name, there, name in self._partners)

    def _now(self) -> float:
        """Return the time on the clock of the messages, s. Who has slept begins anew: it may be a second off then."""
        slept = self.clock.asleep - self._asleep
        now = self.clock.now()
        if slept > 0.0:
            self._asleep, self.run = self._asleep + slept, secrets.randbits(62)
            for partner in self._partners.values():
                partner.woken(self.run)
            words = f"this computer slept for {slept:.1f} s: the clocks of all are measured anew"
            self._say(self.name, [f"{self.name}: {words}"])
        return now

    def _read(self) -> float:
        """Read what has come, as much as one look may; returns the time, s."""
        changes = self._inbox.changes()
        for name in changes.vanished:
            if name in self._partners:
                self._say(name, self._partners[name].leave())
        for name in changes.appeared:
            partner = self._partner(name)
            if partner is not None:
                self._say(name, partner.come())
        for each in self._inbox.take():
            self._read_one(each)
        now, dropped = self._now(), self._inbox.dropped
        if dropped > 10 * self._told_dropped:
            self._told_dropped = dropped
            self._say(self.name, [f"{self.name}: {dropped} messages of too many senders were left out so far"])
        return now

    def _read_one(self, waiting: Waiting) -> None:
        name = waiting.name
        if name == self.name:
            words = "another computer shares under this name, too: nobody can tell the two apart"
            self._lines.say_once("name", f"{name}: {words}")
        partner = self._partner(name)
        if partner is None:
            return
        try:
            message = read_targets(waiting.data)
        except ForeignMessageError as error:
            self._say(name, partner.once("foreign", f"{error}; left out"))
            return
        if self._has_room(partner, len(message.targets)):
            self._say(name, partner.take(message, waiting.time, waiting.messages))
        else:
            most = self.parameters.inbox.targets
            self._lines.say_once("targets", f"{name}: left out, {most} targets of partners are kept at most")

    def _has_room(self, partner: Partner, count: int) -> bool:
        """Whether so many targets of a partner can be kept; those of partners that are gone make room."""
        most = self.parameters.inbox.targets - count
        others = [each for each in self._partners.values() if each is not partner]
        for gone in [each for each in others if not each.here]:
            if sum(each.count for each in others) > most:
                gone.forget()
        return sum(each.count for each in others) <= most

    def _partner(self, name: str) -> Partner | None:
        """Return a partner, a new one if there is room; None for this computer's own name."""
        if name == self.name:
            return None
        if name not in self._partners:
            if not is_name(name):
                self._lines.say_once("misnamed", f"{name!r:.80}: left out, that is no name")
                return None
            most = self.parameters.inbox.partners
            if len(self._partners) >= most:
                gone = [each for each, partner in self._partners.items() if not partner.here]
                if not gone:
                    self._lines.say_once("many", f"{name}: left out, {most} partners are heard at most")
                    return None
                del self._partners[gone[0]]
            clock, silence = self.parameters.clock, self.parameters.partner
            self._partners[name] = Partner(name, (self.name, self.run), clock, silence)
            if self._inbox.is_present(name):  # also one that came when there was no room
                self._say(name, self._partners[name].come())
        return self._partners[name]

    def _say(self, about: str, lines: list[str]) -> None:
        self._lines.say(about, lines, self.clock.now())

    def _offsets(self, now: float) -> list[OffsetMessage]:
        """How the clocks of all partners stand, for those who could not measure it."""
        with self._lock:
            known = [(each, each.offset.at(now)) for each in self._partners.values() if each.here]
        return [
            OffsetMessage(partner=each.name, run=each.run, offset=at.seconds, uncertainty=at.uncertainty)
            for each, at in known[:MOST_TARGETS]
            if at is not None and each.run is not None
        ]

    def _compare_clocks(self) -> None:
        """Compare the clock of each partner with the own one, again and again; the thread's work."""
        due: dict[str, float] = {}
        while not self._ends.wait(self.parameters.look):
            with self._lock:
                now = self._read()
                for partner in self._partners.values():
                    self._say(partner.name, partner.look(now))
                waiting = [(each, each.offset.at(now) is None) for each in self._partners.values() if each.here]
            if self._ros is not None:
                self._ros.forget(now)
            for partner, unknown in sorted(waiting, key=lambda each: due.get(each[0].name, 0.0)):
                if self.clock.now() - now > self.parameters.clock.interval:
                    break  # others wait for their messages to be read; the rest comes first in the next round
                if now >= due.get(partner.name, now) or unknown:
                    due[partner.name] = now + self.parameters.clock.interval
                    self._compare(partner)
            due = {name: each for name, each in due.items() if name in self._partners}

    def _compare(self, partner: Partner) -> None:
        clock = self.parameters.clock
        for _ in range(clock.exchanges):
            asked = self.clock.now()
            ended = self._ends.is_set()
            data = None if ended else self.connection.ask(f"{self.key}/clock/{partner.name}", clock.patience)
            returned = self.clock.now()
            if data is None:
                return
            with self._lock:
                try:
                    self._say(partner.name, partner.compare(asked, read_clock(data), returned, time.time()))
                except ForeignMessageError as error:
                    self._say(partner.name, partner.once("foreign", f"{error}; left out"))


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
