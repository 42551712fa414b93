"""A small video of two balls for the tests of recorded videos, and a feed that shows it."""

import math
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from matchset.live.files.file_feed import FileFeed
from matchset.live.files.messages import Seek
from matchset.live.files.run import TrackingRun
from matchset.media.frame_list import StampedVideo

FRAMES, WIDTH, HEIGHT = 60, 320, 240
CLICK = 25
NOTHING = 300.0, 10.0  # px, where there is no ball


def center(index: int) -> tuple[float, float]:
    """Where the blue ball is, px."""
    return 160.0 + 90.0 * math.sin(0.09 * (index - 30)), 120.0 + 0.5 * index


def written(folder: Path) -> Path:
    """Write the video."""
    video = folder / "ball.avi"
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (WIDTH, HEIGHT))
    for index in range(FRAMES):
        image = np.random.default_rng(index).integers(85, 95, (HEIGHT, WIDTH, 3)).astype(np.uint8)
        x, y = center(index)
        cv2.circle(image, (round(16 * x), round(16 * y)), 22 * 16, (200, 60, 30), cv2.FILLED, cv2.LINE_AA, 4)
        writer.write(image)
    writer.release()
    return video


def wait(condition: Callable[[], object], seconds: float = 60.0) -> None:
    """Wait until something holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "not in time"
        time.sleep(0.005)


def opened(path: Path, notes: list[str], news: Callable[[int], None] = lambda _: None) -> FileFeed:
    """A feed that shows it."""
    return FileFeed(path.name, lambda: StampedVideo(path), news, notes.append)


def go(feed: FileFeed, index: int) -> int:
    """Show a frame; returns the number of its picture."""
    feed.panel.take(Seek(index), "")
    wait(lambda: feed.seen.state.index == index)
    return feed.seen.state.sequence


class Gate:
    """Lets the tracking take a number of steps, then no more until it is told.

    Parameters
    ----------
    monkeypatch : MonkeyPatch
    steps : int
        Before it closes.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, steps: int) -> None:
        self._steps, self._step, self._open = steps, TrackingRun.step, threading.Event()
        gate = self

        def guarded(run: Any) -> None:
            gate.pass_through()
            gate._step(run)

        monkeypatch.setattr(TrackingRun, "step", guarded)

    def pass_through(self) -> None:
        """Take a step, or wait."""
        if self._steps > 0:
            self._steps -= 1
            return
        self._open.wait(60.0)

    def open(self) -> None:
        """Let all pass from here on."""
        self._open.set()
