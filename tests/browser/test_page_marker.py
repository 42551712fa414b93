"""A marker is shown to the page by a click: its rim and the axes of the ball's pose are drawn."""

import math
from typing import Any

import numpy as np

import matchset as ms
from live_pages import WAIT, on_screen, state_of, wait_until
from matchset.sim.clips.ball_flight_clip import BallFlightClip

PLACE = np.array((0.05, -0.05, 1.2))


def test_a_marker_gives_the_axes(film: Any, serve: Any, page: Any) -> None:
    camera = ms.CameraModel.from_fov(320, 240, math.radians(60.0))
    images = [frame.image for frame in BallFlightClip(camera=camera, place=lambda _: PLACE, frames=4)]
    x, y = camera.project(PLACE[None])[0].tolist()
    source = film(lambda number: images[number % len(images)])
    page.goto(serve(source.url))
    wait_until(page, "picture.width === 320")
    page.mouse.click(*on_screen(page, x + 14, y + 14))
    page.locator("#targets .name", has_text="circle 1").wait_for(timeout=WAIT)
    page.fill("#fov", "60")
    page.locator("#fov").press("Enter")
    page.fill(".diameter", "28 cm")
    page.locator(".diameter").press("Enter")
    page.locator("#reading [data-name=distance]").wait_for(timeout=WAIT)
    assert page.locator("#drawing .axis").count() == 0
    page.get_by_text("marker on the ball").click()
    page.get_by_role("button", name="click it").click()
    page.locator("#hint", has_text="Click the marker").wait_for(timeout=WAIT)
    page.mouse.click(*on_screen(page, x, y))
    page.locator("#drawing .axis").first.wait_for(state="attached", timeout=WAIT)
    assert page.locator("#drawing .marker").count() == 1
    (target,) = state_of(page)["targets"]
    assert abs(target["position"]["z"][0] / PLACE[2] - 1.0) < 0.01
    page.get_by_label("axes").uncheck()
    page.locator("#drawing .axis").first.wait_for(state="detached", timeout=WAIT)
