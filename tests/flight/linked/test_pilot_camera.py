"""The camera of a real follower: it never makes the loop wait, and says what is wrong; a fake in place of a device."""

import threading
import time
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest
from fakes import Clock

from cameras import Camera
from matchset.camera.camera_model import CameraModel
from matchset.flight.linked import live_camera
from matchset.flight.linked.live_camera import LiveCamera
from matchset.flight.linked.parameters import LinkedParameters
from matchset.image.frame import Frame
from matchset.media.video import Video

MODEL = CameraModel.from_fov(8, 6, 1.0)
PARAMETERS = LinkedParameters(wait=0.02, silence=0.1)


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> Iterator[Camera]:
    fake = Camera()
    fake._pictures.append(np.full((6, 8, 3), 1, np.uint8))
    monkeypatch.setattr("matchset.media.camera_stream.open_capture", lambda *_: fake)
    yield fake
    fake.unplug()


def opened(delay_ms: float = 0.0) -> LiveCamera:
    return LiveCamera("camera 0", Video(0), MODEL, delay_ms, PARAMETERS)


def close(camera: LiveCamera, device: Camera) -> None:
    device.unplug()
    camera.close()
    assert device.released.is_set()


def test_pictures_have_times_of_its_own_clock(device: Camera) -> None:
    camera, late = opened(), 0.25
    camera.begin(time.monotonic() - late)
    device.show(2, 3)
    frame = camera.read()
    assert frame is not None
    assert frame.image[0, 0, 0] == 3
    assert 0.0 < frame.time <= camera.now()
    assert camera.now() >= late
    close(camera, device)


def test_a_camera_that_hangs_upside_down_is_turned(device: Camera) -> None:
    device._pictures[0] = picture = np.full((6, 8, 3), 1, np.uint8)
    picture[0, 0] = 7
    video = Video(0, turn=180, mirror=True)
    assert next(video).image[5, 0].tolist() == [7, 7, 7]
    assert (video.width, video.height) == (8, 6)
    device.unplug()
    video.close()


def test_a_known_delay_makes_pictures_older(device: Camera) -> None:
    camera = opened(delay_ms=80.0)
    frame = camera.read()
    assert frame is not None
    assert camera.now() - frame.time >= 0.08
    assert "80 ms are added" in camera.notes[0]
    assert "from their arrival" in camera.notes[0]
    close(camera, device)


def test_it_never_waits_longer_than_it_was_told(device: Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    clock, waits = Clock(), list[float]()
    video = Video(0)
    newest = video.newest

    def noted(wait: float) -> Frame | None:
        waits.append(wait)
        return newest(wait)

    monkeypatch.setattr(video, "newest", noted)
    camera = LiveCamera("camera 0", video, MODEL, 0.0, PARAMETERS, clock)
    assert camera.read() is not None
    assert camera.read() is None
    assert waits == [PARAMETERS.wait] * 2
    clock.sleep(PARAMETERS.silence)
    assert not camera.fault
    clock.sleep(0.01)
    assert camera.read() is None
    assert camera.fault.startswith("camera 0 has delivered no picture for 0.1 s")
    device.show(7)
    while camera.read() is None:
        pass
    assert not camera.fault
    close(camera, device)


def test_a_camera_that_fails_is_one_without_pictures(device: Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    monkeypatch.setattr(live_camera, "time", SimpleNamespace(sleep=clock.sleep))
    camera = LiveCamera("camera 0", Video(0), MODEL, 0.0, PARAMETERS, clock)
    assert camera.read() is not None
    device.fail(RuntimeError("the driver has lost it"))
    while not camera.fault:
        assert camera.read() is None
    assert camera.fault == "camera 0 failed: the driver has lost it"
    before = clock()
    assert camera.read() is None
    assert clock() - before == pytest.approx(PARAMETERS.wait)  # no loop that burns a core
    close(camera, device)


def test_a_stream_that_is_lost_is_one_without_pictures_until_it_is_back(monkeypatch: pytest.MonkeyPatch) -> None:
    first, second, there = Camera("FFMPEG"), Camera("FFMPEG"), threading.Event()
    for each, value in ((first, 1), (second, 2)):
        each._pictures.append(np.full((6, 8, 3), value, np.uint8))
    cameras = [first]

    def open_capture(*_: object) -> Camera:
        if cameras:
            return cameras.pop()
        there.wait(20.0)  # as long as FFmpeg may take
        return second

    monkeypatch.setattr("matchset.media.camera_stream.open_capture", open_capture)
    video = Video("http://drone/stream", timeout=0.02, reconnect=20.0)
    camera = LiveCamera("http://drone/stream", video, MODEL, 0.0, PARAMETERS)
    before = camera.read()
    assert before is not None
    first.unplug()
    end = time.monotonic() + 20.0
    while not camera.fault and time.monotonic() < end:
        assert camera.read() is None  # the opening, which waits for `there`, happens elsewhere
    assert camera.fault.startswith("http://drone/stream has delivered no picture for")
    assert camera.may_return
    there.set()
    frame = None
    while frame is None and time.monotonic() < end:
        frame = camera.read()
    assert frame is not None
    assert frame.image[0, 0, 0] == 2
    assert frame.time > before.time
    assert frame.index > before.index
    assert not camera.fault
    close(camera, second)


def test_one_that_fails_does_not_return(device: Camera) -> None:
    camera = opened()
    assert camera.read() is not None
    device.fail(RuntimeError("the driver has lost it"))
    end = time.monotonic() + 20.0
    while not camera.fault and time.monotonic() < end:
        camera.read()
    assert not camera.may_return
    close(camera, device)


def test_pictures_of_another_size_are_none(device: Camera) -> None:
    camera = opened()
    assert camera.read() is not None
    device.show(1, size=(3, 4, 3))
    end = time.monotonic() + 20.0
    while not camera.fault and time.monotonic() < end:
        camera.read()
    assert "frame" in camera.fault
    close(camera, device)


def test_stamps_of_the_driver_are_the_times_of_capture(device: Camera) -> None:
    camera, start = opened(), time.monotonic()
    camera.begin(start)
    taken = time.monotonic()  # a stamp before the last picture came would be no time of capture
    device.stamp = lambda: 1000.0 * taken
    device.show(5)
    frame = camera.read()
    assert frame is not None
    assert frame.time == pytest.approx(taken - start, abs=1e-6)
    assert camera.video.stamped
    assert camera.notes == []
    close(camera, device)


def test_what_a_camera_does_not_do_as_asked_is_said(device: Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(device, "set", lambda *_: False)
    camera = LiveCamera("camera 0", Video(0, exposure=20), MODEL, 0.0, PARAMETERS)
    assert camera.notes[1] == "camera 0: exposure: asked for 20, but this source has no such setting"
    close(camera, device)
