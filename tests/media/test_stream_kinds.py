"""Streams of three kinds that stop and come back: the ball is followed on, times and indices run forward."""

import time
from collections.abc import Iterator

import pytest

import matchset as ms
from cameras import PATIENCE
from matchset.media.streams.silence import ReopeningParameters
from stream_cameras import KINDS, RADIUS, StreamCamera

SOON = ReopeningParameters(first_pause_s=0.02, longest_pause_s=0.1)
BLUE = ms.ColorModel.hsv((100, 100, 60), (130, 255, 255))


class Follower:
    """Follows the ball in a stream; every picture is later than the one before."""

    def __init__(self, camera: StreamCamera) -> None:
        self.notes: list[str] = []
        self.video = ms.Video(camera.url, timeout=0.6, reconnect=3 * PATIENCE, note=self.notes.append)
        self._tracker = ms.Tracker(ms.Circle, BLUE)
        self._last: ms.Frame | None = None

    def find(self, times: int) -> None:
        """Read on until the ball was found so many times in a row."""
        found, end = 0, time.monotonic() + 3 * PATIENCE
        while found < times:
            assert time.monotonic() < end, self.notes
            answer = self._tracker.update(self._checked(next(self.video)))
            found = found + 1 if isinstance(answer, ms.Track) else 0
            if isinstance(answer, ms.Track):
                assert answer.shape.radius == pytest.approx(RADIUS, abs=6.0)

    def lose(self) -> None:
        """Read on until the stream is lost."""
        end = time.monotonic() + 2 * PATIENCE
        while len(self.notes) % 2 == 0:
            assert time.monotonic() < end
            if (frame := self.video.newest(0.02)) is not None:
                self._checked(frame)

    def check_notes(self) -> None:
        """Each loss has a line, and each return; on a busy computer there may be more of them than were made."""
        lost, back = self.notes[::2], self.notes[1::2]
        assert len(lost) == len(back) >= 1
        assert all("it is opened again, for 60 s at most" in line for line in lost)
        assert all("is back after" in line for line in back)

    def _checked(self, frame: ms.Frame) -> ms.Frame:
        assert frame.time <= time.monotonic()
        if self._last is not None:
            assert frame.time > self._last.time
            assert frame.index > self._last.index
        self._last = frame
        return frame


@pytest.fixture(params=list(KINDS.values()), ids=list(KINDS))
def camera(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[StreamCamera]:
    monkeypatch.setattr("matchset.media.camera_stream.REOPENING", SOON)
    with request.param() as made:
        yield made


def test_one_that_is_killed_and_started_again_or_stalls_is_followed_on(camera: StreamCamera) -> None:
    follower = Follower(camera)
    with follower.video:
        follower.find(5)
        camera.kill()
        follower.lose()
        camera.start()
        follower.find(5)
        follower.check_notes()
        assert follower.video.warnings[0].startswith("it was lost ")
        follower.notes.clear()
        camera.stall()
        follower.lose()
        assert follower.video.newest(0.02) is None
        camera.wake()
        follower.find(5)
    follower.check_notes()
    assert "has delivered no picture for" in follower.notes[0]
