"""The picture of the live page: clicks, drawn outlines, layers, zoom, keys and fingers, as a person uses them."""

import functools
import math
import re
from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from live_pages import WAIT, on_screen, rows, state_of, wait_for_picture, wait_until
from matchset.live.vision.kept_frames import KeepingParameters
from mjpeg_server import MjpegServer

BLUE, RED, BOX = (100, 120, 30), (230, 100, 24), (190, 190, 60, 30)  # x, y, radius; x, y, width, height


SEEN = """() => {
  const canvas = document.getElementById('picture');
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  let [count, x, y] = [0, 0, 0];
  for (let i = 0; i < data.length / 4; i++) {
    if (data[4 * i + 2] < data[4 * i] + 80) continue;
    count += 1;
    x += i % canvas.width;
    y += Math.floor(i / canvas.width);
  }
  return [x / count * 320 / canvas.width, y / count * 320 / canvas.width];
}"""  # where the blue ball is in the picture that is shown, px


CLICKS = """([x, y, count]) => {
  for (let k = 0; k < count; k++) {
    const options = { clientX: x + k % 10, clientY: y + k % 7, pointerId: 99, button: 0, bubbles: true };
    for (const name of ["pointerdown", "pointerup"]) view.dispatchEvent(new PointerEvent(name, options));
  }
}"""


def scene(number: int) -> npt.NDArray[np.uint8]:
    """Two balls that tremble a little, and a green box."""
    image = np.random.default_rng(number % 8).normal(90.0, 2.0, (240, 320, 3))
    shift = number % 2
    for (x, y, radius), color in ((BLUE, (210, 90, 30)), (RED, (40, 40, 210))):
        cv2.circle(image, (x + shift, y), radius, color, cv2.FILLED, cv2.LINE_AA)
    x, y, width, height = BOX
    cv2.rectangle(image, (x, y), (x + width, y + height), (60, 170, 60), cv2.FILLED)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7).astype(np.uint8)


def follow(page: Any, x: float, y: float, name: str) -> None:
    """Click, and wait for the new target to be found."""
    page.mouse.click(*on_screen(page, x, y))
    page.locator("#targets .name", has_text=name).wait_for(timeout=WAIT)
    wait_until(page, "document.querySelector('#reading .number') !== null")


def has_passed(page: Any, sequence: int) -> bool:
    return bool(state_of(page)["sequence"] > sequence)


def drawn(page: Any, points: Sequence[tuple[float, float]]) -> None:
    """Drag along points of the picture."""
    page.mouse.move(*on_screen(page, *points[0]))
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*on_screen(page, *point))
    page.mouse.up()


def test_balls_are_clicked_chosen_and_dropped(opened: Any) -> None:
    follow(opened, *BLUE[:2], "circle 1")
    follow(opened, *RED[:2], "circle 2")
    assert rows(opened) == ["circle 1", "circle 2"]
    assert opened.locator("#reading .head").inner_text() == "circle 2"
    opened.mouse.click(*on_screen(opened, *BLUE[:2]))
    opened.locator("#reading .head", has_text="circle 1").wait_for(timeout=WAIT)
    assert rows(opened) == ["circle 1", "circle 2"]
    x, y, radius = (state_of(opened)["targets"][0]["values"][name][0] for name in ("x", "y", "radius"))
    assert (x, y, radius) == pytest.approx((BLUE[0] + 0.5, BLUE[1], BLUE[2]), abs=1.0)
    opened.get_by_label("drop circle 1").click()
    wait_until(opened, "document.querySelectorAll('#targets li').length === 1")
    assert rows(opened) == ["circle 2"]


def test_a_thousand_clicks_on_nothing_are_answered_in_words_and_do_no_harm(opened: Any) -> None:
    for k in range(20):
        opened.mouse.click(*on_screen(opened, 20 + k % 10, 20 + k % 7))
    opened.evaluate(CLICKS, [*on_screen(opened, 20, 20), 980])  # as fast as a page can
    words = re.compile(r"no circle at|background|stands out")  # of the last click: only older ones are given up
    opened.locator("#said").get_by_text(words).first.wait_for(timeout=WAIT)
    wait_until(opened, "document.querySelector('#clicks .ring') === null")
    wait_until(opened, "document.querySelectorAll('#targets li').length === 0")
    follow(opened, *BLUE[:2], "circle")
    assert len(rows(opened)) == 1


def test_layers_are_switched_one_by_one(opened: Any) -> None:
    follow(opened, *BLUE[:2], "circle 1")
    drawing = opened.locator("#drawing")
    drawing.locator(".outline").wait_for(state="attached", timeout=WAIT)
    assert drawing.locator(".match-set").count() == 0
    opened.get_by_label("match-set").check()
    drawing.locator(".match-set").first.wait_for(state="attached", timeout=WAIT)
    opened.get_by_label("outline", exact=True).uncheck()
    drawing.locator(".outline").wait_for(state="detached", timeout=WAIT)
    opened.get_by_label("color", exact=True).check()
    opened.locator("#mask").wait_for(state="visible", timeout=WAIT)
    pixel = "(x, y) => [...document.querySelector('#mask').getContext('2d').getImageData(x, y, 1, 1).data]"
    ball, ground = (opened.evaluate(f"([x, y]) => ({pixel})(x, y)", list(at)) for at in (BLUE[:2], (20, 20)))
    assert max(ball[:3]) > 100
    assert max(ground[:3]) == 0
    opened.get_by_label("color", exact=True).uncheck()
    opened.locator("#mask").wait_for(state="hidden", timeout=WAIT)
    opened.reload()
    wait_until(opened, "picture.width === 320")
    assert opened.get_by_label("match-set").is_checked()
    assert not opened.get_by_label("outline", exact=True).is_checked()


def test_zoom_by_wheel_pan_and_whole_picture(opened: Any) -> None:
    scale = "new DOMMatrix(getComputedStyle(picture).transform).a"
    opened.mouse.move(*on_screen(opened, *BLUE[:2]))
    opened.mouse.wheel(0, -400)
    wait_until(opened, f"{scale} > 2.5")
    box = opened.locator("#picture").bounding_box()
    at = box["x"] + (BLUE[0] + 0.5) / 320 * box["width"], box["y"] + (BLUE[1] + 0.5) / 240 * box["height"]
    opened.mouse.move(*at)
    opened.mouse.down()
    opened.mouse.move(at[0] + 40, at[1] + 30, steps=4)
    opened.mouse.up()
    moved = opened.locator("#picture").bounding_box()
    assert (moved["x"] - box["x"], moved["y"] - box["y"]) == pytest.approx((40, 30), abs=1)
    assert not rows(opened)
    opened.mouse.click(at[0] + 40, at[1] + 30)
    opened.locator("#targets .name", has_text="circle 1").wait_for(timeout=WAIT)
    opened.get_by_role("button", name="whole picture").click()
    assert opened.evaluate(scale) == 1
    assert opened.get_by_role("button", name="whole picture").is_hidden()
    (target,) = state_of(opened)["targets"]
    assert target["values"]["x"][0] == pytest.approx(BLUE[0] + 0.5, abs=1.0)


def test_a_rim_is_drawn_around_a_ball_and_around_a_box(opened: Any) -> None:
    x, y, radius = RED
    arc = [(x + radius * math.cos(0.25 * k), y + radius * math.sin(0.25 * k)) for k in range(18)]
    drawn(opened, arc)
    opened.locator("#targets .name", has_text="circle 1").wait_for(timeout=WAIT)
    opened.get_by_label("shape").select_option("rectangle")
    left, top, width, height = BOX
    corners = [(left, top), (left + width, top), (left + width, top + height), (left, top + height), (left, top + 2)]
    drawn(opened, corners)
    opened.locator("#targets .name", has_text="rectangle 2").wait_for(timeout=WAIT)
    wait_until(opened, "document.querySelectorAll('#drawing .outline').length === 2")
    circle, rectangle = state_of(opened)["targets"]
    assert circle["values"]["radius"][0] == pytest.approx(radius, abs=1.0)
    assert rectangle["values"]["x"][0] == pytest.approx(left + width / 2, abs=1.5)
    drawn(opened, [(10 + 6 * k, 20) for k in range(10)])
    opened.locator("#said").get_by_text(re.compile("encloses nothing")).wait_for(timeout=WAIT)
    assert opened.locator("#clicks .ring").count() == 0


def test_a_picture_stands_still_while_somebody_draws_in_it(film: Any, serve: Any, page: Any) -> None:
    radius = 22

    def passing(number: int) -> npt.NDArray[np.uint8]:
        image = np.full((240, 320, 3), 90, np.uint8)
        cv2.circle(image, (round(160 + 90 * math.sin(number / 60)), 120), radius, (210, 90, 30), cv2.FILLED)
        return cv2.GaussianBlur(image, (0, 0), 0.7).astype(np.uint8)

    page.goto(serve(film(passing).url))
    wait_for_picture(page)
    x, y = page.evaluate(SEEN)
    page.mouse.move(*on_screen(page, x + radius, y))
    page.mouse.down()
    still = x, y = tuple(page.evaluate(SEEN))
    begun = state_of(page)["sequence"]
    for k in range(26):
        page.mouse.move(*on_screen(page, x + radius * math.cos(0.25 * k), y + radius * math.sin(0.25 * k)))
        wait_until(page, functools.partial(has_passed, page, begun + 4 * k))
    assert begun + KeepingParameters().frames < state_of(page)["sequence"]  # a slow hand
    assert page.locator("#veil").is_hidden()
    assert tuple(page.evaluate(SEEN)) == still
    page.mouse.up()
    wait_until(page, lambda: tuple(page.evaluate(SEEN)) != still)
    page.locator("#targets .name", has_text="circle 1").wait_for(timeout=WAIT)
    wait_until(page, lambda: state_of(page)["targets"][0]["found"])
    (target,) = state_of(page)["targets"]
    assert target["values"]["radius"][0] == pytest.approx(radius, abs=1.0)


def test_the_keyboard_alone_follows_a_ball(opened: Any) -> None:
    for _ in range(20):
        opened.keyboard.press("Tab")
        if opened.evaluate("document.activeElement.id") == "view":
            break
    assert opened.evaluate("document.activeElement.id") == "view"
    for _ in range(12):  # from the middle, 5 px each
        opened.keyboard.press("ArrowLeft")
    opened.locator("#drawing .cross").first.wait_for(state="attached", timeout=WAIT)
    opened.keyboard.press("Enter")
    opened.locator("#targets .name", has_text="circle 1").wait_for(timeout=WAIT)
    (target,) = state_of(opened)["targets"]
    assert target["values"]["x"][0] == pytest.approx(BLUE[0] + 0.5, abs=1.0)
    opened.keyboard.press("Escape")
    opened.locator("#drawing .cross").first.wait_for(state="detached", timeout=WAIT)


def test_fingers_pinch_and_tap(camera: MjpegServer, show: Any, new_page: Any) -> None:
    page = new_page(viewport={"width": 390, "height": 844}, has_touch=True)
    page.goto(show(camera.url))
    wait_until(page, "picture.width === 320")
    client = page.context.new_cdp_session(page)
    x, y = on_screen(page, *BLUE[:2])

    def touch(kind: str, *apart: float) -> None:
        points = [{"x": x + each, "y": y, "id": number} for number, each in enumerate(apart)]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", -20, 20)
    for apart in (25, 30, 35, 40):
        touch("touchMove", -apart, apart)
    touch("touchEnd")
    wait_until(page, "new DOMMatrix(getComputedStyle(picture).transform).a > 1.5")
    assert not rows(page)
    page.touchscreen.tap(x, y)
    page.locator("#targets .name", has_text="circle 1").wait_for(timeout=WAIT)
