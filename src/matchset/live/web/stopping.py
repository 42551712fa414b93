"""A server that ends at once when a signal has come, whoever still looks: `StoppableServer`."""

import contextlib
import socket
from collections.abc import Callable, Iterator

import uvicorn
from starlette.applications import Starlette

from matchset.app.exit_codes import StopRequest
from matchset.live.wire.messages import LONGEST

PATIENCE = 1  # format: s until sessions and downloads that do not end are cut


class StoppableServer(uvicorn.Server):
    """Runs until a signal comes; then every session is closed.

    Parameters
    ----------
    application : Starlette
    stop : StopRequest
        Entered: it catches the signals, which uvicorn would raise again at the end, before files are closed.
    end : callable
        Ends what would go on for ever; called in the event loop.
    """

    def __init__(self, application: Starlette, stop: StopRequest, end: Callable[[], None]) -> None:
        config = uvicorn.Config(
            application,
            log_level="warning",
            access_log=False,  # addresses hold the token
            proxy_headers=False,
            server_header=False,
            ws_max_size=LONGEST,
            timeout_graceful_shutdown=PATIENCE,
        )
        super().__init__(config)
        self._stop, self._end = stop, end

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave the signals alone."""
        yield

    async def on_tick(self, counter: int) -> bool:
        """Look ten times a second whether to end."""
        self.should_exit = self.should_exit or bool(self._stop)
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End what goes on, then close."""
        self._end()
        await super().shutdown(sockets)
