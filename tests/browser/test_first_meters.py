"""From `matchset live` to meters on a clip: click, type, Enter, read; and what happens to the reading then."""

import functools
import math
import re
from pathlib import Path
from typing import Any

import pytest

from live_pages import WAIT, Heard, click_ball, hold, state_of, wait_until
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Filmed = tuple[Path, BallFlightClip]


def start(page: Any, address: str, truth: BallFlightClip, diameter: str = "28 cm") -> Heard:
    """What a new user does; the video stands still afterwards."""
    heard = Heard(page)
    page.goto(address)
    click_ball(heard, truth)
    page.fill("#fov", "60")
    page.keyboard.press("Enter")
    page.fill(".diameter", diameter)
    page.keyboard.press("Enter")
    page.locator("#reading [data-name=distance]").wait_for(timeout=WAIT)
    return heard


def read(page: Any) -> dict[str, float]:
    """What a person reads: the number of each row."""
    script = "(rows) => rows.map((row) => [row.dataset.name, row.innerText])"
    rows = page.locator("#reading [data-name]").evaluate_all(script)
    return {name: float(re.findall(r"-?\d+(?:\.\d+)?", text)[0]) for name, text in rows}


def error(page: Any, truth: BallFlightClip) -> float:
    """How far what a person reads is from the truth, as a share of the distance; 1 without meters."""
    numbers, shown = read(page), state_of(page)
    if "distance" not in numbers:
        return 1.0
    place = truth.place(shown["time"])
    return math.dist([numbers[name] for name in "xyz"], place) / math.hypot(*place)


def go_to(page: Any, share: float) -> None:
    """Click the time line."""
    line = page.locator("#file .timeline")
    box = line.bounding_box()
    line.click(position={"x": share * box["width"], "y": box["height"] / 2})


def is_at(page: Any, time: float) -> bool:
    return abs(float(state_of(page)["time"]) - time) < 0.2


def drop(page: Any) -> None:
    page.locator("#targets .drop").click()
    page.locator("#targets li").wait_for(state="detached", timeout=WAIT)


def test_meters_are_within_a_hundredth_of_the_truth(served: str, page: Any, clip: Filmed) -> None:
    truth = clip[1]
    start(page, served, truth)
    wait_until(page, lambda: error(page, truth) < 0.01)
    for share in (0.1, 0.4, 0.8):
        go_to(page, share)
        wait_until(page, functools.partial(is_at, page, 8.0 * share))
        wait_until(page, lambda: error(page, truth) < 0.01)

    def distance_is_right() -> bool:  # page and state are read one after the other
        right = math.hypot(*truth.place(state_of(page)["time"]))
        return read(page)["distance"] == pytest.approx(right, rel=0.01)

    wait_until(page, distance_is_right)
    drop(page)


def test_a_diameter_is_changed(served: str, page: Any, clip: Filmed) -> None:
    truth = clip[1]
    start(page, served, truth)
    page.fill(".diameter", "14 cm")
    page.keyboard.press("Enter")
    half = 0.5 * truth.place(state_of(page)["time"])[2]
    wait_until(page, lambda: read(page).get("z") == pytest.approx(half, rel=0.01))
    page.fill(".diameter", "280 mm")
    page.keyboard.press("Enter")
    wait_until(page, lambda: error(page, truth) < 0.01)
    drop(page)


def test_lost_with_its_reason_and_found_again(show: Any, page: Any, leaving_clip: Filmed) -> None:
    path, truth = leaving_clip
    heard = Heard(page)
    page.goto(show(str(path)))
    hold(heard)
    go_to(page, 0.02)
    wait_until(page, lambda: state_of(page)["time"] < 0.4)
    start(page, page.url, truth)
    go_to(page, 0.25)  # 2 s: the ball is gone
    lost = page.locator("#reading .lost")
    lost.wait_for(timeout=WAIT)
    (target,) = state_of(page)["targets"]
    assert target["reason"]
    assert target["reason"] in page.locator("#reading").inner_text()
    go_to(page, 0.5)
    lost.wait_for(state="detached", timeout=WAIT)
    wait_until(page, lambda: error(page, truth) < 0.01)


def test_two_viewers_see_and_change_the_same(served: str, new_page: Any, clip: Filmed) -> None:
    first, second = new_page(), new_page(viewport={"width": 390, "height": 844})
    second.goto(served)
    start(first, served, clip[1])
    second.locator("#reading [data-name=distance]").wait_for(timeout=WAIT)
    second.fill(".diameter", "14 cm")
    second.keyboard.press("Enter")
    wait_until(first, lambda: read(first).get("distance", 9.0) < 1.2)
    drop(first)
    second.locator("#targets li").wait_for(state="detached", timeout=WAIT)
