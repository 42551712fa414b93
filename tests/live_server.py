"""The server of the live page in a thread, with a made-up feed."""

import contextlib
import threading
from collections.abc import Iterator
from typing import NamedTuple

from live_feeds import MadeUpFeed
from matchset.app.exit_codes import StopRequest
from matchset.live.known_messages import READER
from matchset.live.session import Session
from matchset.live.web.application import make_application
from matchset.live.web.listening import listen
from matchset.live.web.security import Guard
from matchset.live.web.session_report import SessionReport
from matchset.live.web.stopping import StoppableServer
from matchset.live.web.viewer import ViewerContext, Viewers
from matchset.live.wire.pictures import PictureEncoder


class Served(NamedTuple):
    """A server that runs.

    Attributes
    ----------
    host : str
        Address and port.
    feed : MadeUpFeed
    session : Session
    viewers : Viewers
    guard : Guard
    """

    host: str
    feed: MadeUpFeed
    session: Session
    viewers: Viewers
    guard: Guard


def made_desk(streams: int = 1) -> tuple[ViewerContext, Viewers, MadeUpFeed]:
    """A session that shows a made-up feed, and who is told of it."""
    session, viewers, feed = Session(), Viewers(), MadeUpFeed(streams)
    desk = ViewerContext(session, PictureEncoder(), READER, SessionReport(session))

    def tell(number: int) -> None:
        seen = desk.session.hear(number)
        if seen is not None:
            viewers.tell(number, seen)

    feed.tell = tell
    desk.session.show(feed)
    return desk, viewers, feed


@contextlib.contextmanager
def served(token: bool = False) -> Iterator[Served]:
    """Run a server in a thread until the end of the block."""
    desk, viewers, feed = made_desk()
    listener, port = listen("127.0.0.1", 0)
    guard, stop = Guard([], port, token), StopRequest()
    server = StoppableServer(make_application(desk, viewers, guard), stop, viewers.end)
    thread = threading.Thread(target=server.run, args=([listener],))
    thread.start()
    try:
        yield Served(f"127.0.0.1:{port}", feed, desk.session, viewers, guard)
    finally:
        stop.code = 1
        thread.join(10.0)
        listener.close()
        assert not thread.is_alive()
