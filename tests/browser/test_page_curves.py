"""The curves of the page: what is kept of 500 samples a second, what is drawn, and that drawing costs little."""

import math
import re
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from live_pages import WAIT, on_screen, wait_until

FOUR = re.compile(r"^computing a picture: median [\d.]+, mean [\d.]+, 95 % [\d.]+, worst [\d.]+ ms$")
DRAWING = 8.0  # ms, half of a frame at 60 frames/s; taken in 0.3 ms on an idle machine

KEPT = """import('/curves/samples.js').then(({ Samples }) => {
  const samples = new Samples();
  for (let i = 0; i < 60 * 500; i++) {
    const time = i / 500;
    samples.add(time, time >= 45 && time < 46 ? NaN : time, 0.5);
  }
  const rows = [];
  samples.each((ago, low, high, sigma, lost) => rows.push([ago, low, high, sigma, lost]));
  return rows;
})"""

COST = """import('/curves/curves.js').then(async ({ Curves }) => {
  const curves = new Curves(document.getElementById('curves'));
  for (const canvas of document.querySelectorAll('#curves canvas')) canvas.hidden = false;
  await new Promise((laidOut) => requestAnimationFrame(() => requestAnimationFrame(laidOut)));
  const costs = [];
  for (let i = 0; i < 30 * 500; i++) {
    const found = i % 5000 < 4500;
    const number = [Math.sin(i / 900), 0.01];
    const position = found ? { x: number, y: number, z: [2, 0.01], distance: [2, 0.01] } : undefined;
    curves.note([{ id: 1, found, values: {}, position }], i / 500);
    if (i % 150 === 0) {
      const begin = performance.now();
      curves.draw(1);
      costs.push(performance.now() - begin);
    }
  }
  costs.sort((a, b) => a - b);
  return costs[costs.length / 2];
})"""

INK = """(id) => {
  const canvas = document.getElementById(id);
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  let count = 0;
  for (let i = 3; i < data.length; i += 4) count += data[i] > 0;
  return count;
}"""


def scene(number: int) -> npt.NDArray[np.uint8]:
    """A blue ball that sways."""
    image = np.full((240, 320, 3), 90, np.uint8)
    middle = round(160 + 20 * math.sin(number / 15)), 120
    cv2.circle(image, middle, 40, (210, 90, 30), cv2.FILLED, cv2.LINE_AA)
    return image


def test_thirty_seconds_are_kept_with_their_extremes_and_what_was_lost(opened: Any) -> None:
    rows = opened.evaluate(KEPT)
    assert 595 <= len(rows) <= 602
    assert rows[0][0] == pytest.approx(30.0, abs=0.1)
    assert rows[-1][0] == pytest.approx(0.0, abs=0.05)
    for ago, low, high, sigma, lost in rows:
        if lost:
            assert 13.9 < ago < 15.1
            continue
        assert 0.0 <= high - low <= 0.05
        assert sigma == 0.5
    assert 19 <= sum(row[4] for row in rows) <= 21


def test_drawing_thirty_seconds_leaves_room_for_sixty_frames(opened: Any) -> None:
    assert opened.evaluate(COST) < DRAWING


def test_curves_and_the_view_from_above_are_drawn(opened: Any) -> None:
    opened.mouse.click(*on_screen(opened, 160, 120))
    opened.locator("#curve-0").wait_for(state="visible", timeout=WAIT)
    assert opened.locator("#above").is_hidden()
    opened.fill("#fov", "60")
    opened.locator("#fov").press("Enter")
    opened.fill(".diameter", "28 cm")
    opened.locator(".diameter").press("Enter")
    opened.locator("#above").wait_for(state="visible", timeout=WAIT)
    wait_until(opened, f"['curve-0', 'curve-1', 'curve-2', 'above'].every((id) => ({INK})(id) > 300)")


def test_below_the_targets_stands_what_a_picture_took(opened: Any) -> None:
    assert opened.locator("#computing").is_hidden()
    opened.mouse.click(*on_screen(opened, 160, 120))
    words = opened.locator("#computing").get_by_text(FOUR)
    words.wait_for(timeout=WAIT)
    opened.set_viewport_size({"width": 390, "height": 844})
    words.wait_for(timeout=WAIT)
    assert opened.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_curve_shows_its_value_under_the_pointer_and_the_keys_and_is_enlarged(opened: Any) -> None:
    opened.mouse.click(*on_screen(opened, 160, 120))
    curve = opened.locator("#curve-0")
    curve.wait_for(state="visible", timeout=WAIT)
    value = opened.locator("figure.curve:has(#curve-0) output")
    assert value.inner_text() == ""
    box = curve.bounding_box()
    opened.mouse.move(box["x"] + box["width"] - 3, box["y"] + box["height"] / 2)
    pattern = re.compile(r"^\d+\.\d s ago: x (\d+\.?\d*) (±\d+\.?\d* )?px$")
    value.get_by_text(pattern).wait_for(timeout=WAIT)
    x = pattern.match(value.inner_text())
    assert x is not None
    assert 135 < float(x.group(1)) < 185
    opened.mouse.move(box["x"] + 0.4 * box["width"], box["y"] - 300)
    wait_until(opened, "document.querySelector('figure.curve output').textContent === ''")
    curve.focus()
    opened.keyboard.press("Shift+ArrowLeft")
    value.get_by_text(re.compile(r"s ago: ")).wait_for(timeout=WAIT)
    enlarge = opened.locator("figure.curve:has(#curve-0) button")
    assert enlarge.get_attribute("aria-label") == "enlarge"
    enlarge.click()
    wait_until(opened, "document.getElementById('curve-0').clientHeight > 0.8 * innerHeight")
    wait_until(opened, "document.getElementById('curve-0').clientWidth > 0.9 * innerWidth")
    opened.keyboard.press("Escape")
    wait_until(opened, "document.getElementById('curve-0').clientHeight < 0.4 * innerHeight")
