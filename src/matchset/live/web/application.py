"""The routes of the page's server: `make_application`. docs/live.md has them in a table."""

import asyncio
import contextlib
import functools
import time
from collections.abc import AsyncIterator
from pathlib import Path

import msgspec
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket

from matchset.live.feed import ChartedStream, MaskedStream, Receiver
from matchset.live.web.guarded_application import GuardedApplication
from matchset.live.web.programs import ProgramRoutes, stream_number, whole
from matchset.live.web.security import Guard
from matchset.live.web.viewer import FULL, TOO_MANY, Viewer, ViewerContext, Viewers
from matchset.live.wire.flow import SIZES
from matchset.live.wire.messages import LONGEST

PAGE = Path(__file__).resolve().parents[1] / "page"
MASK = ("stream", "target", "sequence")
UPLOAD = 65536  # format: bytes of a file that a page sends; a camera file has some 3000


def make_application(desk: ViewerContext, viewers: Viewers, guard: Guard) -> Starlette:
    """Make the server.

    Parameters
    ----------
    desk : ViewerContext
    viewers : Viewers
        Those that are told of new pictures.
    guard : Guard
    """
    routes, programs = _Routes(desk, viewers), ProgramRoutes(desk.session, viewers)

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        viewers.begin()
        yield
        desk.pictures.close()

    return Starlette(
        routes=[
            WebSocketRoute("/ws", routes.page),
            WebSocketRoute("/states", programs.states),
            Route("/events", programs.events),
            Route("/state.json", routes.state),
            Route("/frame.jpg", routes.frame),
            Route("/mask.png", routes.mask),
            Route("/course.json", routes.course),
            Route("/do/{type}", routes.do, methods=["POST", "GET"]),
            Route("/thumbnail.jpg", routes.thumbnail),
            Route("/upload/{kind}", routes.upload, methods=["POST"]),
            Route("/download/{name:path}", routes.download),
            Mount("/", StaticFiles(directory=PAGE, html=True)),
        ],
        middleware=[Middleware(GuardedApplication, guard=guard)],
        lifespan=lifespan,
    )


class _Routes:
    """What each address answers."""

    def __init__(self, desk: ViewerContext, viewers: Viewers) -> None:
        self._desk, self._viewers = desk, viewers

    async def page(self, websocket: WebSocket) -> None:
        """Serve a page's socket."""
        await websocket.accept()
        viewer = Viewer(websocket, self._desk)
        if not self._viewers.add(viewer):
            await websocket.close(TOO_MANY, FULL)
            return
        for number, stream in enumerate(self._desk.session.streams):
            viewer.offer(number, stream.seen)
        try:
            await viewer.serve()
        finally:
            self._viewers.remove(viewer)
            self._desk.session.left(viewer.name)

    async def state(self, _: Request) -> Response:
        """Answer what is shown now."""
        session = self._desk.session
        both = {"session": session.state(), "streams": [stream.seen.state for stream in session.streams]}
        return Response(msgspec.json.encode(both), media_type="application/json")

    async def frame(self, request: Request) -> Response:
        """Answer the newest picture as JPEG."""
        streams = self._desk.session.streams
        number = stream_number(request.query_params, len(streams))
        if isinstance(number, Response):
            return number
        if not streams:
            return PlainTextResponse("nothing is shown now", 503)
        seen = streams[number].seen
        if seen.frame is None:
            return PlainTextResponse(seen.state.fault or "no picture yet", 503)
        key = number, seen.state.sequence
        data = await self._desk.pictures.picture(key, seen.frame.image, SIZES[0])
        headers = {"Cache-Control": "no-store"}
        if seen.state.live:
            headers["X-Age"] = f"{time.monotonic() - seen.state.time:.4f}"
        return Response(data, media_type="image/jpeg", headers=headers)

    async def mask(self, request: Request) -> Response:
        """Answer what the color model of a target takes for it, in a picture that was seen, or in the newest."""
        number, target, sequence = (whole(request.query_params.get(name, "0")) for name in MASK)
        if number is None or target is None or sequence is None:
            return PlainTextResponse(f"{', '.join(MASK)} are whole numbers", 400)
        streams = self._desk.session.streams
        stream = streams[number] if number < len(streams) else None
        if not isinstance(stream, MaskedStream):
            return PlainTextResponse(f"stream {number} has no masks", 404)
        wanted = sequence or stream.seen.state.sequence
        try:
            data = await self._desk.pictures.mask(functools.partial(stream.mask, target, wanted))
        except ValueError as error:
            return PlainTextResponse(str(error), 404)
        return Response(data, media_type="image/png", headers={"Cache-Control": "no-store"})

    async def thumbnail(self, request: Request) -> Response:
        """Answer a small picture of an entry of the menu."""
        try:
            data = await asyncio.to_thread(self._desk.session.thumbnail, request.query_params.get("key", ""))
        except (ValueError, OSError) as error:
            return PlainTextResponse(str(error), 404)
        return Response(data, media_type="image/jpeg", headers={"Cache-Control": "private, max-age=3600"})

    async def course(self, request: Request) -> Response:
        """Answer the course of a target over a whole video."""
        target = whole(request.query_params.get("target", ""))
        if target is None:
            return PlainTextResponse("target is a whole number", 400)
        for stream in self._desk.session.streams:
            if isinstance(stream, ChartedStream):
                try:
                    course = await asyncio.to_thread(stream.course, target)
                except ValueError as error:
                    return PlainTextResponse(str(error), 404)
                data = msgspec.json.encode(course)
                return Response(data, media_type="application/json", headers={"Cache-Control": "no-store"})
        return PlainTextResponse("no video is shown", 404)

    async def do(self, request: Request) -> Response:
        """Do what a button does; the fields of the message are the body, JSON."""
        if request.method != "POST":
            return JSONResponse({"error": "what changes something must be POST"}, 405, {"Allow": "POST"})
        body = await body_of(request, LONGEST)
        if body is None:
            return JSONResponse({"error": f"a message has {LONGEST} bytes at most"}, 413)
        try:
            fields = msgspec.json.decode(body or b"{}", type=dict[str, object])
            message = self._desk.reader.read(msgspec.json.encode({**fields, "type": request.path_params["type"]}))
            self._desk.session.take(message, "")
        except (ValueError, msgspec.DecodeError, RecursionError) as error:
            return JSONResponse({"error": str(error)}, 400)
        return Response(status_code=204)

    async def upload(self, request: Request) -> Response:
        """Take a file; its name is the query's `name`. A large one is taken from the page alone."""
        kind, name = request.path_params["kind"], request.query_params.get("name", "")
        length = whole(request.headers.get("content-length", ""))
        try:
            receiver = self._desk.session.receive(kind, name, length or 0)
        except (ValueError, OSError) as error:
            return JSONResponse({"error": str(error)}, 400)
        if receiver is not None:
            if request.headers.get("origin") is None:
                receiver.drop()
                return JSONResponse({"error": "a video is taken from the page alone"}, 403)
            return await _receive(receiver, request)
        body = await body_of(request, UPLOAD)
        if body is None:
            return JSONResponse({"error": f"a file has {UPLOAD} bytes at most"}, 413)
        try:
            self._desk.session.put(kind, name, body)
        except ValueError as error:
            return JSONResponse({"error": str(error)}, 400)
        return Response(status_code=204)

    async def download(self, request: Request) -> Response:
        """Answer a file that is offered; nothing else is read."""
        path = self._desk.session.downloads().get(request.path_params["name"])
        if path is None or not path.is_file():
            return PlainTextResponse("there is no such file", 404)
        return FileResponse(path, filename=request.path_params["name"].replace("/", "-"))


async def _receive(receiver: Receiver, request: Request) -> Response:
    """Hand a large file on, part by part; what is not whole or no video is deleted."""
    try:
        async for part in request.stream():
            await asyncio.to_thread(receiver.write, part)
        await asyncio.to_thread(receiver.finish)
    except (ValueError, OSError) as error:
        receiver.drop()
        return JSONResponse({"error": str(error)}, 400)
    except BaseException:  # the page is gone, or the server ends
        receiver.drop()
        raise
    return Response(status_code=204)


async def body_of(request: Request, most: int) -> bytes | None:
    """Read what a request sends; None if that is more than so many bytes, of which no more are read."""
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > most:
            return None
    return body
