"""From `matchset live` to meters on a clip: click, type, Enter, read."""

import re
from pathlib import Path
from typing import Any

import pytest

from live_pages import on_screen
from matchset.sim.clips.ball_flight_clip import BallFlightClip

WAIT = 90_000  # ms; on a fresh machine kernels are compiled after the click


def test_a_click_and_a_diameter_give_meters(serve: Any, page: Any, clip: tuple[Path, BallFlightClip]) -> None:
    path, truth = clip
    page.goto(serve(str(path)))
    page.wait_for_function("picture.width > 300", timeout=WAIT)
    shown = page.evaluate("fetch('state.json').then((answer) => answer.json())")["streams"][0]["time"]
    (pixel,) = truth.camera.project(truth.place(shown)[None])
    page.mouse.click(*on_screen(page, *pixel))
    page.fill("#fov", "60", timeout=WAIT)
    page.keyboard.press("Enter")
    page.fill(".diameter", "28 cm", timeout=WAIT)
    page.keyboard.press("Enter")
    reading = page.locator("#reading [data-name=distance]")
    reading.wait_for(timeout=WAIT)
    distance = float(re.findall(r"[-\d.]+", reading.inner_text())[0])
    assert distance == pytest.approx(1.6, abs=0.35)
