"""Settings of a camera, read and changed while pictures come; a fake stands in the place of OpenCV's capture."""

import cv2
import numpy as np
import pytest

from cameras import Camera
from fake_camera_live import SettableCamera
from matchset.media.camera_stream import LiveSource
from matchset.media.streams.camera_settings import Control, apply, read_controls
from matchset.media.streams.silence import Silence


def test_the_settings_that_a_camera_has_are_read_and_others_left_out() -> None:
    assert read_controls(SettableCamera()) == {
        "width": Control(320.0, None),
        "height": Control(240.0, None),
        "fps": Control(30.0, None),
        "exposure": Control(156.0, True),
        "white_balance": Control(4600.0, True),
    }


def test_both_sides_of_a_size_are_set_before_either_is_read() -> None:
    camera = SettableCamera()
    assert apply(camera, {"height": 480.0, "width": 640.0}) == {"width": (640.0, 640.0), "height": (480.0, 480.0)}
    assert apply(camera, {"width": 1920.0, "height": 1080.0})["width"] == (1920.0, 640.0)


def test_what_is_refused_is_told() -> None:
    camera = SettableCamera()
    assert apply(camera, {"gain": 3.0, "exposure": 5000.0}) == {"exposure": (5000.0, 2047.0), "gain": (3.0, None)}
    assert camera.get(cv2.CAP_PROP_AUTO_EXPOSURE) == 1.0
    assert apply(camera, {"fps": 60.0}) == {"fps": (60.0, 30.0)}


@pytest.fixture
def camera(monkeypatch: pytest.MonkeyPatch) -> Camera:
    fake = Camera()
    fake.values |= {cv2.CAP_PROP_EXPOSURE: 100.0, cv2.CAP_PROP_AUTO_EXPOSURE: 3.0, cv2.CAP_PROP_GAIN: 4.0}
    fake._pictures.append(np.full((6, 8, 3), 1, np.uint8))
    monkeypatch.setattr("matchset.media.camera_stream.open_capture", lambda *_: fake)
    return fake


def test_settings_are_changed_by_the_thread_that_reads(camera: Camera) -> None:
    live = LiveSource(0, "camera 0", Silence(2.0), {})
    assert live.settings == {}
    assert live.controls["exposure"] == Control(100.0, True)
    live.adjust("exposure", 50.0)
    live.adjust("gain", 7.0)
    camera.show(2, 3)
    assert live.settings == {"exposure": (50.0, 50.0), "gain": (7.0, 7.0)}
    assert live.controls["exposure"] == Control(50.0, False)
    live.adjust("exposure", None)
    camera.show(4, 5)
    assert live.settings == {"gain": (7.0, 7.0)}
    assert live.controls["exposure"] == Control(50.0, True)
    with pytest.raises(ValueError, match="cannot be changed while"):
        live.adjust("width", 640.0)
    camera.unplug()
    live.close()


def test_other_systems_say_0_and_1() -> None:
    camera = Camera(backend="AVFOUNDATION")
    camera.values |= {cv2.CAP_PROP_EXPOSURE: 0.5, cv2.CAP_PROP_AUTO_EXPOSURE: 1.0}
    assert read_controls(camera)["exposure"] == Control(0.5, True)
    apply(camera, {"exposure": 0.25})
    assert read_controls(camera)["exposure"] == Control(0.25, False)
