"""Runs the page's server until Ctrl-C: `serve`."""

import contextlib
import socket
import sys
import webbrowser
from pathlib import Path

from matchset.app.cli_options import ViewOptions
from matchset.app.exit_codes import FOUND, StopRequest
from matchset.app.target.target_options import parse_pick
from matchset.live.compiling import CompilingPanel
from matchset.live.feed import Feed
from matchset.live.first_pick import FirstPick
from matchset.live.known_messages import READER
from matchset.live.options import LiveOptions
from matchset.live.record.panel import RecordPanel
from matchset.live.record.recorder import PageRecorder
from matchset.live.session import Session
from matchset.live.sharing.shared_page import shared_page
from matchset.live.sources.found_sources import Source, given_source
from matchset.live.sources.opening import Opening, check_source, open_feed
from matchset.live.sources.panel import SourcesPanel
from matchset.live.sources.source_selection import SourceSelection
from matchset.live.sources.uploads import Uploads
from matchset.live.web.application import make_application
from matchset.live.web.listening import listen, own_address, qr_code
from matchset.live.web.security import Guard
from matchset.live.web.session_report import SessionReport
from matchset.live.web.stopping import StoppableServer
from matchset.live.web.viewer import ViewerContext, Viewers
from matchset.live.wire.pictures import PictureEncoder
from matchset.media.upright.orientation import check_turn


def serve(options: LiveOptions) -> int:
    """Serve the page until Ctrl-C or SIGTERM, which are how it ends; returns the exit code.

    Raises
    ------
    ValueError
        If no port is free, `--pick` is no point, or the source can never be shown.
    """
    given = None if options.source is None else given_source(options.source)
    if given is not None:
        check_source(given)
    point = None if options.pick is None else point_of(options.pick)
    check_turn(options.mounted.turn, "--turn")
    view = ViewOptions(mounted=options.mounted, stream=options.stream, fields=options.fields)
    if options.source is None and view.words:
        raise ValueError("--turn, --mirror, --stream and --fields belong to a source: name one")
    listener, port = listen("0.0.0.0" if options.lan else "127.0.0.1", options.port)
    if options.port and port != options.port:
        print(f"note: port {options.port} is in use; this is {port}", file=sys.stderr)
    address, name = own_address() if options.lan else "127.0.0.1", socket.gethostname()
    guard = Guard([address, name, f"{name}.local"], port, token=options.lan)
    compiling, recorder = CompilingPanel(), PageRecorder()
    session = Session((compiling, RecordPanel(recorder)), (recorder,), compiling.refusal)
    shared = shared_page(options.sharing.opened(), session)
    compiling.ready = session.go_on
    desk, viewers = ViewerContext(session, PictureEncoder(), READER, SessionReport(session)), Viewers()
    with contextlib.ExitStack() as opened:
        stop = opened.enter_context(StopRequest())
        uploads = opened.enter_context(Uploads())
        for each in (
            compiling,
            listener,
            recorder,
            shared,
            session,
            make_selection(given, view, uploads, desk, viewers),
        ):
            opened.enter_context(each)
        if point is not None:
            opened.enter_context(FirstPick(session, point, compiling.refusal))
        announce(f"http://{address}:{port}/", guard.token, options.browser)
        StoppableServer(make_application(desk, viewers, guard), stop, viewers.end).run([listener])
    return FOUND


def announce(url: str, token: str, browser: bool) -> None:
    """Print the address, in a terminal with its QR code if it holds a token; open it, if wanted."""
    url += f"?token={token}" if token else ""
    print(url, flush=True)
    if token and sys.stderr.isatty():
        print(qr_code(url), end="", file=sys.stderr)
    if token:
        print("note: whoever can listen in this network can read pictures and token (plain HTTP)", file=sys.stderr)
    if browser:
        webbrowser.open(url)


def point_of(text: str) -> tuple[float, float]:
    """Read ``X,Y``."""
    x, y, frame = parse_pick(text)
    if frame is not None:
        raise ValueError(f"--pick is X,Y in the first picture, got {text!r}")
    return x, y


def make_selection(
    given: Source | None, view: ViewOptions, uploads: Uploads, desk: ViewerContext, viewers: Viewers
) -> SourceSelection:
    """Offer what can be shown, and show what the command line names."""
    session = desk.session

    def news(number: int) -> None:
        seen = session.hear(number)
        if seen is not None:
            viewers.tell(number, seen)

    def show(feed: Feed | None) -> None:
        session.show(feed)
        viewers.restart(session, desk.pictures)

    def make(source: Source) -> Feed:
        return open_feed(source, Opening(news, session.note, stage.stopped.is_set, view))

    stage = SourceSelection(Path(), make, show, lambda: session.busy)
    session.add(SourcesPanel(stage, given, uploads))
    stage.look()
    if given is not None:
        stage.show(given)
    return stage
