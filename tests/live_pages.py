"""The live page in a browser: where things are on it, and what its server tells it."""

import json
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from matchset.live.wire.packet import unpack
from matchset.live.wire.state import State
from matchset.sim.clips.ball_flight_clip import BallFlightClip

WAIT = 60_000  # ms, at most: a busy computer is slow


def on_screen(page: Any, x: float, y: float) -> tuple[float, float]:
    """Where a point of the picture is on the screen, CSS px."""
    box = page.locator("#view").bounding_box()
    # The size of the camera's picture; that of the canvas is half of it on a slow link or a busy machine.
    width, height = page.evaluate("[drawing.viewBox.baseVal.width, drawing.viewBox.baseVal.height]")
    return box["x"] + (x + 0.5) / width * box["width"], box["y"] + (y + 0.5) / height * box["height"]


def state_of(page: Any) -> dict[str, Any]:
    """What the server says of the newest picture of the first stream."""
    stream: dict[str, Any] = page.evaluate("fetch('state.json').then((answer) => answer.json())")["streams"][0]
    return stream


def wait_for_picture(page: Any) -> None:
    """Wait until a picture is on the page."""
    wait_until(page, "drawing.viewBox.baseVal.width > 0")


def hold(heard: "Heard") -> None:
    """Press pause, and wait for the picture that stays."""
    page = heard.page
    wait_for_picture(page)
    button = page.locator("#file .play")
    button.wait_for(timeout=WAIT)
    if "pause" in button.get_attribute("aria-label"):
        button.click()
    wait_until(page, lambda: "play" in button.get_attribute("aria-label"))
    wait_until(page, lambda: heard.painted is not None and heard.painted.sequence == state_of(page)["sequence"])


def click_ball(heard: "Heard", truth: BallFlightClip) -> None:
    """Stop the video and click the ball."""
    hold(heard)
    assert heard.painted is not None
    rows = heard.page.locator("#targets li")
    followed = rows.count()
    (pixel,) = truth.camera.project(truth.place(heard.painted.time)[None])
    heard.page.mouse.click(*on_screen(heard.page, *pixel))
    wait_until(heard.page, lambda: bool(rows.count() > followed))


class Servers:
    """Starts `matchset live` with arguments and returns its address; `close` ends all that it started.

    Parameters
    ----------
    folder : Path
        Where they run.

    Attributes
    ----------
    processes : list of Popen
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.processes: list[subprocess.Popen[str]] = []

    def __call__(self, *arguments: str, folder: Path | None = None) -> str:
        command = [sys.executable, "-m", "matchset.cli", "live", *arguments, "--no-browser"]
        command += [] if "--port" in arguments else ["--port", "0"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=folder or self._folder)
        self.processes.append(process)
        assert process.stdout is not None
        line = process.stdout.readline().strip()
        assert line.startswith("http"), line
        return line

    def close(self) -> None:
        for process in self.processes:
            process.terminate()
        for process in self.processes:
            process.wait(10)
            assert process.stdout is not None
            process.stdout.close()


class Shared:
    """Servers that several tests use; each finds what it asks for opened anew: nothing followed, at its beginning.

    Parameters
    ----------
    servers : Servers
        Starts them, and ends them.
    """

    def __init__(self, servers: Servers) -> None:
        self._servers = servers
        self._addresses: dict[tuple[str, ...], str] = {}

    def __call__(self, *arguments: str) -> str:
        """Return the address of a server that was started with these arguments."""
        if arguments not in self._addresses:
            self._addresses[arguments] = self._servers(*arguments)
        else:
            show_again(self._addresses[arguments])
        return self._addresses[arguments]


def show_again(address: str) -> None:
    """Have a server open what it shows once more, as its menu does; a flight is ended before."""
    panels = ask(address)["session"]["panels"]
    if "flight" in panels:
        tell(address, "kill")
    tell(address, "show", key=panels["sources"]["shown"])
    end = time.monotonic() + WAIT / 1000.0
    while (sources := ask(address)["session"]["panels"]["sources"]).get("opening") or not sources.get("shown"):
        assert time.monotonic() < end, sources
        time.sleep(0.02)


def ask(address: str) -> dict[str, Any]:
    """What a server says is shown."""
    with urllib.request.urlopen(f"{address}state.json", timeout=10) as answer:
        told: dict[str, Any] = json.load(answer)
    return told


def tell(address: str, message: str, **fields: object) -> None:
    """Have a server do what a button does."""
    order = urllib.request.Request(f"{address}do/{message}", data=json.dumps(fields).encode(), method="POST")
    urllib.request.urlopen(order, timeout=10).close()


class Heard:
    """Listens to what server and page say to each other: made before the page goes anywhere.

    Attributes
    ----------
    page : Page
    states : list of State
        Those of the pictures, in the order in which they came.
    painted : State or None
        That of the picture on the screen, the last one that the page acknowledged.
    acknowledged : list of int
        Numbers of the pictures that the page acknowledged.
    """

    def __init__(self, page: Any) -> None:
        self.page = page
        self.states: list[State] = []
        self.painted: State | None = None
        self.acknowledged: list[int] = []
        self._read = msgspec.json.Decoder(State).decode
        page.on("websocket", self._listen)

    def _listen(self, socket: Any) -> None:
        socket.on("framereceived", self._take)
        socket.on("framesent", self._note)

    def _take(self, data: bytes | str) -> None:
        if isinstance(data, bytes):
            packet = unpack(data)
            if not packet.session:
                self.states.append(self._read(packet.state))

    def _note(self, data: bytes | str) -> None:
        message = json.loads(data)
        if message["type"] == "ack":
            self.acknowledged.append(message["sequence"])
            self.painted = next((each for each in self.states[:-9:-1] if each.sequence == message["sequence"]), None)


def wait_until(page: Any, condition: str | Callable[[], bool], seconds: float = WAIT / 1000.0) -> None:
    """Wait for a condition, JavaScript or a function; asked from outside: the page itself evaluates no text."""
    holds = condition if callable(condition) else lambda: bool(page.evaluate(condition))
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, (
            f"not within {seconds:g} s: {condition}; the page reads {page.inner_text('body')!r}"
        )
        page.wait_for_timeout(30)


def rows(page: Any) -> list[str]:
    """Names in the list of targets."""
    names: list[str] = page.locator("#targets .name").all_inner_texts()
    return [name.strip() for name in names]


def wait_until_compiled(page: Any) -> None:
    """Wait until a click is answered at once: on a busy machine the compiler may not be done yet."""
    done = "fetch('state.json').then((answer) => answer.json()).then((all) => all.session.panels.compiling.done)"
    wait_until(page, done, 120.0)
