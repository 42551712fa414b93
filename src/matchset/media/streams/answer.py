"""What an address says that gives no pictures: a page, an error, a redirection in a circle, nothing (`answer_of`)."""

import base64
import http.client
import socket
import threading
import urllib.error
import urllib.request
from contextlib import suppress
from urllib.parse import unquote, urlsplit, urlunsplit

# format: of schemes that begin with a connection, and an address without a port; a tcp:// address always has one
PORTS = {"rtsp": 554, "rtsps": 322, "rtmp": 1935, "http": 80, "https": 443, "tcp": None}


def answer_of(url: str, limit: float) -> str:
    """Ask an address that gave no pictures what it has to say.

    Parameters
    ----------
    url : str
        Of a stream; a password in it is used, and never told.
    limit : float
        Longest time that this may take, s.

    Returns
    -------
    str
        What is there in place of a stream, in words that follow its name: "answers with a page (text/html), ...". Empty
        if nothing is there, or it cannot be asked.
    """
    said: list[str] = []
    asking = threading.Thread(target=lambda: said.append(_ask(url, limit)), name="asks a stream", daemon=True)
    asking.start()
    asking.join(limit)  # one that sends its answer letter by letter would otherwise take as long as it likes
    if said:
        return said[0]
    return "takes connections, but does not answer" if _listens(url, limit) else ""


def _ask(url: str, limit: float) -> str:
    """Ask; empty if nothing is there."""
    if urlsplit(url).scheme.lower() not in ("http", "https"):
        return "takes connections, but no picture comes" if _listens(url, limit) else ""
    try:
        with urllib.request.urlopen(_request(url), timeout=limit) as reply:
            kind = reply.headers.get_content_type()
    except urllib.error.HTTPError as error:
        with error:
            redirected = 300 <= error.code < 400
            return "redirects in a circle" if redirected else f"answers {error.code} {error.reason}".strip()
    except (OSError, ValueError, http.client.HTTPException):
        return "takes connections, but does not answer as a web server" if _listens(url, limit) else ""
    if kind.startswith("text/") or kind in ("application/json", "application/xhtml+xml"):
        return f"answers with a page ({kind}), not with pictures"
    return f"answers with {kind}, but no picture comes"


def _request(url: str) -> urllib.request.Request:
    """Return the request of an address, a name and password in it as they are sent."""
    parts = urlsplit(url)
    plain, user = parts._replace(netloc=parts.netloc.rpartition("@")[2]), parts.username
    request = urllib.request.Request(urlunsplit(plain))
    if user is not None:
        login = f"{unquote(user)}:{unquote(parts.password or '')}"
        request.add_header("Authorization", "Basic " + base64.b64encode(login.encode()).decode())
    return request


def _listens(url: str, limit: float) -> bool:
    """Whether somebody takes connections there."""
    with suppress(OSError, ValueError):
        parts = urlsplit(url)
        port = parts.port or PORTS.get(parts.scheme.lower())
        if parts.hostname and port and parts.scheme.lower() in PORTS:
            with socket.create_connection((parts.hostname, port), limit):
                return True
    return False
