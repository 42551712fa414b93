"""Runs the page's server until Ctrl-C: `serve`."""

import socket
import sys
import webbrowser
from pathlib import Path

from matchset.app.exit_codes import FOUND, StopRequest
from matchset.app.live.command import LiveOptions
from matchset.app.live.compiling import CompilingPanel
from matchset.app.live.feed import Feed
from matchset.app.live.known_messages import READER
from matchset.app.live.record.panel import RecordPanel
from matchset.app.live.record.recorder import Recorder
from matchset.app.live.session import Session
from matchset.app.live.sources.found_sources import Source
from matchset.app.live.sources.opening import Opening, open_feed
from matchset.app.live.sources.panel import SourcesPanel
from matchset.app.live.sources.stage import Stage
from matchset.app.live.web.application import make_application
from matchset.app.live.web.security import Guard
from matchset.app.live.web.stopping import StoppableServer
from matchset.app.live.web.viewer import Desk, Viewers
from matchset.app.live.wire.pictures import Pictures

SEND_BUFFER = 65536  # format: bytes that the system keeps of what a slow program has not read
PORTS = 20  # format: ports that are tried, one after the other


def serve(options: LiveOptions) -> int:
    """Serve the page until Ctrl-C or SIGTERM, which are how it ends; returns the exit code.

    Raises
    ------
    ValueError
        If no port is free.
    """
    host = "0.0.0.0" if options.lan else "127.0.0.1"
    listener, port = listen(host, options.port)
    if options.port and port != options.port:
        print(f"note: port {options.port} is in use; this is {port}", file=sys.stderr)
    address = own_address() if options.lan else "127.0.0.1"
    guard = Guard([address, socket.gethostname()], port, token=options.lan)
    compiling = CompilingPanel()
    recorder = Recorder()
    session = Session((compiling, RecordPanel(recorder)), (recorder,), compiling.refusal)
    desk, viewers = Desk(session, Pictures(), READER), Viewers()
    url = f"http://{address}:{port}/" + (f"?token={guard.token}" if guard.token else "")
    print(url, flush=True)
    if options.browser:
        webbrowser.open(url)
    with StopRequest() as stop, listener, recorder, session, make_stage(options, desk, viewers):
        StoppableServer(make_application(desk, viewers, guard), stop, viewers.end).run([listener])
    return FOUND


def make_stage(options: LiveOptions, desk: Desk, viewers: Viewers) -> Stage:
    """Offer what can be shown, and show what the command line names."""
    session = desk.session

    def news(number: int) -> None:
        seen = session.hear(number)
        if seen is not None:
            viewers.tell(number, seen)

    def show(feed: Feed | None) -> None:
        session.show(feed)
        viewers.restart(session, desk.pictures)

    stage = Stage(Path(), lambda source: open_feed(source, Opening(news, session.note)), show)
    given = None if options.source is None else Source("given", options.source, options.source)
    session.add(SourcesPanel(stage, given))
    stage.look()
    if given is not None:
        stage.show(given)
    return stage


def listen(host: str, port: int) -> tuple[socket.socket, int]:
    """Open a port, or the next one that is free.

    Raises
    ------
    ValueError
        If none of twenty is.
    """
    for number in range(port, port + PORTS):
        listener = socket.socket()
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        try:
            listener.bind((host, number))
        except OSError:
            listener.close()
            continue
        listener.listen()
        return listener, listener.getsockname()[1]
    raise ValueError(f"ports {port} to {port + PORTS - 1} are all in use")


def own_address() -> str:
    """Return the address of this computer in its network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # format: an address for documentation; nothing is sent
        except OSError:
            return "127.0.0.1"
        name: str = probe.getsockname()[0]
        return name
