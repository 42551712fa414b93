"""Pictures that waited, while a stream was opened or in its decoder, are left out: all are of now."""

import threading

import numpy as np
import numpy.typing as npt
import pytest

from cameras import PATIENCE, Camera
from matchset.media.streams.backlog import Backlog
from matchset.media.video import Video

URL = "udp://127.0.0.1:11111"


class Clock:
    """A clock that stands still unless somebody waits."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Timed(Camera):
    """Hands out pictures of gray values, each after so many seconds of a clock; then it says that there is none."""

    def __init__(self, clock: Clock, *pictures: tuple[float, int]) -> None:
        super().__init__("FFMPEG")
        self._clock, self._left, self._value = clock, list(pictures), 0
        self.asked = threading.Semaphore(0)

    def grab(self) -> bool:
        self.asked.acquire(timeout=PATIENCE)
        if not self._left:
            return False
        seconds, self._value = self._left.pop(0)
        self._clock.now += seconds
        return True

    def retrieve(self) -> tuple[bool, npt.NDArray[np.uint8]]:
        return True, np.full((6, 8, 3), self._value, np.uint8)

    def go_on(self, times: int) -> None:
        """Hand out so many of them."""
        self.asked.release(times)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr("matchset.media.camera_stream.monotonic", made)
    return made


def opens(monkeypatch: pytest.MonkeyPatch, clock: Clock, seconds: float, *cameras: Camera) -> None:
    """Let cameras be opened one after the other, each in so many seconds."""
    waiting = list(cameras)

    def open_capture(*_: object) -> Camera:
        clock.now += seconds
        return waiting.pop(0)

    monkeypatch.setattr("matchset.media.camera_stream.open_capture", open_capture)
    monkeypatch.setattr("matchset.media.camera_stream.open_pyav_stream", lambda *_: None)


def test_the_first_picture_is_one_that_did_not_wait(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    camera = Timed(clock, (0.01, 1), (0.001, 2), (0.001, 3), (0.001, 4), (0.03, 5), (0.001, 6))
    opens(monkeypatch, clock, 0.7, camera)
    camera.go_on(5)
    video = Video(URL)
    frame = next(video)
    assert (frame.image[0, 0, 0], frame.index) == (5, 4)
    assert video.dropped == 4
    camera.go_on(1)
    assert next(video).image[0, 0, 0] == 6  # of now, however soon it comes
    camera.go_on(100)
    video.close()


def test_what_the_decoder_held_when_the_stream_fell_silent_is_no_picture(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    notes: list[str] = []
    first = Timed(clock, (0.03, 1), (2.1, 2), (0.001, 3))
    second = Timed(clock, (0.03, 4))
    opens(monkeypatch, clock, 0.01, first, second)
    first.go_on(1)
    video = Video(URL, timeout=2.0, reconnect=30.0, note=notes.append)
    assert next(video).image[0, 0, 0] == 1
    first.go_on(2)
    second.go_on(1)
    after = next(video)
    assert (after.image[0, 0, 0], after.index) == (4, 1)
    assert after.time == pytest.approx(clock.now)
    assert notes[0].startswith(f"{URL} has delivered no picture for 2.1 s")
    second.go_on(100)
    video.close()


def test_what_had_to_be_waited_for_is_of_now_and_so_is_what_follows() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.7)
    assert backlog.holds(10.001, 0.050, 30.0)  # the decoder begins
    assert backlog.holds(10.002, 0.001, 30.0)
    assert not backlog.holds(10.030, 0.028, 30.0)
    assert not backlog.holds(10.031, 0.001, 30.0)


def test_a_stream_that_is_never_waited_for_is_read_all_the_same() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.7)
    assert backlog.holds(10.69, 0.001, None)
    assert not backlog.holds(10.71, 0.001, None)


def test_nothing_waits_where_the_opening_took_no_time() -> None:
    backlog = Backlog()
    backlog.begin(10.0, 0.01)
    assert not backlog.holds(10.0, 0.0, 30.0)
