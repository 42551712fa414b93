"""The reading, diameters as people type them, a lost ball, a server that is silent, a browser that is old."""

import re
import signal
from pathlib import Path
from typing import Any

import pytest

from live_pages import WAIT, on_screen, rows, state_of, wait_until
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Clip = tuple[Path, BallFlightClip]
FOUR = re.compile(r"computing a frame: median [\d.]+, mean [\d.]+, 95 % [\d.]+, worst [\d.]+ ms")


def begin(page: Any, clip: Clip) -> None:
    """Click the ball in the first picture; beside its middle, where the marker is."""
    wait_until(page, "picture.width === 320")
    (pixel,) = clip[1].camera.project(clip[1].place(state_of(page)["time"])[None])
    page.mouse.click(*on_screen(page, pixel[0] + 9, pixel[1] + 9))
    page.locator("#reading .number").first.wait_for(timeout=WAIT)


def test_a_reading_in_pixels_then_in_meters(show: Any, page: Any, clip: Clip) -> None:
    page.goto(show(str(clip[0])))
    begin(page, clip)
    assert page.locator("#reading .name").all_inner_texts() == ["x", "y", "r"]
    assert page.locator("#reading .left-out").count() == 0
    assert re.search(r"px$", page.locator("#reading .number").first.inner_text().strip())
    page.fill("#fov", "60")
    page.locator("#fov").press("Enter")
    for typed, words in (("abc", "is no length"), ("0 cm", "more than 0"), ("1e9", "is no length"), ("28", "of what")):
        page.fill(".diameter", typed)
        page.locator(".diameter").press("Enter")
        page.locator("#targets output").first.get_by_text(re.compile(words)).wait_for(timeout=WAIT)
        assert page.locator(".diameter").get_attribute("aria-invalid") == "true"
    for typed, meters in (("280 mm", 0.28), ("0,5 m", 0.5), ("11 in", 0.2794), ("28cm", 0.28)):
        page.fill(".diameter", typed)
        page.locator(".diameter").press("Enter")
        wait_until(page, f"fetch('state.json').then((a) => a.json()).then((all) => Math.abs("
                   f"(all.streams[0].targets[0].diameter || 0) - {meters}) < 1e-9)")  # fmt: skip
    assert page.locator("#targets output").first.inner_text() == ""
    page.locator("#reading [data-name=distance]").wait_for(timeout=WAIT)
    assert page.locator("#reading .name").all_inner_texts() == ["distance", "x", "y", "z"]
    assert page.locator("#reading .left-out").all_inner_texts() == [
        "± leaves out errors of the camera and of the diameter"
    ]
    page.fill(".diameter", "28 cm ± 2 mm")
    page.locator(".diameter").press("Enter")
    page.get_by_text("± leaves out errors of the camera", exact=True).wait_for(timeout=WAIT)
    page.fill("#fov", "60 ±")
    page.locator("#fov").press("Enter")
    page.locator("#fov-error").get_by_text("how well it is known").wait_for(timeout=WAIT)
    page.fill("#fov", "60 ± 3")
    page.locator("#fov").press("Enter")
    page.locator("#reading .left-out").wait_for(state="detached", timeout=WAIT)
    page.locator("#fov").blur()
    wait_until(page, "document.getElementById('fov').value === '60.0 ± 3'")
    page.locator("#file-results .work").get_by_text(FOUR).wait_for(timeout=WAIT)
    size = page.evaluate("parseFloat(getComputedStyle(document.querySelector('#reading .first .value')).fontSize)")
    assert size >= 48


def test_a_ball_that_leaves_is_lost_with_a_reason_and_a_time(show: Any, page: Any, leaving_clip: Clip) -> None:
    page.goto(show(str(leaving_clip[0])))
    begin(page, leaving_clip)
    page.locator("#file-results .work").get_by_text("100 % tracked").wait_for(timeout=WAIT)
    line = page.locator("#file .timeline")
    box = line.bounding_box()
    line.click(position={"x": 0.25 * box["width"], "y": 0.5 * box["height"]})  # 2 s: the ball is gone
    page.locator("#reading .lost").get_by_text(re.compile(r"Lost for \d+\.\d s")).wait_for(timeout=WAIT)
    assert len(page.locator("#reading .why").inner_text()) > 5
    assert "lost" in page.locator("#targets .state").inner_text()


def test_a_server_that_is_silent_is_asked_again(serve: Any, page: Any, clip: Clip) -> None:
    page.goto(serve(str(clip[0])))
    wait_until(page, "picture.width === 320 && document.querySelector('#link').textContent === ''")
    (server,) = serve.processes
    server.send_signal(signal.SIGSTOP)
    try:
        page.locator("#link").get_by_text(re.compile("no connection|connecting again")).wait_for(timeout=WAIT)
    finally:
        server.send_signal(signal.SIGCONT)
    wait_until(page, "document.querySelector('#link').textContent === ''")
    assert rows(page) == []


def test_a_browser_without_websocket_is_told(show: Any, page: Any, clip: Clip) -> None:
    page.add_init_script("delete window.WebSocket")
    page.goto(show(str(clip[0])))
    page.locator("#link").get_by_text(re.compile("no WebSocket")).wait_for(timeout=WAIT)


def test_it_fits_phone_laptop_and_4k(show: Any, page: Any, clip: Clip) -> None:
    page.goto(show(str(clip[0])))
    wait_until(page, "picture.width === 320")
    for width, height in ((390, 844), (1280, 900), (3840, 2160)):
        page.set_viewport_size({"width": width, "height": height})
        wait_until(page, f"innerWidth === {width} && document.documentElement.scrollWidth <= {width}")
        box = page.locator("#view").bounding_box()
        assert box["width"] / box["height"] == pytest.approx(4 / 3, rel=0.02)
        assert box["width"] >= 0.42 * width
        assert box["y"] + box["height"] <= height
    nameless = """[...document.querySelectorAll('button, input, select')].filter((each) => each.offsetParent
      && !(each.textContent.trim() || each.getAttribute('aria-label') || (each.labels && each.labels.length))).length"""
    assert page.evaluate(nameless) == 0
