"""The page in a real browser: a server in a process of its own, Chromium, and a rendered clip with its truth."""

import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.sim.clips.ball_flight_clip import BallFlightClip

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
CAMERA = ms.CameraModel.from_fov(320, 240, math.radians(60.0))
BALL = 0.28  # m, its diameter
FRAMES = 150


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
def browser() -> Iterator[object]:
    """Chromium; in CI it must be there, elsewhere the tests are skipped without it."""
    if CHROMIUM is None:
        assert not os.environ.get("CI"), "there is no chromium: .ci/browser installs it"
        pytest.skip("there is no chromium")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture
def page(browser) -> Iterator[object]:
    """A page of 1280 x 900; an error in its scripts fails the test."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, accept_downloads=True)
    page, errors = context.new_page(), []
    page.on("pageerror", lambda error: errors.append(str(error)))
    yield page
    context.close()
    assert not errors


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., str]]:
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


def place(time: float) -> np.ndarray:
    """Where the ball is, m: it goes around slowly, in view all the time."""
    angle = 0.8 * time
    return np.array((0.25 * math.sin(angle), 0.15 * math.cos(angle), 1.6 + 0.2 * math.sin(0.5 * angle)))


@pytest.fixture(scope="session")
def clip(tmp_path_factory) -> tuple[Path, BallFlightClip]:
    """A video of five seconds, and the clip with its truth: `clip.place`, `clip.camera`."""
    folder = tmp_path_factory.mktemp("clip")
    rendered = BallFlightClip(camera=CAMERA, place=place, frames=FRAMES)
    writer = cv2.VideoWriter(str(folder / "ball.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (320, 240))
    for frame in rendered:
        writer.write(frame.image)
    writer.release()
    return folder / "ball.avi", rendered
