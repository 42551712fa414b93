"""Who may use the page: `Guard` checks host, origin and session of every request."""

import hmac
import secrets
from collections.abc import Iterable
from urllib.parse import urlsplit

import msgspec

COOKIE = "matchset_session"
LOCAL = ("127.0.0.1", "localhost", "[::1]")
CONTENT_POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; style-src 'self'; script-src 'self'; "
    "connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)
HEADERS = {
    "Content-Security-Policy": CONTENT_POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}


class SecurityParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How hard tokens are to guess.

    Parameters
    ----------
    token_bytes : int
        Random bytes of a token and of a session. Chosen by: 128 bits cannot be tried; more makes the QR code larger.
    """

    token_bytes: int = 16


class Guard:
    """Decides about each request; knows nothing of a web server.

    Parameters
    ----------
    names : iterable of str
        Host names and addresses under which this computer may be reached, without port; anything else is DNS
        rebinding.
    port : int
    token : bool
        Whether a token is needed: everywhere but on this computer alone.
    parameters : SecurityParameters, optional

    Attributes
    ----------
    token : str
        Of the address to open; empty if none is needed.
    """

    def __init__(
        self, names: Iterable[str], port: int, token: bool, parameters: SecurityParameters | None = None
    ) -> None:
        size = (parameters or SecurityParameters()).token_bytes
        self.token = secrets.token_urlsafe(size) if token else ""
        self._session = secrets.token_urlsafe(size)
        self._hosts = {f"{name}:{port}".lower() for name in (*LOCAL, *names)}
        if port == 80:  # format: the port that browsers leave out
            self._hosts |= {name.lower() for name in (*LOCAL, *names)}

    def host_is_known(self, host: str | None) -> bool:
        """Whether the request was meant for this server."""
        return host is not None and host.lower() in self._hosts

    def origin_is_own(self, origin: str | None, host: str | None) -> bool:
        """Whether a request comes from this server's own page, or from a program, which tells no origin."""
        if origin is None:
            return True
        try:
            parts = urlsplit(origin)
        except ValueError:
            return False
        return parts.scheme == "http" and host is not None and parts.netloc.lower() == host.lower()

    def session_for(self, token: str) -> str | None:
        """Swap a token for a session; None if it is not the right one."""
        if not self.token or not hmac.compare_digest(token.encode(), self.token.encode()):
            return None
        return self._session

    def session_is_known(self, session: str | None) -> bool:
        """Whether a request may be answered: no token is needed, or it has the session of one."""
        if not self.token:
            return True
        return session is not None and hmac.compare_digest(session.encode(), self._session.encode())
