"""Who may neither watch nor command: pages of another site, another name of this computer, nobody's token."""

import functools
import http.server
import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from live_pages import WAIT, Heard, click_ball, state_of, wait_for_picture, wait_until
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Filmed = tuple[Path, BallFlightClip]
OPEN_SOCKET = """(address) => new Promise((answer) => {
  const socket = new WebSocket(address);
  socket.onmessage = () => answer("a message");
  socket.onclose = (event) => answer(`closed ${event.code}`);
})"""
ASK = "([address, options]) => fetch(address, options).then((answer) => `status ${answer.status}`, () => 'refused')"
SHOW = """(address) => new Promise((answer) => {
  const image = new Image();
  image.onload = () => answer("shown");
  image.onerror = () => answer("refused");
  image.src = address;
})"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves files and says nothing."""

    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture
def foreign_page(new_page: Any, tmp_path: Path) -> Iterator[Any]:
    """A page of another site, without any policy of content."""
    (tmp_path / "index.html").write_text("<!doctype html><title>another site</title>")
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(tmp_path)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    page = new_page()
    page.goto(f"http://127.0.0.1:{server.server_address[1]}/")
    yield page
    server.shutdown()
    server.server_close()


def pick_of(page: Any, truth: BallFlightClip) -> str:
    """A click on the ball, as a page sends it."""
    state = state_of(page)
    (pixel,) = truth.camera.project(truth.place(state["time"])[None])
    return json.dumps({"sequence": state["sequence"], "x": pixel[0], "y": pixel[1]})


def test_another_site_neither_watches_nor_commands(served: str, foreign_page: Any, page: Any, clip: Filmed) -> None:
    address, (_, truth) = served, clip
    host = urlsplit(address).netloc
    page.goto(address)
    wait_for_picture(page)
    assert foreign_page.evaluate(OPEN_SOCKET, f"ws://{host}/ws") == "closed 1006"
    assert foreign_page.evaluate(OPEN_SOCKET, f"ws://{host}/states") == "closed 1006"
    for mode in ("cors", "no-cors"):
        command = {"method": "POST", "mode": mode, "body": pick_of(page, truth)}
        assert foreign_page.evaluate(ASK, [f"{address}do/pick", command]) == "refused"
    assert foreign_page.evaluate(ASK, [f"{address}state.json", {}]) == "refused"
    assert foreign_page.evaluate(SHOW, f"{address}frame.jpg") == "refused"
    # What it must not do, the own page may.
    assert page.evaluate(ASK, ["state.json", {}]) == "status 200"
    assert page.evaluate(SHOW, f"{address}frame.jpg") == "shown"
    assert page.evaluate(OPEN_SOCKET, f"ws://{host}/ws") == "a message"
    assert not state_of(page).get("targets")
    command = {"method": "POST", "body": pick_of(page, truth)}
    assert page.evaluate(ASK, [f"{address}do/pick", command]) == "status 204"
    page.locator("#targets .drop").click(timeout=WAIT)


def test_it_cannot_be_framed(served: str, foreign_page: Any) -> None:
    foreign_page.evaluate(
        """(address) => new Promise((answer) => {
             const frame = document.createElement("iframe");
             frame.onload = answer;
             frame.src = address;
             document.body.append(frame);
           })""",
        served,
    )
    assert foreign_page.frames[1].url != served  # the browser shows its own page of errors


def test_another_name_of_this_computer_is_refused(served: str, page: Any) -> None:
    port = urlsplit(served).port
    answer = page.goto(f"http://rebound.example:{port}/")  # the browser takes this name for 127.0.0.1
    assert answer.status == 421
    assert page.evaluate(OPEN_SOCKET, f"ws://rebound.example:{port}/ws") == "closed 1006"
    assert page.evaluate(ASK, ["state.json", {}]) == "status 421"


def test_without_its_token_nothing_is_answered(serve: Any, new_page: Any, clip: Filmed) -> None:
    printed = urlsplit(serve(str(clip[0]), "--lan"))
    address = f"http://127.0.0.1:{printed.port}/"
    stranger, guest = new_page(), new_page()
    for wrong in ("", "?token=", "?token=AAAAAAAAAAAAAAAAAAAAAA"):
        assert stranger.goto(address + wrong).status == 401
    assert stranger.evaluate(OPEN_SOCKET, f"ws://127.0.0.1:{printed.port}/ws") == "closed 1006"
    assert stranger.evaluate(ASK, [f"{address}do/pick", {"method": "POST", "body": "{}"}]) == "status 401"
    assert stranger.goto(f"{address}frame.jpg").status == 401
    heard = Heard(guest)
    guest.goto(f"{address}?{printed.query}")
    assert guest.url == address  # the token is no part of the address any more
    wait_until(guest, lambda: bool(heard.states))
    (cookie,) = guest.context.cookies()
    assert (cookie["httpOnly"], cookie["sameSite"]) == (True, "Strict")
    assert guest.evaluate("document.cookie") == ""


def test_the_page_runs_nothing_but_its_own_files(served: str, page: Any, clip: Filmed) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda socket: asked.append(socket.url))
    heard = Heard(page)
    page.goto(served)
    click_ball(heard, clip[1])
    page.locator("#targets .drop").click(timeout=WAIT)
    blocked = page.evaluate("""() => new Promise((answer) => {
      document.addEventListener("securitypolicyviolation", (event) => answer(event.effectiveDirective));
      const script = document.createElement("script");
      script.textContent = "window.injected = true";
      document.head.append(script);
    })""")
    assert (blocked, page.evaluate("window.injected")) == ("script-src-elem", None)
    hosts = {urlsplit(each).netloc for each in asked if not each.startswith(("blob:", "data:"))}
    assert hosts == {urlsplit(served).netloc}
    assert page.evaluate(ASK, ["http://127.0.0.1:9/", {}]) == "refused"
