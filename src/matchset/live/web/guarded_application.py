"""Every request passes here first: `GuardedApplication` answers what may not pass, and adds the headers of security."""

from starlette.requests import HTTPConnection
from starlette.responses import JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket

from matchset.live.web.security import COOKIE, HEADERS, Guard

FORBIDDEN = 4403  # format: the code with which a session is closed that may not be
SAFE = ("GET", "HEAD")


class GuardedApplication:
    """Lets through what a `Guard` allows, and adds its headers.

    Parameters
    ----------
    app : ASGIApp
    guard : Guard
    """

    def __init__(self, app: ASGIApp, guard: Guard) -> None:
        self._app, self._guard = app, guard

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(HTTPConnection(scope))
        if refusal is None:
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            await WebSocket(scope, receive, send).close(FORBIDDEN, "not allowed")
        else:
            await refusal(scope, receive, _with_headers(send))

    def _refusal(self, asked: HTTPConnection) -> Response | None:
        """Return what to answer instead; None if the request may pass."""
        host, origin = asked.headers.get("host"), asked.headers.get("origin")
        if not self._guard.host_is_known(host):
            return PlainTextResponse("this is not the address of this server", 421)
        changes = asked.scope["type"] == "websocket" or asked.scope["method"] not in SAFE
        if changes and not self._guard.origin_is_own(origin, host):
            return PlainTextResponse("another site's page may not do this", 403)
        token = asked.query_params.get("token")
        if token is not None and asked.scope["type"] == "http":
            return self._swapped(token, asked.url.path)
        if not self._guard.session_is_known(asked.cookies.get(COOKIE)):
            return PlainTextResponse("open the address that matchset printed: it holds a token", 401)
        return None

    def _swapped(self, token: str, path: str) -> Response:
        session = self._guard.session_for(token)
        if session is None:
            return JSONResponse({"error": "this token is not valid"}, 401)
        answer = RedirectResponse(path, 303)
        answer.set_cookie(COOKIE, session, httponly=True, samesite="strict")
        return answer


def _with_headers(send: Send) -> Send:
    async def sent(message: object) -> None:
        if isinstance(message, dict) and message["type"] == "http.response.start":
            message["headers"] = [
                *message["headers"],
                *((name.lower().encode(), value.encode()) for name, value in HEADERS.items()),
            ]
        await send(message)  # type: ignore[arg-type]

    return sent
