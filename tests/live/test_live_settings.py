"""The camera's settings in the page: what was asked for, and what the camera says it does."""

import math
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from fake_camera_live import SettableCamera
from matchset.image.errors import LinkError
from matchset.live.camera.device import CameraDevice
from matchset.live.camera.messages import SetCameraSetting, SetCameraSize
from matchset.live.camera.settings_panel import SettingsPanel, SettingState
from matchset.live.known_messages import READER
from matchset.live.sources.cameras import FoundCamera
from matchset.live.sources.found_sources import Source
from matchset.live.sources.opening import Opening, open_feed
from matchset.live.vision.camera_feed import CameraFeed
from matchset.live.wire.state import SessionState, written

PATIENCE = 20.0  # s; only ever spent where a test fails


def wait_for(condition: Callable[[], object]) -> None:
    """Wait until something holds."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


@pytest.fixture
def plug(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The camera is there while this file is."""
    path = tmp_path / "plug"
    path.touch()
    monkeypatch.setattr("matchset.media.camera_stream.open_capture", lambda *_: SettableCamera(path))
    monkeypatch.chdir(tmp_path)
    return path


@pytest.fixture
def feed(plug: Path) -> Iterator[tuple[CameraFeed, SettingsPanel, list[str]]]:
    notes: list[str] = []
    made = open_feed(Source("camera", "0", "camera 0"), Opening(lambda _: None, notes.append))
    assert isinstance(made, CameraFeed)
    with made:
        (panel,) = (each for each in made.panels if isinstance(each, SettingsPanel))
        wait_for(lambda: made.vision.seen.frame is not None)
        yield made, panel, notes


def setting(panel: SettingsPanel, name: str) -> SettingState:
    """What the page is told of a setting."""
    (found,) = (each for each in panel.state().settings if each.name == name)
    return found


def test_what_the_camera_has_is_shown_and_what_not(feed: tuple[CameraFeed, SettingsPanel, list[str]]) -> None:
    _, panel, _ = feed
    state = panel.state()
    assert [each.name for each in state.settings] == ["exposure", "white_balance", "fps"]
    assert state.missing == ["gain"]
    assert state.size == (320, 240)
    assert setting(panel, "exposure").automatic
    assert setting(panel, "fps").automatic is None
    assert written(SessionState(panels={"settings": state}))


def test_exposure_is_changed_at_once_and_a_limit_is_said(feed: tuple[CameraFeed, SettingsPanel, list[str]]) -> None:
    made, panel, _ = feed
    before = made.vision.seen.frame
    panel.take(SetCameraSetting("exposure", 1000.0), "")
    wait_for(lambda: setting(panel, "exposure").value == 1000.0)
    assert setting(panel, "exposure").automatic is False
    wait_for(lambda: int(made.vision.seen.frame.image[0, 0, 0]) > 100)  # type: ignore[union-attr]
    assert before is not None
    panel.take(SetCameraSetting("exposure", 5000.0), "")
    wait_for(lambda: setting(panel, "exposure").words)
    assert setting(panel, "exposure").words == "exposure: asked for 5000, the driver says 2047"
    assert setting(panel, "exposure").asked == 5000.0
    panel.take(SetCameraSetting("exposure", None), "")
    wait_for(lambda: setting(panel, "exposure").automatic)
    assert setting(panel, "exposure").asked is None
    assert not setting(panel, "exposure").words


def test_a_size_opens_the_camera_again_and_another_than_asked_is_said(
    feed: tuple[CameraFeed, SettingsPanel, list[str]],
) -> None:
    made, panel, notes = feed
    panel.take(SetCameraSetting("exposure", 500.0), "")
    panel.take(SetCameraSize(640, 480), "")
    wait_for(lambda: made.vision.seen.state.width == 640)
    assert "640 x 480" in notes[-1]
    wait_for(lambda: panel.state().size == (640, 480))
    assert setting(panel, "exposure").value == 500.0  # asked for again
    panel.take(SetCameraSize(1920, 1080), "")
    wait_for(lambda: panel.state().size_words)
    assert "asked for 1920, the driver says 640" in panel.state().size_words
    assert panel.state().asked_size == (1920, 1080)


def test_a_rate_that_is_refused_is_said(feed: tuple[CameraFeed, SettingsPanel, list[str]]) -> None:
    _, panel, _ = feed
    panel.take(SetCameraSetting("fps", 120.0), "")
    wait_for(lambda: setting(panel, "fps").words)
    assert "the driver says 30" in setting(panel, "fps").words


def test_a_setting_that_the_camera_does_not_have_is_refused(feed: tuple[CameraFeed, SettingsPanel, list[str]]) -> None:
    _, panel, _ = feed
    with pytest.raises(ValueError, match="no such setting"):
        panel.take(SetCameraSetting("gain", 1.0), "")
    with pytest.raises(ValueError, match="finite"):
        panel.take(SetCameraSetting("exposure", math.nan), "")


def test_settings_are_asked_for_again_when_the_camera_comes_back(
    feed: tuple[CameraFeed, SettingsPanel, list[str]], plug: Path
) -> None:
    made, panel, _ = feed
    panel.take(SetCameraSetting("exposure", 700.0), "")
    wait_for(lambda: setting(panel, "exposure").value == 700.0)
    plug.unlink()
    wait_for(lambda: made.vision.seen.state.fault)
    plug.touch()
    wait_for(lambda: not made.vision.seen.state.fault)
    wait_for(lambda: setting(panel, "exposure").value == 700.0)


def test_a_camera_that_has_another_number_when_it_comes_back_is_found_by_its_name() -> None:
    there = [FoundCamera("0", "HD Webcam", ""), FoundCamera("1", "other", "")]
    opened: list[str] = []

    def open_camera(device: str, _: Mapping[str, float]) -> Any:
        if device not in [each.device for each in there]:
            raise LinkError(f"cannot open camera {device}")
        opened.append(device)

    camera = CameraDevice("0", open_camera, lambda: there)
    camera()
    there[0] = FoundCamera("2", "HD Webcam", "")
    camera()
    assert opened == ["0", "2"]
    there[:] = [FoundCamera("3", "HD Webcam", ""), FoundCamera("4", "HD Webcam", "")]
    with pytest.raises(LinkError, match="camera 2"):
        camera()  # which of the two?


def test_a_camera_that_was_never_open_has_no_settings() -> None:
    panel = SettingsPanel(CameraDevice("0"), lambda: None)
    assert not panel.state().opened
    assert panel.state().size is None
    with pytest.raises(ValueError, match="no such setting"):
        panel.take(SetCameraSize(640, 480), "")


@pytest.mark.parametrize(
    "text",
    [
        '{"type": "set_camera", "name": "exposure", "value": "abc"}',
        '{"type": "set_camera", "name": "shutter", "value": 1}',
        '{"type": "set_camera", "name": "exposure", "value": 1e99}',
        '{"type": "set_camera_size", "width": 0, "height": 480}',
        '{"type": "set_camera_size", "width": 640.5, "height": 480}',
    ],
)
def test_nonsense_is_no_message(text: str) -> None:
    with pytest.raises(ValueError, match="no message"):
        READER.read(text)


def test_wishes_of_a_page_are_messages() -> None:
    wish: Any = READER.read('{"type": "set_camera", "name": "exposure", "value": null}')
    assert wish == SetCameraSetting("exposure", None)
