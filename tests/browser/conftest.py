"""The page in a real browser: a server in a process of its own, Chromium, and rendered clips with their truth."""

import contextlib
import math
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import matchset as ms
from live_pages import Servers
from matchset.app.live.compiling import NEEDED
from matchset.app.warm import groups
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from matchset.sim.clips.balloon import Balloon

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
CAMERA = ms.CameraModel.from_fov(320, 240, math.radians(60.0))
PERIOD = 4.0  # s, after which a path begins again; a clip goes along it some times
FRAMES = 120  # in a period
TIMES = 2


@pytest.fixture(scope="session", autouse=True)
def ordinary() -> Iterator[None]:
    """Tests may be run with real-time priority, which a browser's many processes must not have: they inherit it."""
    if not hasattr(os, "sched_setscheduler"):
        yield
        return
    policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    yield
    os.sched_setscheduler(0, policy, parameters)


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
    for name in NEEDED:
        groups()[name]()


@pytest.fixture
def serve(tmp_path: Path, warm: None) -> Iterator[Servers]:
    """Start `matchset live` with arguments, in a folder of its own; returns its address. All are ended afterwards."""
    with contextlib.closing(Servers(tmp_path)) as servers:
        yield servers


@pytest.fixture(scope="module")
def served(tmp_path_factory, clip, warm: None) -> Iterator[str]:
    """Address of a server that shows `clip`: one for all tests of a file, which leave no target there."""
    with contextlib.closing(Servers(tmp_path_factory.mktemp("served"))) as servers:
        yield servers(str(clip[0]))


def going_around(time: float) -> np.ndarray:
    """Where the ball is, m: it goes around slowly, in view all the time."""
    angle = 2.0 * math.pi * time / PERIOD
    return np.array((0.16 * math.sin(angle), 0.12 * math.cos(angle), 1.6 + 0.2 * math.sin(angle)))


def leaving(time: float) -> np.ndarray:
    """Where the ball is, m: it rests in the middle, goes to the right and is out of view for 1.2 of 4 s."""
    away = 0.5 * (1.0 - math.cos(2.0 * math.pi * time / PERIOD))
    return np.array((2.2 * away**3, 0.0, 1.6))


def filmed(folder: Path, place: Callable[[float], np.ndarray]) -> tuple[Path, BallFlightClip]:
    """Write a video that goes along a path twice; only one time is rendered."""
    balloon = Balloon(marker_radius=0.0)  # a click on its middle means the ball
    rendered = BallFlightClip(camera=CAMERA, place=place, balloon=balloon, frames=FRAMES, fps=FRAMES / PERIOD)
    writer = cv2.VideoWriter(str(folder / "ball.avi"), cv2.VideoWriter.fourcc(*"MJPG"), rendered.fps, (320, 240))
    images = [frame.image for frame in rendered]
    for image in images * TIMES:
        writer.write(image)
    writer.release()
    return folder / "ball.avi", rendered


@pytest.fixture(scope="session")
def clip(tmp_path_factory) -> tuple[Path, BallFlightClip]:
    """A video of eight seconds, the ball in view all the time; and its truth: `clip.place(time)`, `clip.camera`."""
    return filmed(tmp_path_factory.mktemp("clip"), going_around)


@pytest.fixture(scope="session")
def leaving_clip(tmp_path_factory) -> tuple[Path, BallFlightClip]:
    """The same, but the ball is out of the picture from 1.4 to 2.6 s of each four."""
    return filmed(tmp_path_factory.mktemp("leaving"), leaving)
