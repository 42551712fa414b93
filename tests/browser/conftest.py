"""The page in a real browser: a server in a process of its own, Chromium, and rendered clips with their truth."""

import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from matchset.sim.clips.balloon import Balloon

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
CAMERA = ms.CameraModel.from_fov(320, 240, math.radians(60.0))
BALL = 0.28  # m, its diameter
PERIOD = 4.0  # s, after which a path begins again; a clip goes along it some times
FRAMES = 120  # in a period
TIMES = 10


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
        # --no-sandbox: root has no other; precise memory: else its figures are rounded, and old ones at that.
        arguments = ["--no-sandbox", "--enable-precise-memory-info"]
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
    image = np.full((240, 320, 3), 60, np.uint8)
    cv2.circle(image, (160, 120), 24, (200, 60, 60), -1, cv2.LINE_AA)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 160, 120), start=(160, 120))
    localizer = ms.Localizer(CAMERA, ms.BallTarget(diameter=BALL))
    for index in range(3):
        track = tracker.update(ms.Frame(image, index / 30.0, index))
        assert isinstance(track, ms.Track)
        localizer.update(track)


@pytest.fixture
def serve(tmp_path: Path, warm: None) -> Iterator[Callable[..., str]]:
    """Start `matchset live` with arguments, in a folder of its own; returns its address. All are ended afterwards."""
    servers = []

    def start(*arguments: str, folder: Path = tmp_path) -> str:
        command = [sys.executable, "-m", "matchset.app.cli", "live", *arguments, "--no-browser"]
        command += [] if "--port" in arguments else ["--port", "0"]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=folder)
        servers.append(server)
        line = server.stdout.readline().strip()
        assert line.startswith("http"), line
        return line

    start.servers = servers
    yield start
    for server in servers:
        server.terminate()
    for server in servers:
        server.wait(10)
        server.stdout.close()


def going_around(time: float) -> np.ndarray:
    """Where the ball is, m: it goes around slowly, in view all the time."""
    angle = 2.0 * math.pi * time / PERIOD
    return np.array((0.25 * math.sin(angle), 0.15 * math.cos(angle), 1.6 + 0.2 * math.sin(angle)))


def leaving(time: float) -> np.ndarray:
    """Where the ball is, m: it begins in the middle and is out of view for a third of the time."""
    angle = 2.0 * math.pi * time / PERIOD
    return np.array((0.9 * (1.0 - math.cos(angle)), 0.1 * math.sin(angle), 1.6))


def filmed(folder: Path, place: Callable[[float], np.ndarray]) -> tuple[Path, BallFlightClip]:
    """Write a video that goes along a path ten times; only one time is rendered."""
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
    """A video of forty seconds, the ball in view all the time; and its truth: `clip.place(time)`, `clip.camera`."""
    return filmed(tmp_path_factory.mktemp("clip"), going_around)


@pytest.fixture(scope="session")
def leaving_clip(tmp_path_factory) -> tuple[Path, BallFlightClip]:
    """The same, but the ball leaves the picture between 1 and 3 s of each four."""
    return filmed(tmp_path_factory.mktemp("leaving"), leaving)
