"""The menu: what is found, that only keys of the menu open anything, and that changing does not wait."""

import os
import threading
from pathlib import Path
from typing import Any

import pytest

from matchset.camera.camera_model import CameraModel
from matchset.live.feed import Feed
from matchset.live.sources.cameras import CAPABILITIES, find_cameras
from matchset.live.sources.demo_clip import DemoParameters, demo_clip, place
from matchset.live.sources.found_sources import MenuParameters, Source, find_sources, given_source
from matchset.live.sources.messages import LookAgain, Show
from matchset.live.sources.opening import Opening, open_feed
from matchset.live.sources.panel import SourcesPanel
from matchset.live.sources.source_selection import SourceSelection
from matchset.media.video import Video

SHORT = DemoParameters(width=160, height=120, frames=5)


class Nothing(Feed):
    """A feed that shows nothing."""

    kind, title, streams, panels = "file", "nothing", (), ()

    def close(self) -> None:
        """There is nothing to close."""


def test_cameras_have_the_names_of_their_drivers_and_nodes_without_pictures_are_left_out(tmp_path: Path) -> None:
    devices, names = tmp_path / "dev", tmp_path / "names"
    for number in (0, 1, 2, 10):
        (devices / f"video{number}").mkdir(parents=True)
        (names / f"video{number}").mkdir(parents=True)
    (devices / "videos").mkdir()
    (names / "video0" / "name").write_text("HD Webcam\n")

    def ask(path: Path) -> tuple[str, bool]:
        if path.name == "video2":
            raise PermissionError(13, "Permission denied")
        return "a card", path.name != "video1"

    found = find_cameras(devices, names, ask)
    assert [(camera.device, camera.name) for camera in found] == [
        ("0", "HD Webcam"),
        ("2", "camera 2"),
        ("10", "a card"),
    ]
    assert "group video" in found[1].words


def test_a_node_that_is_no_video_device_is_told(tmp_path: Path) -> None:
    (tmp_path / "video0").touch()
    (camera,) = find_cameras(tmp_path, tmp_path)
    assert camera.name == "camera 0"
    assert "ioctl" in camera.words
    assert CAPABILITIES.size == 104


def test_the_videos_of_the_folder_are_the_newest_and_a_bounded_number(tmp_path: Path) -> None:
    for number in range(6):
        path = tmp_path / f"ball {number}.mp4"
        path.write_bytes(b"\0video")
        os.utime(path, (1000 + number, 1000 + number))
    (tmp_path / "notes.txt").touch()
    (tmp_path / "folder.mp4").mkdir()
    found = find_sources(tmp_path, MenuParameters(files=4), tmp_path)
    assert [each.name for each in found.entries if each.kind == "file"] == [f"ball {n}.mp4" for n in (5, 4, 3, 2)]
    assert "2 older videos" in found.words
    assert "no camera" in found.words
    assert {each.kind for each in found.entries} == {"file", "demo", "flight"}


def test_a_source_of_the_command_line_has_a_name_without_a_password() -> None:
    assert given_source("0").name == "camera 0"
    assert given_source("rtsp://me:secret@10.0.0.7/1").name == "rtsp://10.0.0.7/1"
    assert given_source("ball.mp4").name == "ball.mp4"
    assert given_source("rtsp://me:secret@10.0.0.7/1").origin == "rtsp://me:secret@10.0.0.7/1"


def test_an_empty_or_missing_folder_is_said(tmp_path: Path) -> None:
    assert "no video in" in find_sources(tmp_path, devices=tmp_path).words
    assert "no video in" in find_sources(tmp_path / "gone", devices=tmp_path).words


def test_a_name_of_any_bytes_is_shown(tmp_path: Path) -> None:
    (tmp_path / os.fsdecode(b"b\xffll.mp4")).write_bytes(b"\0video")
    (found,) = [each for each in find_sources(tmp_path, devices=tmp_path).entries if each.kind == "file"]
    assert found.name == "b?ll.mp4"


def test_the_demo_clip_is_rendered_once_and_has_its_camera(tmp_path: Path) -> None:
    path = demo_clip(SHORT, tmp_path)
    camera = CameraModel.load(path.with_suffix(".toml"))
    with Video(path) as video:
        assert (video.width, video.height) == (camera.width, camera.height) == (160, 120)
        assert len(list(video)) == 5
    before = path.stat().st_mtime_ns
    assert demo_clip(SHORT, tmp_path).stat().st_mtime_ns == before
    assert sorted(each.suffix for each in tmp_path.iterdir()) == [".avi", ".toml"]


def test_the_ball_of_the_demo_clip_stays_in_view() -> None:
    camera = CameraModel.from_fov(640, 480, DemoParameters().fov)
    for frame in range(DemoParameters().frames):
        (pixel,) = camera.project(place(frame / 30.0)[None])
        radius = 0.14 * camera.fx / place(frame / 30.0)[2]
        assert radius < pixel[0] < 640 - radius
        assert radius < pixel[1] < 480 - radius


class Shown:
    """What was shown, and a stage that shows it."""

    def __init__(self, folder: Path, make: Any = None) -> None:
        self.feeds: list[Any] = []
        self.stage = SourceSelection(folder, make or (lambda _: Nothing()), self.feeds.append)
        self.panel = SourcesPanel(self.stage, Source("given", "ball.mp4", "ball.mp4"))
        self.stage.look()


def wait(shown: Shown) -> None:
    """Wait until the stage has done what it was asked for."""
    shown.stage._thread.submit(lambda: None).result(20)


def test_a_key_of_the_menu_opens_and_nothing_else_does(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    wait(shown)
    with shown.stage:
        state = shown.panel.state()
        assert state.entries[0].name == "ball.mp4"
        for key in ("ball.mp4", "/etc/passwd", "http://example.com/", "source-99", "sim://demo"):
            with pytest.raises(ValueError, match="not there any more"):
                shown.panel.take(Show(key), "")
        assert not shown.feeds
        shown.panel.take(Show(state.entries[0].key), "")
        wait(shown)
        assert len(shown.feeds) == 1
        assert shown.panel.state().shown == state.entries[0].key


def test_a_file_that_came_is_found_and_keys_stay(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    wait(shown)
    with shown.stage:
        before = {each.name: each.key for each in shown.panel.state().entries}
        (tmp_path / "new.mp4").write_bytes(b"\0video")
        shown.panel.take(LookAgain(), "")
        wait(shown)
        after = {each.name: each.key for each in shown.panel.state().entries}
    assert set(after) - set(before) == {"new.mp4"}
    assert before.items() <= after.items()
    assert len(set(after.values())) == len(after)


def test_what_cannot_be_shown_is_said_and_what_was_shown_stays(tmp_path: Path) -> None:
    def make(source: Source) -> Feed:
        if source.kind == "flight":
            raise ValueError("not here")
        return Nothing()

    shown = Shown(tmp_path, make)
    wait(shown)
    with shown.stage:
        keys = {each.kind: each.key for each in shown.panel.state().entries}
        shown.panel.take(Show(keys["demo"]), "")
        shown.panel.take(Show(keys["flight"]), "")
        wait(shown)
        state = shown.panel.state()
    assert (state.shown, state.opening) == ("", "")  # the later one counts, the first was not begun any more
    assert state.fault == "simulated chain: not here"


def test_of_many_requests_the_last_counts(tmp_path: Path) -> None:
    begun, go_on = threading.Event(), threading.Event()
    made: list[str] = []

    def make(source: Source) -> Feed:
        made.append(source.kind)
        begun.set()
        go_on.wait(20)
        return Nothing()

    shown = Shown(tmp_path, make)
    wait(shown)
    with shown.stage:
        keys = {each.kind: each.key for each in shown.panel.state().entries}
        shown.panel.take(Show(keys["demo"]), "")
        assert begun.wait(20)
        for _ in range(100):
            shown.panel.take(Show(keys["flight"]), "")
        shown.panel.take(Show(keys["given"]), "")
        assert shown.panel.state().opening == "ball.mp4"
        go_on.set()
        wait(shown)
    assert made == ["demo", "given"]


def test_the_same_source_is_closed_before_it_is_opened_again(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    wait(shown)
    with shown.stage:
        (key,) = (each.key for each in shown.panel.state().entries if each.kind == "given")
        for _ in range(2):
            shown.panel.take(Show(key), "")
            wait(shown)
    assert [feed is None for feed in shown.feeds] == [False, True, False]


def test_an_error_that_nobody_expected_is_printed_and_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def make(_: Source) -> Feed:
        raise RuntimeError("a mistake")

    shown = Shown(tmp_path, make)
    wait(shown)
    with shown.stage:
        (key,) = (each.key for each in shown.panel.state().entries if each.kind == "given")
        shown.panel.take(Show(key), "")
        wait(shown)
        assert shown.panel.state().fault == "ball.mp4: RuntimeError: a mistake"
        assert not shown.panel.state().opening
    assert "RuntimeError: a mistake" in capsys.readouterr().err


def test_a_file_beside_a_video_that_is_no_camera_is_said(tmp_path: Path) -> None:
    path = demo_clip(SHORT, tmp_path)
    path.with_suffix(".toml").write_text("speed = 3")
    notes: list[str] = []
    with open_feed(Source("file", str(path), "a clip"), Opening(lambda _: None, notes.append)) as feed:
        assert feed.kind == "file"
    assert "the camera is not known" in notes[0]
    path.with_suffix(".toml").unlink()


def test_what_is_no_video_is_refused_in_words(tmp_path: Path) -> None:
    (tmp_path / "broken.mp4").write_bytes(b"this is no video")
    with pytest.raises(ValueError, match=r"broken\.mp4"):
        open_feed(Source("file", str(tmp_path / "broken.mp4"), "broken.mp4"), Opening(lambda _: None, print))


def test_a_flight_is_not_left_for_another_source(tmp_path: Path) -> None:
    flying = ["page 1 commands a flight: land first"]
    closed: list[str] = []

    class Opened(Nothing):
        def close(self) -> None:
            closed.append("closed")

    def make(_: Source) -> Feed:
        flying.append("it took off meanwhile")
        return Opened()

    stage = SourceSelection(tmp_path, make, lambda _: None, lambda: flying[-1] if flying else "")
    source = Source("demo", "sim://demo", "demo")
    with stage:
        with pytest.raises(ValueError, match="land first"):
            stage.show(source)
        assert stage.opening is None
        flying.clear()
        stage.show(source).result(20)
    assert stage.shown is None
    assert closed == ["closed"]
    assert stage.fault == "demo: it took off meanwhile"


def test_rendering_ends_with_the_program(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="ends"):
        demo_clip(SHORT, tmp_path, lambda: True)
    assert not list(tmp_path.glob("*.avi"))
