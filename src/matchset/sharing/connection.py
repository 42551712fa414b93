"""The network: a session of Zenoh, `Connection`; the only file that imports it.

Nothing listens beyond this computer unless that is asked for: `zenoh_settings`.
"""

import contextlib
import json
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from matchset.image.errors import LinkError
from matchset.media.closing import Closing, close_all
from matchset.numeric.copies import NotCopied
from matchset.numeric.imports import advice

Discovery = Literal["loopback", "network", "off"]
DISCOVERIES: tuple[Discovery, ...] = ("loopback", "network", "off")
MEETING_PORT = 17_446  # format: TCP port of 127.0.0.1 on which programs of one computer find each other
HERE, EVERYWHERE = "tcp/127.0.0.1", "tcp/0.0.0.0"
RETRY = {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2}  # format: ms, of Zenoh
FOREVER_MS = -1  # format: of Zenoh
LEASE_MS = 3000  # format: of Zenoh: without a sign of life for so long a connection is closed

LONGEST_BYTES = 131_072  # format: of a message from another computer that is put together from parts; 1 GB is Zenoh's

Take = Callable[[str, bytes | None], None]
Settings = dict[str, Any]


def zenoh_settings(discovery: Discovery, listen: Sequence[str], connect: Sequence[str]) -> Settings:
    """Return the settings of a session, by the names of Zenoh's configuration.

    Parameters
    ----------
    discovery : str
        "loopback": programs of this computer meet at a port of 127.0.0.1: whoever comes first listens there, all others
        go on trying to connect to it, and who comes after it has ended takes its place. "network": by multicast, on all
        networks of this computer. "off": only the endpoints.
    listen, connect : sequence of str
        More endpoints, in Zenoh's words: ``tcp/192.168.1.5:7447``.
    """
    here, there = list(listen), list(connect)
    if discovery == "loopback":
        here += [f"{HERE}:0", f"{HERE}:{MEETING_PORT}"]
        there += [f"{HERE}:{MEETING_PORT}"]
    elif discovery == "network" and not here:
        here = [f"{EVERYWHERE}:0"]
    return {
        "mode": "peer",
        "listen/endpoints": here,
        "listen/exit_on_failure": discovery != "loopback",
        "listen/timeout_ms": 0,  # a session that goes on trying takes ten seconds to close
        "connect/endpoints": there,
        "connect/exit_on_failure": False,
        "connect/timeout_ms": FOREVER_MS,
        "connect/retry": RETRY,
        "scouting/multicast/enabled": discovery == "network",
        "transport/link/tx/lease": LEASE_MS,
        "transport/link/rx/max_message_size": LONGEST_BYTES,
    }


class Connection(NotCopied, Closing):
    """A session of Zenoh. Callbacks come from its threads, one after the other.

    Parameters
    ----------
    settings : mapping of str to Any
        Names and values of Zenoh's configuration.
    file : Path or None
        A configuration of Zenoh, which the settings change.

    Raises
    ------
    ValueError
        If a setting or the file is none of Zenoh's.
    LinkError
        If Zenoh is not installed, or an endpoint cannot be used.
    """

    def __init__(self, settings: Mapping[str, Any], file: Path | None = None) -> None:
        try:
            import zenoh
        except ImportError:
            raise LinkError(f"sharing needs eclipse-zenoh: {advice('net')}") from None
        self._zenoh: Any = zenoh
        config = self._config(settings, file)
        try:
            self._session: Any = zenoh.open(config)
        except zenoh.ZError as error:
            raise LinkError(f"sharing cannot begin: {_words(error)}") from None
        self._lock, self._declared = threading.Lock(), list[tuple[str, Any]]()

    @property
    def identity(self) -> str:
        """What Zenoh calls this session, hexadecimal."""
        return str(self._session.zid())

    def publisher(self, key: str, encoding: str) -> Callable[[bytes, bytes | None], None]:
        """Return what sends bytes, and bytes attached to them, to all who listen to a key.

        It never waits for the network: what does not fit any more is dropped. It raises `LinkError` once the session is
        closed.
        """
        zenoh = self._zenoh
        publisher = self._keep(
            self._session.declare_publisher,
            key,
            encoding=encoding,
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.REAL_TIME,
            express=True,  # sent at once, not with what comes next
        )

        def send(payload: bytes, attachment: bytes | None) -> None:
            try:
                publisher.put(payload, attachment=attachment)
            except zenoh.ZError as error:
                raise LinkError(f"nothing is shared any more: {_words(error)}") from None

        return send

    def listen(self, key: str, take: Take, most: int = LONGEST_BYTES) -> None:
        """Hand what others send to a key, with the key of each, to `take`; None in place of more bytes than `most`."""

        def taken(sample: Any) -> None:
            if sample.kind == self._zenoh.SampleKind.PUT:
                take(str(sample.key_expr), None if len(sample.payload) > most else sample.payload.to_bytes())

        remote = self._zenoh.Locality.REMOTE
        self._keep(self._session.declare_subscriber, key, taken, allowed_origin=remote)

    def answer(self, key: str, answer: Callable[[], bytes]) -> None:
        """Answer whoever asks for a key."""

        def asked(query: Any) -> None:
            with query:
                query.reply(key, answer())

        self._keep(self._session.declare_queryable, key, asked, allowed_origin=self._zenoh.Locality.REMOTE)

    def ask(self, key: str, patience: float) -> bytes | None:
        """Ask for a key, and wait for the answer, at most so long, s; None if none came."""
        try:
            for reply in self._session.get(key, timeout=patience, priority=self._zenoh.Priority.REAL_TIME):
                if reply.ok is not None:
                    payload: bytes = reply.ok.payload.to_bytes()
                    return payload
        except self._zenoh.ZError:
            return None
        return None

    def appear(self, key: str) -> None:
        """Tell a key to all who watch, as long as this program can be reached."""
        self._keep(self._session.liveliness().declare_token, key)

    def watch(self, key: str, seen: Callable[[str, bool], None]) -> None:
        """Hand the keys that others tell to `seen`, and whether they appeared or vanished."""

        def changed(sample: Any) -> None:
            seen(str(sample.key_expr), sample.kind == self._zenoh.SampleKind.PUT)

        self._keep(self._session.liveliness().declare_subscriber, key, changed, history=True)

    def withdraw(self, *keys: str) -> None:
        """Undeclare all that was declared under these keys; those who watched see that it vanished."""
        self._undeclare([each for each in self._declared if each[0] in keys])

    def close(self) -> None:
        """End the session; all who watched see that it vanished."""
        self._undeclare(self._declared, self._session.close)

    def _undeclare(self, ends: Sequence[tuple[str, Any]], *more: Callable[[], None]) -> None:
        with self._lock:
            self._declared = [each for each in self._declared if each not in ends]
        close_all(*(self._ended(end) for end in (*(each.undeclare for _, each in ends), *more)))

    def _keep(self, declare: Callable[..., Any], *values: Any, **named: Any) -> Any:
        try:
            declared = declare(*values, **named)
        except self._zenoh.ZError as error:
            raise ValueError(f"{values[0]!r} cannot be shared under: {_words(error)}") from None
        with self._lock:
            self._declared.append((values[0], declared))
        return declared

    def _ended(self, end: Callable[[], None]) -> Callable[[], None]:
        def call() -> None:
            with contextlib.suppress(self._zenoh.ZError):  # it is closed already
                end()

        return call

    def _config(self, settings: Mapping[str, Any], file: Path | None) -> Any:
        zenoh = self._zenoh
        try:
            config = zenoh.Config() if file is None else zenoh.Config.from_file(str(file))
        except zenoh.ZError as error:
            raise ValueError(f"{file} is no configuration of Zenoh: {_words(error)}") from None
        for name, value in settings.items():
            try:
                config.insert_json5(name, json.dumps(value))
            except (zenoh.ZError, TypeError) as error:
                raise ValueError(f"Zenoh knows no setting {name} = {value!r:.80}: {_words(error)}") from None
        return config


def _words(error: Exception) -> str:
    """Return the first line of an error of Zenoh, without the place in its source."""
    return str(error).partition("\n")[0].partition(" at /")[0]
