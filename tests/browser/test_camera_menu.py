"""From `matchset live` without a source to meters: the menu, the demo clip, a click, a diameter."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from live_pages import WAIT, on_screen, wait_until, wait_until_compiled
from matchset.camera.camera_model import CameraModel
from matchset.live.sources.demo_clip import DemoParameters, demo_clip, place

SHORT = DemoParameters(frames=300)


@pytest.fixture(scope="session")
def kept_demo(tmp_path_factory: Any) -> Path:
    """A cache folder in which the demo clip is already."""
    folder: Path = tmp_path_factory.mktemp("cache")
    (folder / "matchset").mkdir()
    demo_clip(SHORT, folder / "matchset")
    return folder


def test_demo_clip_click_and_diameter_give_meters(serve: Any, page: Any, kept_demo: Path, monkeypatch: Any) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(kept_demo))
    page.goto(serve())
    page.get_by_role("button", name="demo clip").click(timeout=WAIT)
    wait_until(page, "picture.width === 640")
    wait_until_compiled(page)
    camera = CameraModel.from_fov(640, 480, SHORT.fov)
    shown = page.evaluate("fetch('state.json').then((answer) => answer.json())")["streams"][0]["time"]
    (pixel,) = camera.project(place(shown)[None])
    page.mouse.click(*on_screen(page, *pixel))
    page.fill(".diameter", "abc", timeout=WAIT)
    page.keyboard.press("Enter")
    page.get_by_text("is no length").wait_for(timeout=WAIT)
    page.fill(".diameter", "0 cm")
    page.keyboard.press("Enter")
    page.get_by_text("more than 0").wait_for(timeout=WAIT)
    page.fill(".diameter", "1000000000 m")
    page.keyboard.press("Enter")
    page.get_by_text("at most 20 m").wait_for(timeout=WAIT)
    for wrong in ("abc", "0", "180"):
        page.fill("#fov", wrong)
        page.keyboard.press("Enter")
        page.get_by_text("between 5 and 175").wait_for(timeout=WAIT)
    page.fill("#fov", "60")
    page.keyboard.press("Enter")
    page.get_by_text("between 5 and 175").wait_for(state="hidden", timeout=WAIT)
    page.fill(".diameter", "28 cm")
    page.keyboard.press("Enter")
    reading = page.locator("#reading [data-name=distance]")
    reading.wait_for(timeout=WAIT)
    (stream,) = page.evaluate("fetch('state.json').then((answer) => answer.json())")["streams"]
    (target,) = stream["targets"]
    truth = place(stream["time"])
    assert target["position"]["z"][0] == pytest.approx(truth[2], rel=0.01)
    assert re.search(r"\d", reading.inner_text())


def test_the_source_is_changed_by_hand(serve: Any, page: Any, clip: Any, tmp_path: Path) -> None:
    (tmp_path / "ball.avi").symlink_to(clip[0])
    (tmp_path / "broken.mp4").write_bytes(b"\0this is no video")
    (tmp_path / "notes.mp4").write_text("this is no video")
    page.goto(serve())
    page.get_by_role("button", name="ball.avi").wait_for(timeout=WAIT)
    assert page.get_by_role("button", name="notes.mp4").count() == 0
    wait_until(page, "document.querySelector('#sources .entry[data-kind=file] img')?.naturalWidth === 240")
    page.get_by_role("button", name="ball.avi").click(timeout=WAIT)
    wait_until(page, "picture.width === 320")
    page.get_by_role("button", name="other source").click()
    page.get_by_role("button", name="broken.mp4").click()
    page.get_by_text("broken.mp4").first.wait_for()
    page.locator("#veil, #sources .fault").get_by_text(re.compile("cannot|no video|not a video|no frame")).wait_for(
        timeout=WAIT
    )
    page.get_by_role("button", name="broken.mp4").press("Escape")
    page.locator("#sources").wait_for(state="hidden", timeout=WAIT)
    page.get_by_role("button", name="other source").click()
    page.locator("#sources").wait_for(timeout=WAIT)
    page.get_by_role("button", name="ball.avi").click()
    page.locator("#sources").wait_for(state="hidden", timeout=WAIT)
    wait_until(page, "veil.hidden && picture.width === 320")


def test_a_stream_and_a_video_of_ones_own_are_brought(
    film: Any, serve: Any, page: Any, clip: Any, tmp_path: Path
) -> None:
    camera = film(lambda _: np.full((120, 160, 3), 90, np.uint8))
    page.goto(serve())
    page.get_by_label("address of a camera").fill("file:///etc/passwd", timeout=WAIT)
    page.set_viewport_size({"width": 390, "height": 844})
    wait_until(page, "innerWidth === 390 && document.documentElement.scrollWidth <= 390")
    page.set_viewport_size({"width": 1280, "height": 900})
    page.keyboard.press("Enter")
    page.get_by_text("type an address such as").wait_for(timeout=WAIT)
    page.get_by_label("address of a camera").fill(camera.url)
    page.keyboard.press("Enter")
    wait_until(page, "picture.width === 160")
    page.locator("#sources").wait_for(state="hidden", timeout=WAIT)
    page.get_by_role("button", name="other source").click()
    (tmp_path / "notes.mp4").write_text("this is no video")
    page.get_by_label("a video of this device").set_input_files(tmp_path / "notes.mp4")
    page.locator("#sources output").get_by_text("notes.mp4").wait_for(timeout=WAIT)
    page.get_by_label("a video of this device").set_input_files(clip[0])
    wait_until(page, "picture.width === 320")
    page.locator("#sources").wait_for(state="hidden", timeout=WAIT)
    assert page.locator("#source").inner_text() == "ball.avi"
    page.get_by_role("button", name="other source").click()
    assert page.locator("#sources .entry[data-kind=upload]").inner_text().startswith("ball.avi")
