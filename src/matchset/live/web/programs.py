"""What programs get: the state of each picture as JSON lines over a WebSocket, or as server-sent events."""

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Mapping

import msgspec
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response, StreamingResponse
from starlette.websockets import WebSocket, WebSocketDisconnect

from matchset.live.feed import StreamPicture
from matchset.live.session import Session
from matchset.live.web.viewer import NONSENSE, Viewers
from matchset.live.wire.packet import STREAMS
from matchset.live.wire.state import State, written

FULL = "as many programs as may look already do"
DIGITS = 11  # format: of a number in a query; those of pictures, the largest ones, have as many after a century
EVENTS = {"Cache-Control": "no-store"}


class ProgramParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a program is sent.

    Parameters
    ----------
    waiting : int
        States that wait for a program at most. More outlasts a longer pause of the program without a gap; what it gets
        after that is older. Chosen by hand: a second of a camera of 60 frames/s.
    heartbeat : float
        Time without a picture after which a comment is sent to a reader of events, s: so that both sides notice a
        broken connection. Chosen by hand: below the minute after which routers forget a silent connection.
    """

    waiting: int = 60
    heartbeat: float = 5.0


class Program:
    """What waits for one program: every state as long as it keeps up, else the newest one, and how many were skipped.

    Parameters
    ----------
    stream : int
        Whose states it gets.
    parameters : ProgramParameters, optional

    Attributes
    ----------
    skipped : int
        States that it did not get.
    """

    is_page = False

    def __init__(self, stream: int, parameters: ProgramParameters | None = None) -> None:
        self._stream, self._parameters = stream, parameters or ProgramParameters()
        self._waiting: deque[State] = deque()
        self._last: StreamPicture | None = None
        self._news, self._ended, self._behind = asyncio.Event(), False, False
        self.skipped = 0

    def offer(self, stream: int, seen: StreamPicture) -> None:
        """Tell that there is a new picture."""
        if stream != self._stream or seen is self._last:
            return
        self._last = seen
        self._behind = self._behind or len(self._waiting) >= self._parameters.waiting
        if self._behind:
            self.skipped += len(self._waiting)
            self._waiting.clear()
        self._waiting.append(seen.state)
        self._news.set()

    def restart(self) -> None:
        """Go on with what is shown from here on."""

    def end(self) -> None:
        """End the lines."""
        self._ended = True
        self._news.set()

    async def lines(self) -> AsyncIterator[tuple[int, bytes]]:
        """Sequence number and JSON of each state; empty bytes where nothing came for a heartbeat."""
        while True:
            while self._waiting and not self._ended:
                state = self._waiting.popleft()
                yield state.sequence, self._line(state)
            if self._ended:
                return
            self._behind = False
            self._news.clear()
            try:
                async with asyncio.timeout(self._parameters.heartbeat):
                    await self._news.wait()
            except TimeoutError:
                yield 0, b""

    def _line(self, state: State) -> bytes:
        line = written(state)
        return b'{"skipped":%d,%b' % (self.skipped, line[1:]) if self.skipped else line


class ProgramRoutes:
    """The addresses of the streams for programs.

    Parameters
    ----------
    session : Session
    viewers : Viewers
        Tells of new pictures.
    parameters : ProgramParameters, optional
    """

    def __init__(self, session: Session, viewers: Viewers, parameters: ProgramParameters | None = None) -> None:
        self._session, self._viewers, self._parameters = session, viewers, parameters

    async def states(self, websocket: WebSocket) -> None:
        """Send the state of each picture of a stream as a line of JSON."""
        program = self._begin(websocket.query_params)
        if isinstance(program, Response):
            await websocket.send_denial_response(program)
            return
        await websocket.accept()
        listening = asyncio.create_task(_listen(websocket, program))
        try:
            async for _, line in program.lines():
                if line:
                    await websocket.send_text(line.decode())
            if listening.done() and listening.result():
                await websocket.close(NONSENSE, "nothing is said here: POST /do/TYPE")
        except WebSocketDisconnect:
            pass
        finally:
            self._viewers.remove(program)
            listening.cancel()

    async def events(self, request: Request) -> Response:
        """Send the same as server-sent events."""
        program = self._begin(request.query_params)
        if isinstance(program, Response):
            return program
        if request.method == "HEAD":
            self._viewers.remove(program)
            return Response(media_type="text/event-stream", headers=EVENTS)
        return StreamingResponse(self._events_of(program), media_type="text/event-stream", headers=EVENTS)

    async def _events_of(self, program: Program) -> AsyncIterator[bytes]:
        try:
            yield b"retry: 1000\n\n"
            async for sequence, line in program.lines():
                yield b"id: %d\ndata: %b\n\n" % (sequence, line) if line else b": no new picture\n\n"
        finally:
            self._viewers.remove(program)

    def _begin(self, query: Mapping[str, str]) -> Program | Response:
        """Begin to tell a program of a stream; or what to answer instead."""
        number = stream_number(query, len(self._session.streams))
        if isinstance(number, Response):
            return number
        program = Program(number, self._parameters)
        if not self._viewers.add(program):
            return PlainTextResponse(FULL, 503)
        streams = self._session.streams
        if number < len(streams):
            program.offer(number, streams[number].seen)
        return program


def stream_number(query: Mapping[str, str], streams: int) -> int | Response:
    """Read the number of a stream from a query, ``?stream=1``; or what to answer if there is none like this.

    Parameters
    ----------
    query : mapping
    streams : int
        How many there are; while nothing is shown, the first may be waited for.
    """
    text = query.get("stream", "0")
    number = whole(text, len(str(STREAMS)))
    if number is None:
        return PlainTextResponse(f"stream must be a number from 0, got {text[:40]!r}", 400)
    if number >= max(streams, 1):
        return PlainTextResponse(f"there is no stream {number} now", 404)
    return number


def whole(text: str, digits: int = DIGITS) -> int | None:
    """Read a whole number of a query; None if it is none, or has more digits."""
    return int(text) if text.isascii() and text.isdigit() and len(text) <= digits else None


async def _listen(websocket: WebSocket, program: Program) -> bool:
    """End the lines when a program goes, or says something, which is no use here; returns whether it said something."""
    message = await websocket.receive()
    program.end()
    return bool(message["type"] == "websocket.receive")
