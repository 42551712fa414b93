"""The page in a real browser: a server in a process of its own, Chromium, and rendered clips with their truth."""

import contextlib
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from live_clips import filmed, going_around, leaving
from live_pages import WAIT, Servers, Shared, wait_for_picture
from matchset.live.compiling import compile_needed
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from mjpeg_server import MjpegServer

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium, one for all tests of a worker; in CI it must be there, elsewhere the tests are skipped without it."""
    if CHROMIUM is None:
        assert not os.environ.get("CI"), "there is no chromium: .ci/browser installs it"
        pytest.skip("there is no chromium: make test installs it where it may")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        # Root has no sandbox; figures of memory would be rounded and old; a foreign name for this computer.
        arguments = ["--no-sandbox", "--enable-precise-memory-info"]
        arguments += ["--host-resolver-rules=MAP rebound.example 127.0.0.1"]
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield chromium
        chromium.close()


@pytest.fixture
def new_page(browser) -> Iterator[Callable[..., Any]]:
    """Open a page in a context of its own, of 1280 x 900 if nothing else is said; an error in its scripts fails."""
    contexts, errors = [], []

    def open_page(**options: Any) -> Any:
        usual = {"viewport": {"width": 1280, "height": 900}, "accept_downloads": True}
        context = browser.new_context(**usual | options)
        context.set_default_timeout(WAIT)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert not errors


@pytest.fixture
def page(new_page) -> Any:
    """A page of 1280 x 900; an error in its scripts fails the test."""
    return new_page()


@pytest.fixture(scope="session")
def warm() -> None:
    """Kernels are compiled before a server needs them: a clip would not wait for that."""
    compile_needed()


@pytest.fixture
def film() -> Iterator[Callable[..., MjpegServer]]:
    """Make a camera in the network, closed after the servers that read it if asked for before `serve`: they wait."""
    with contextlib.ExitStack() as opened:
        yield lambda picture, rate=30.0: opened.enter_context(MjpegServer(picture, rate))


@pytest.fixture
def serve(tmp_path: Path, warm: None) -> Iterator[Servers]:
    """Start `matchset live` with arguments, in a folder of its own; returns its address. All are ended afterwards."""
    with contextlib.closing(Servers(tmp_path)) as servers:
        yield servers


@pytest.fixture(scope="module")
def camera(request: pytest.FixtureRequest) -> Iterator[MjpegServer]:
    """A camera in the network that sees what `scene` of the file draws."""
    with MjpegServer(request.module.scene) as server:
        yield server


@pytest.fixture(scope="module")
def show(tmp_path_factory, warm: None) -> Iterator[Shared]:
    """Address of a server that shows a source: one for all tests of a file, of which each finds it opened anew."""
    with contextlib.closing(Servers(tmp_path_factory.mktemp("shown"))) as servers:
        yield Shared(servers)


@pytest.fixture
def served(show: Shared, clip) -> str:
    """Address of a server that shows `clip`, shared as `show` does."""
    return show(str(clip[0]))


@pytest.fixture
def opened(camera: MjpegServer, show: Shared, page: Any) -> Any:
    """A page that shows `camera`."""
    page.goto(show(camera.url))
    wait_for_picture(page)
    return page


@pytest.fixture(scope="session")
def clip(tmp_path_factory) -> tuple[Path, BallFlightClip]:
    """A video of eight seconds, the ball in view all the time; and its truth: `clip.place(time)`, `clip.camera`."""
    return filmed(tmp_path_factory.mktemp("clip"), going_around)


@pytest.fixture(scope="session")
def leaving_clip(tmp_path_factory) -> tuple[Path, BallFlightClip]:
    """The same, but the ball is out of the picture from 1.4 to 2.6 s of each four."""
    return filmed(tmp_path_factory.mktemp("leaving"), leaving)
