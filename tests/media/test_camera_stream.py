"""Cameras and streams, with a fake in the place of OpenCV's capture; no test sleeps."""

import gc
import threading
import time

import cv2
import numpy as np
import pytest

from cameras import PATIENCE, Camera
from matchset.image.errors import LinkError
from matchset.media.camera_stream import StreamParameters
from matchset.media.video import Video


@pytest.fixture
def camera(monkeypatch: pytest.MonkeyPatch) -> Camera:
    fake = Camera()
    fake._pictures.append(np.full((6, 8, 3), 1, np.uint8))
    monkeypatch.setattr("matchset.media.camera_stream.open_capture", lambda *_: fake)
    monkeypatch.setattr("matchset.media.camera_stream.open_pyav_stream", lambda *_: None)
    return fake


def gray(video: Video) -> int:
    return int(next(video).image[0, 0, 0])


def shut(video: Video, camera: Camera) -> None:
    camera.unplug()
    video.close()
    assert camera.released.is_set()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("matchset")]


def test_the_newest_frame_wins_and_the_others_are_counted(camera: Camera) -> None:
    video = Video(0)
    assert (video.width, video.height, video.live, video.length, video.fps) == (8, 6, True, None, 30.0)
    assert gray(video) == 1
    camera.show(2, 3, 4)
    frame = next(video)
    assert (frame.image[0, 0, 0], frame.index) == (4, 3)
    assert video.dropped == 2
    camera.show(5)
    assert gray(video) == 5
    assert (video.dropped, video.broken) == (2, 0)
    shut(video, camera)


def test_a_reader_waits_for_the_next_frame(camera: Camera) -> None:
    video = Video("0", timeout=PATIENCE)
    assert gray(video) == 1
    results: list[int] = []
    reader = threading.Thread(target=lambda: results.append(gray(video)))
    reader.start()
    camera.show(7)
    reader.join(PATIENCE)
    assert results == [7]
    assert video.dropped == 0
    shut(video, camera)


def test_broken_frames_are_counted_and_keep_their_number(camera: Camera) -> None:
    video = Video(0)
    next(video)
    camera.show(2, None, None, 5)
    assert next(video).index == 4
    assert video.broken == 2
    assert video.warnings == ["2 broken frames skipped"]
    shut(video, camera)


def test_silence_is_a_broken_link(camera: Camera) -> None:
    video = Video(0, timeout=0.02)
    next(video)
    with pytest.raises(LinkError, match=r"^camera 0 has delivered no picture for 0\.02 s$"):
        next(video)
    camera.show(9)
    assert gray(video) == 9  # it came back
    shut(video, camera)


def test_an_unplugged_camera_is_a_broken_link(camera: Camera) -> None:
    video = Video(0, timeout=0.02)
    next(video)
    camera.unplug()
    with pytest.raises(LinkError, match="camera 0 has delivered no picture"):
        next(video)
    shut(video, camera)


def test_a_driver_that_raises_is_a_broken_link(camera: Camera) -> None:
    video = Video(0, timeout=PATIENCE)
    next(video)
    camera.fail(RuntimeError("select()\n timed out"))
    with pytest.raises(LinkError, match=r"^camera 0 failed: select\(\) timed out$"):
        next(video)
    shut(video, camera)


def test_a_camera_that_does_not_open_is_a_broken_link(camera: Camera) -> None:
    camera.opened = False
    with pytest.raises(LinkError, match="cannot open camera 3"):
        Video(3)


def test_a_camera_without_a_first_picture_is_closed_again(camera: Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("matchset.media.camera_stream.DEFAULT", StreamParameters(first_picture_s=0.02))
    camera._pictures.clear()
    camera.unplug()
    with pytest.raises(LinkError, match=r"no picture for 0\.02 s"):
        Video(0, timeout=0.02)
    assert camera.released.wait(PATIENCE)


def test_no_such_camera_is_a_broken_link(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(LinkError, match="cannot open camera 97"):
        Video(97)
    assert capfd.readouterr().err == ""


def test_a_negative_camera_number_is_refused() -> None:
    with pytest.raises(ValueError, match="must not be negative, got -1"):
        Video(-1)


@pytest.mark.parametrize("url", ["rtsp://me:secret@drone.local/live", "http://h/a@b.mjpg", "udp://0.0.0.0:11111"])
def test_a_url_is_live_and_messages_hide_its_password(camera: Camera, url: str) -> None:
    camera.backend = "FFMPEG"
    video = Video(url, timeout=0.02, reconnect=0.0)
    assert video.live
    next(video)
    with pytest.raises(LinkError, match="has delivered no picture") as caught:
        next(video)
    assert "secret" not in str(caught.value)
    shut(video, camera)


def test_time_is_the_drivers_stamp_where_it_makes_sense(camera: Camera) -> None:
    earlier = time.monotonic() - 0.05
    camera.stamp = lambda: 1000.0 * earlier
    video = Video(0)
    assert next(video).time == pytest.approx(earlier, abs=1e-5)
    camera.show(2)
    assert next(video).time > earlier  # the same stamp again: time runs forward all the same
    shut(video, camera)


@pytest.mark.parametrize(("backend", "stamp"), [("V4L2", 0.0), ("V4L2", 1.7e12), ("FFMPEG", None)])
def test_time_is_the_arrival_where_the_stamp_is_of_another_clock(
    camera: Camera, backend: str, stamp: float | None
) -> None:
    camera.backend = backend
    before = time.monotonic()
    camera.stamp = lambda: 1000.0 * (before - 0.01) if stamp is None else stamp
    video = Video(0)
    first = next(video)
    assert before <= first.time <= time.monotonic()
    camera.show(2)
    assert next(video).time > first.time
    shut(video, camera)


def test_the_newest_frame_or_none_without_waiting_long(camera: Camera) -> None:
    video = Video(0, timeout=PATIENCE)
    first = video.newest(0.02)
    assert first is not None
    begin = time.monotonic()
    assert video.newest(0.02) is None
    assert time.monotonic() - begin < PATIENCE / 2  # real time is asked for here; `next` would wait for PATIENCE
    camera.stamp = lambda: 1000.0 * (time.monotonic() - 0.001)
    assert not video.stamped
    camera.show(2, 3)
    frame = video.newest(0.02)
    assert frame is not None
    assert frame.image[0, 0, 0] == 3
    assert video.stamped
    camera.show(4, size=(12, 16, 3))
    with pytest.raises(ValueError, match="those before it are 8 x 6"):
        video.newest(0.02)
    camera.fail(RuntimeError("out of memory"))
    assert camera.released.wait(PATIENCE)
    with pytest.raises(LinkError, match="out of memory"):
        video.newest(0.02)
    shut(video, camera)
    with pytest.raises(ValueError, match="camera 0 is closed"):
        video.newest(0.02)


def test_settings_are_set_read_back_and_reported(camera: Camera) -> None:
    camera.fixed = {cv2.CAP_PROP_EXPOSURE: 156.0}
    video = Video(0, exposure=20, white_balance=4600, fps=30)
    assert video.settings == {
        "exposure": (20.0, 156.0),
        "white_balance": (4600.0, 4600.0),
        "fps": (30.0, 30.0),
    }
    assert video.warnings == ["exposure: asked for 20, the driver says 156"]
    assert camera.set_to[cv2.CAP_PROP_AUTO_EXPOSURE] == 1.0
    assert camera.set_to[cv2.CAP_PROP_AUTO_WB] == 0.0
    shut(video, camera)


def test_a_setting_the_camera_does_not_have_is_reported(camera: Camera, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(camera, "set", lambda *_: False)
    video = Video(0, exposure=20)
    assert video.settings == {"exposure": (20.0, None)}
    assert video.warnings == ["exposure: asked for 20, but this source has no such setting"]
    shut(video, camera)


def test_a_live_picture_that_changes_size_is_refused(camera: Camera) -> None:
    video = Video(0)
    next(video)
    camera.show(2, size=(12, 16, 3))
    with pytest.raises(ValueError, match="frame 1 is 16 x 12 in color, those before it are 8 x 6 in color"):
        next(video)
    shut(video, camera)


def test_leaving_the_block_releases_the_device(camera: Camera) -> None:
    with Video(0) as video:
        next(video)
        camera.unplug()
    assert camera.released.is_set()
    with pytest.raises(ValueError, match="camera 0 is closed"):
        next(video)


def test_a_thread_stuck_in_the_driver_lets_go_when_it_comes_back(camera: Camera) -> None:
    video = Video(0, timeout=0.02)
    next(video)
    video.close()
    assert not camera.released.is_set()
    camera.unplug()
    assert camera.released.wait(PATIENCE)


def test_closing_wakes_a_waiting_reader(camera: Camera) -> None:
    video = Video(0, timeout=PATIENCE)
    next(video)
    errors: list[str] = []

    def read() -> None:
        try:
            next(video)
        except ValueError as error:
            errors.append(str(error))

    reader = threading.Thread(target=read)
    reader.start()
    camera.unplug()
    video.close()
    reader.join(PATIENCE)
    assert errors == ["camera 0 is closed"]


def test_a_forgotten_video_is_closed(camera: Camera) -> None:
    video = Video(0)
    next(video)
    camera.unplug()
    del video
    gc.collect()
    assert camera.released.wait(PATIENCE)
