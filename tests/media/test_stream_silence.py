"""A live source that is lost and comes back, with fakes in the place of OpenCV's capture; no test sleeps."""

import threading
import time
from collections.abc import Callable

import cv2
import numpy as np
import pytest

from cameras import PATIENCE, Camera
from matchset.image.errors import LinkError
from matchset.media.camera_stream import REOPENING, StreamParameters
from matchset.media.streams.silence import Pauses, ReopeningParameters
from matchset.media.video import Video

URL = "http://me:secret@drone/stream"
NAME = "http://drone/stream"
SOON = ReopeningParameters(first_pause_s=0.001, longest_pause_s=0.01)


class Device:
    """What `open_capture` opens: one camera after the other, and none while there is none."""

    def __init__(self) -> None:
        self.cameras: list[Camera] = []
        self.opened = 0

    def __call__(self, *_: object) -> Camera:
        self.opened += 1
        if self.cameras:
            return self.cameras.pop(0)
        gone = Camera("FFMPEG")
        gone.opened = False
        return gone

    def add(self, value: int, size: tuple[int, ...] = (6, 8, 3)) -> Camera:
        """Let a camera be there the next time, with a first picture of this gray value."""
        camera = Camera("FFMPEG")
        camera._pictures.append(np.full(size, value, np.uint8))
        self.cameras.append(camera)
        return camera


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> Device:
    made = Device()
    monkeypatch.setattr("matchset.media.camera_stream.open_capture", made)
    monkeypatch.setattr("matchset.media.camera_stream.REOPENING", SOON)
    return made


def gray(video: Video) -> int:
    return int(next(video).image[0, 0, 0])


def wait_for(condition: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.001)


def test_a_stream_that_breaks_off_is_opened_again_and_goes_on(device: Device) -> None:
    notes: list[str] = []
    first = device.add(1)
    with Video(URL, timeout=PATIENCE, reconnect=PATIENCE, note=notes.append) as video:
        before = next(video)
        first.show(2, 3)
        before = next(video)
        second = device.add(7)
        first.unplug()
        after = next(video)
        assert after.image[0, 0, 0] == 7
        assert after.index == before.index + 1
        assert before.time < after.time <= time.monotonic()
        assert first.released.is_set()
        second.show(8)
        assert next(video).index == after.index + 1
        second.unplug()
    assert notes[0] == f"{NAME} broke off; it is opened again, for {PATIENCE:g} s at most"
    assert notes[1].startswith(f"{NAME} is back after 0.")
    assert len(notes) <= 3  # it may have noticed that it broke off once more
    assert device.opened <= 3
    assert video.warnings[0].startswith("it was lost 1 time, for 0.")


def test_it_is_tried_until_it_is_there(device: Device) -> None:
    notes: list[str] = []
    first = device.add(1)
    video = Video(URL, timeout=PATIENCE, reconnect=PATIENCE, note=notes.append)
    assert gray(video) == 1
    first.unplug()
    wait_for(lambda: device.opened > 5)
    assert len(notes) == 1
    second = device.add(9)
    assert gray(video) == 9
    wait_for(lambda: len(notes) == 2)
    second.unplug()
    video.close()


def test_one_that_opens_and_breaks_off_at_once_is_not_back(device: Device) -> None:
    notes: list[str] = []
    first = device.add(1)
    for _ in range(3):
        useless = device.add(0)
        useless._pictures.clear()
        useless.unplug()
    device.add(4)
    video = Video(URL, timeout=PATIENCE, reconnect=PATIENCE, note=notes.append)
    next(video)
    last = device.cameras[-1]
    first.unplug()
    assert gray(video) == 4
    wait_for(lambda: len(notes) == 2)
    assert device.opened == 5
    last.unplug()
    video.close()


def test_one_that_stays_away_is_a_broken_link_in_the_end(device: Device) -> None:
    notes: list[str] = []
    first = device.add(1)
    video = Video(URL, timeout=0.02, reconnect=0.05, note=notes.append)
    next(video)
    first.unplug()
    with pytest.raises(LinkError, match=f"^{NAME} has delivered no picture for 0\\.") as caught:
        next(video)
    assert "secret" not in str(caught.value)
    wait_for(lambda: first.released.is_set() and not _threads())
    with pytest.raises(LinkError, match="has delivered no picture for"):
        video.newest(0.01)
    assert len(notes) == 1
    video.close()


def test_one_of_which_every_picture_is_damaged_says_so(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    hasty = StreamParameters(first_picture_s=0.05)
    monkeypatch.setattr("matchset.media.camera_stream.DEFAULT", hasty)
    damaged = [True]
    monkeypatch.setattr("matchset.media.camera_stream.reports_damage", lambda _: damaged[0])
    device.add(1)
    words = f"^{NAME} has delivered no whole picture for .* damaged ones were left out .--damaged"
    with pytest.raises(LinkError, match=words) as caught:
        Video(URL, timeout=0.05, reconnect=0.0)
    assert not isinstance(caught.value, ValueError)
    damaged[0] = False
    device.add(1)
    with Video(URL, timeout=PATIENCE, reconnect=0.0) as video:
        assert gray(video) == 1


def _threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name.startswith("matchset")]


def test_a_camera_is_opened_again_only_where_that_is_asked_for(device: Device) -> None:
    camera = device.add(1)
    with Video(0, timeout=0.02) as video:
        assert video.reconnect == 0.0
        next(video)
        camera.unplug()
        with pytest.raises(LinkError, match=r"camera 0 has delivered no picture for 0\.02 s"):
            next(video)
    assert device.opened == 1


def test_a_camera_that_is_opened_again_gets_its_settings_again(device: Device) -> None:
    first, second = device.add(1), device.add(2)
    with Video(0, exposure=20, timeout=0.02, reconnect=PATIENCE) as video:
        next(video)
        first.unplug()
        assert gray(video) == 2
        assert second.set_to[cv2.CAP_PROP_EXPOSURE] == 20.0
        assert video.settings == {"exposure": (20.0, 20.0)}
        second.unplug()


def test_a_stream_has_ten_seconds_of_its_own(device: Device) -> None:
    camera = device.add(1)
    with Video(URL) as video:
        assert video.reconnect == REOPENING.stream_s == 10.0
        camera.unplug()


def test_a_recording_behind_an_address_ends(device: Device) -> None:
    camera = device.add(1)
    camera.values[cv2.CAP_PROP_FRAME_COUNT] = 200.0
    with Video(URL + "/ball.mp4", timeout=0.02, reconnect=PATIENCE) as video:
        assert video.reconnect == 0.0
        next(video)
        camera.unplug()
        with pytest.raises(LinkError, match="if it is a file, not a stream, download it"):
            next(video)
    assert device.opened == 1


def test_pictures_of_another_size_after_the_return_are_refused(device: Device) -> None:
    first, second = device.add(1), device.add(2, size=(12, 16, 3))
    with Video(URL, timeout=PATIENCE, reconnect=PATIENCE) as video:
        next(video)
        first.unplug()
        with pytest.raises(ValueError, match="frame 1 is 16 x 12 in color, those before it are 8 x 6 in color"):
            next(video)
        second.unplug()


def test_a_loop_that_asks_for_the_newest_picture_goes_on_meanwhile(device: Device) -> None:
    first = device.add(1)
    video = Video(URL, timeout=PATIENCE, reconnect=PATIENCE)
    assert video.newest(PATIENCE) is not None
    first.unplug()
    wait_for(lambda: device.opened > 2)
    assert video.newest(0.001) is None
    second = device.add(5)
    frame = video.newest(PATIENCE)
    assert frame is not None
    assert frame.image[0, 0, 0] == 5
    second.unplug()
    video.close()


def test_who_wants_to_stop_need_not_wait_for_the_return(device: Device) -> None:
    first, stop = device.add(1), threading.Event()
    with Video(URL, timeout=PATIENCE, reconnect=PATIENCE) as video:
        frames = video.until(stop.is_set)
        assert next(frames).index == 0
        first.unplug()
        wait_for(lambda: device.opened > 2)
        threading.Timer(0.01, stop.set).start()
        assert list(frames) == []


def test_closing_ends_the_attempts(device: Device) -> None:
    first = device.add(1)
    video = Video(URL, timeout=PATIENCE, reconnect=PATIENCE)
    next(video)
    first.unplug()
    wait_for(lambda: device.opened > 2)
    video.close()
    assert not _threads()


def test_the_pauses_grow_and_begin_anew_after_it_has_delivered_for_a_while() -> None:
    parameters = ReopeningParameters(first_pause_s=0.1, growth=2.0, longest_pause_s=0.5)
    pauses = Pauses(parameters)
    assert [pauses.next() for _ in range(6)] == pytest.approx([0.0, 0.1, 0.2, 0.4, 0.5, 0.5])
    pauses.begin(0.4)  # one that comes for a moment and goes again
    assert pauses.next() == 0.5
    pauses.begin(0.5)
    assert pauses.next() == 0.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"reconnect": -1.0}, "reconnect must be a time in s, 0 for none, got -1"),
        ({"reconnect": float("nan")}, "got nan"),
        ({"reconnect": float("inf")}, "got inf"),
        ({"timeout": 0.0}, "timeout must be positive, got 0"),
        ({"timeout": float("inf")}, "timeout must be positive, got inf"),
    ],
)
def test_times_that_are_none_are_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Video(URL, **options)  # type: ignore[arg-type]


def test_a_time_is_a_number() -> None:
    with pytest.raises(TypeError, match="reconnect must be a number, got '5'"):
        Video(URL, reconnect="5")  # type: ignore[arg-type]
