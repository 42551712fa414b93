"""What tests share: the command line in an empty folder, a small video, a short flight, a transmitter, signals."""

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import settings
from pty_transmitter import PtyTransmitter

from blue_ball import CENTERS, SIZE, Matchset, ball_picture
from chain_flight import Flown, fly
from matchset import cli
from matchset.app.locate import path_picture
from matchset.flight.real_time.memory import steady_memory

settings.register_profile("no clock", deadline=None)  # beside other work an example now and then takes a second
settings.load_profile("no clock")


def pytest_configure() -> None:
    """Run as a user does, where all was started with real-time priority: what tests start inherits it.

    One that computes then lets no other run, and none of the kernel's threads that carry a pseudo-terminal's bytes.
    """
    if hasattr(os, "sched_setscheduler"):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Say which test has left real-time priority behind, and end it: the other worker's tests would run out of time."""
    if hasattr(os, "sched_getscheduler") and (policy := os.sched_getscheduler(0)) != os.SCHED_OTHER:
        level = os.sched_getparam(0).sched_priority
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        print(f"\n{item.nodeid} left policy {policy}, priority {level}", file=sys.__stderr__, flush=True)


@pytest.fixture(scope="session", autouse=True)
def tests_stay_in_memory() -> Iterator[None]:
    """Let no collection of garbage look at thousands of tests again: each flight begins with one, two seconds here."""
    with steady_memory():
        yield


@pytest.fixture
def transmitter() -> Iterator[PtyTransmitter]:
    with PtyTransmitter() as opened:
        yield opened


@pytest.fixture
def signals_end_programs() -> Iterator[None]:
    """Start programs as a shell does, although the tests may themselves run where SIGHUP or SIGINT is ignored."""
    hangup, interrupt = signal.signal(signal.SIGHUP, signal.SIG_DFL), signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGHUP, hangup)
    signal.signal(signal.SIGINT, interrupt)


@pytest.fixture(scope="session")
def ball_video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ball") / "my ball.mp4"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, SIZE)
    for center in CENTERS:
        writer.write(ball_picture(center))
    writer.release()
    return path


@pytest.fixture
def matchset(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Matchset:
    """Run the command line in an empty folder; returns the exit code."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> int:
        monkeypatch.setattr("sys.argv", ["matchset", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        code = ended.value.code
        assert isinstance(code, int)
        return code

    return run


@pytest.fixture
def no_path_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave `poses.png` black, of which those of `app/locate/test_path_picture.py` are: drawing it takes a while."""
    monkeypatch.setattr(path_picture, "path_picture", lambda *_: np.zeros((8, 8, 3), np.uint8))


@pytest.fixture(scope="session")
def flown() -> Flown:
    """A short flight of a chain of three."""
    return fly()
