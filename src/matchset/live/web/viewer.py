"""One page that looks: sends it the newest pictures, takes what it says (`Viewer`); all of them: `Viewers`."""

import asyncio
import contextlib
import itertools
import math
import time
from typing import NamedTuple, Protocol

import msgspec
from starlette.websockets import WebSocket, WebSocketDisconnect

from matchset.live.feed import StreamPicture
from matchset.live.session import Session
from matchset.live.web.session_report import SESSION_PERIOD, SessionReport
from matchset.live.wire.flow import Flow
from matchset.live.wire.messages import Ack, PageMessageReader
from matchset.live.wire.packet import FEEDS, Packet, pack
from matchset.live.wire.pictures import PictureEncoder
from matchset.live.wire.state import written

TOO_MANY = 4429  # format: the code with which a session is closed that is one too many
FULL = "as many pages as may look already do"
NONSENSE = 4400  # format: the code with which a session is closed that says nonsense
LIFE_PERIOD = 1.0  # format: s; a page that hears nothing for two of them connects anew


class ViewerContext(NamedTuple):
    """What all viewers share.

    Attributes
    ----------
    session : Session
    pictures : PictureEncoder
    reader : PageMessageReader
    report : SessionReport
        Of that session.
    """

    session: Session
    pictures: PictureEncoder
    reader: PageMessageReader
    report: SessionReport


class _Sending:
    """What one viewer was sent of one stream."""

    def __init__(self) -> None:
        self.flow, self.age = Flow(), -1.0
        self.offered: StreamPicture | None = None
        self.left_out: tuple[StreamPicture, float] | None = None
        self.captured: dict[int, float] = {}

    def acknowledge(self, sequence: int) -> bool:
        now = time.monotonic()
        if self.flow.acknowledge(sequence, now) is None:
            return False
        self.age = now - self.captured[sequence]
        self.captured = {number: when for number, when in self.captured.items() if number > sequence}
        return True


class Viewer:
    """A session of a page.

    Parameters
    ----------
    socket : WebSocket
        Accepted.
    desk : ViewerContext

    Attributes
    ----------
    name : str
        Unlike that of every other viewer.
    """

    _names = itertools.count(1)
    is_page = True

    def __init__(self, socket: WebSocket, desk: ViewerContext) -> None:
        self.name = f"page {next(self._names)}"
        self._socket, self._desk, self._news = socket, desk, asyncio.Event()
        self._streams: dict[int, _Sending] = {}
        self._feed = 1
        self._lock = asyncio.Lock()

    def offer(self, stream: int, seen: StreamPicture) -> None:
        """Tell that there is a new picture."""
        sending = self._streams.setdefault(stream, _Sending())
        if sending.flow.offer(seen.state.sequence):
            sending.offered, sending.left_out = seen, None
            self._news.set()
        else:
            sending.left_out = seen, time.monotonic()

    def _settle(self, now: float) -> None:
        """Show what a slow link left out, where nothing came after it: the picture at which a video stands."""
        for sending in self._streams.values():
            if (
                sending.left_out is not None
                and now - sending.left_out[1] > 2.0 * SESSION_PERIOD
                and sending.flow.settle()
            ):
                sending.offered, sending.left_out = sending.left_out[0], None
                self._news.set()

    def restart(self) -> None:
        """Forget what was sent: other streams are shown from here on."""
        self._streams.clear()
        self._feed = self._feed % (FEEDS - 1) + 1

    def end(self) -> None:
        """Do nothing: the server closes the socket of a page."""

    async def serve(self) -> None:
        """Send and receive until the page goes."""
        tasks = [asyncio.create_task(self._send()), asyncio.create_task(self._tell())]
        try:
            await self._receive()
        except WebSocketDisconnect:
            pass
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def _send(self) -> None:
        while True:
            await self._news.wait()
            self._news.clear()
            for stream, sending in list(self._streams.items()):
                await self._send_picture(stream, sending)

    async def _send_picture(self, stream: int, sending: _Sending) -> None:
        sequence, seen = sending.flow.take(time.monotonic()), sending.offered
        if sequence is None or seen is None or self._streams.get(stream) is not sending:
            return
        feed = self._feed
        sending.captured[sequence] = seen.state.time
        image = b""
        if seen.frame is not None:
            image = await self._desk.pictures.picture((stream, sequence), seen.frame.image, sending.flow.size)
        if feed == self._feed:  # nothing else was chosen while the picture was made
            state = written(seen.state)
            await self._write(Packet(sequence, seen.state.time, sending.age, state, image, stream, feed=feed))

    async def _tell(self) -> None:
        """Send the state of the session whenever it has changed, and as a sign of life."""
        told, when, report = 0, -math.inf, self._desk.report
        while True:
            state, now = report.state(), time.monotonic()
            if report.version != told or now - when >= LIFE_PERIOD:
                told, when = report.version, now
                data = written(msgspec.structs.replace(state, page=self.name))
                await self._write(Packet(0, time.monotonic(), -1.0, data, session=True))
            self._settle(now)
            await asyncio.sleep(report.wait())

    async def _write(self, packet: Packet) -> None:
        async with self._lock:
            await self._socket.send_bytes(pack(packet))

    async def _receive(self) -> None:
        while True:
            data = await self._socket.receive()
            if data["type"] == "websocket.disconnect":
                return
            try:
                message = self._desk.reader.read(data.get("text") or data.get("bytes") or "")
            except ValueError as error:
                await self._socket.close(NONSENSE, str(error)[:100])
                return
            if isinstance(message, Ack):
                sending = self._streams.get(message.stream)
                if sending is not None and sending.acknowledge(message.sequence):
                    self._news.set()
                continue
            try:
                self._desk.session.take(message, self.name)
            except ValueError as error:
                self._desk.session.note(str(error))


class Subscriber(Protocol):
    """Who is told of new pictures: a page or a program. All is called in the event loop, and nothing waits."""

    is_page: bool

    def offer(self, stream: int, seen: StreamPicture) -> None:
        """Tell that there is a new picture of a stream."""
        ...

    def restart(self) -> None:
        """Tell that other streams are shown from here on."""
        ...

    def end(self) -> None:
        """Tell that the server ends."""
        ...


class ViewersParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How many may look at a time; more cost the loop of the camera processor time.

    Parameters
    ----------
    pages : int
        Chosen by hand: a class of pupils with a page each would be slow on the smallest computers.
    programs : int
        Chosen by hand: more than one project has.
    """

    pages: int = 16
    programs: int = 16


class Viewers:
    """All pages and programs that look.

    Parameters
    ----------
    parameters : ViewersParameters, optional
    """

    def __init__(self, parameters: ViewersParameters | None = None) -> None:
        self._parameters = parameters or ViewersParameters()
        self._viewers: set[Subscriber] = set()
        self._loop: asyncio.AbstractEventLoop | None = None

    def begin(self) -> None:
        """Take the running event loop as that of the pages."""
        self._loop = asyncio.get_running_loop()

    def tell(self, stream: int, seen: StreamPicture) -> None:
        """Tell all that there is a new picture; from any thread, and never waits."""
        loop = self._loop
        if loop is not None and self._viewers:
            with contextlib.suppress(RuntimeError):  # the loop has been closed since
                loop.call_soon_threadsafe(self._offer, stream, seen)

    def restart(self, session: Session, pictures: PictureEncoder) -> None:
        """Tell all that other streams are shown, whose pictures have the same numbers; from any thread."""
        loop = self._loop
        if loop is not None:
            with contextlib.suppress(RuntimeError):
                loop.call_soon_threadsafe(self._restart, session, pictures)

    def _offer(self, stream: int, seen: StreamPicture) -> None:
        for viewer in self._viewers:
            viewer.offer(stream, seen)

    def _restart(self, session: Session, pictures: PictureEncoder) -> None:
        pictures.forget()
        for viewer in self._viewers:
            viewer.restart()
            for number, stream in enumerate(session.streams):
                viewer.offer(number, stream.seen)

    def end(self) -> None:
        """Tell all that the server ends; in the event loop. Nobody is told anything afterwards."""
        self._loop = None
        for viewer in self._viewers:
            viewer.end()

    def add(self, viewer: Subscriber) -> bool:
        """Add a page or a program; False if as many look as may."""
        most = self._parameters.pages if viewer.is_page else self._parameters.programs
        if sum(each.is_page == viewer.is_page for each in self._viewers) >= most:
            return False
        self._viewers.add(viewer)
        return True

    def remove(self, viewer: Subscriber) -> None:
        """Forget a page or a program."""
        self._viewers.discard(viewer)

    def __len__(self) -> int:
        return len(self._viewers)
