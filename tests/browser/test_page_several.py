"""Several balls that look alike on the page keep their names, which change; all like one; marks of their lives."""

import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import crossing_balls
from live_pages import Heard, hold, on_screen, rows, state_of, tell, wait_for_picture, wait_until

UPPER, LOWER, APART = 84.0, 116.0, 205.0  # px, of the rows on which balls move
NAMES = 'left <b>hand</b> & "x"'
MARKS = """(id) => [...document.querySelectorAll(`${id} .mark`)].map((mark) =>
  [Number(mark.parentElement.dataset.id), mark.dataset.kind, mark.querySelector('title').textContent])"""
BOXES = """() => [...document.querySelectorAll('#drawing .target-name')].map((name) => {
  const { left, right, top, bottom } = name.getBoundingClientRect();
  return [name.textContent, left, right, top, bottom];
})"""
LINES = """(id) => [...document.querySelectorAll(`${id} .life`)].map((life) =>
  [Number(life.dataset.id), life.querySelector('.of').textContent,
    life.querySelector('.found').getAttribute('stroke')])"""


def scene(number: int) -> npt.NDArray[np.uint8]:
    """Two equal balls that pass each other again and again, and a third apart from them."""
    image = np.random.default_rng(number % 8).normal(90.0, 2.0, (240, 320, 3))
    way = 100.0 * math.cos(number / 25.0)
    for x, y in ((160.0 + way, UPPER), (160.0 - way, LOWER), (160.0, APART)):
        cv2.circle(image, (round(16 * x), round(16 * y)), 24 * 16, (210, 90, 30), cv2.FILLED, cv2.LINE_AA, 4)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7).astype(np.uint8)


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return crossing_balls.written(tmp_path_factory.mktemp("crossing"))


def click_row(page: Any, y: float) -> None:
    """Click the ball on a row of the camera's picture, wherever it is."""
    count = len(rows(page))
    while len(rows(page)) == count:
        x = page.evaluate(
            """(share) => {
              const { width, height } = picture;
              const pixels = picture.getContext('2d').getImageData(0, Math.round(share * height), width, 1).data;
              const blue = [...Array(width).keys()].filter((x) => pixels[4 * x + 2] > 150 && pixels[4 * x] < 90);
              return blue.length ? blue.reduce((sum, x) => sum + x, 0) / blue.length / width : null;
            }""",
            (y + (18.0 if y == LOWER else -18.0)) / 240.0,
        )
        if x is not None:
            page.mouse.click(*on_screen(page, 320.0 * x, y))
        page.wait_for_timeout(700)


def test_two_equal_balls_that_cross_keep_their_names(opened: Any, page: Any) -> None:
    heard: list[dict[str, Any]] = []
    click_row(opened, UPPER)
    click_row(opened, LOWER)
    upper, lower = rows(opened)
    while not heard or heard[-1]["time"] - heard[0]["time"] < 6.0:  # two crossings and more
        heard.append(state_of(page))
        page.wait_for_timeout(25)
    for state in heard:
        places = {each["name"]: each["values"] for each in state["targets"] if each["found"]}
        for name, y in ((upper, UPPER), (lower, LOWER)):
            others = [values["x"][0] for other, values in places.items() if other != name]
            if name in places and others and abs(others[0] - places[name]["x"][0]) > 52.0:
                assert places[name]["y"][0] == pytest.approx(y, abs=2.0)
    colors = opened.evaluate(
        "[...document.querySelectorAll('#drawing .outline')].map((each) => each.getAttribute('stroke'))"
    )
    dots = opened.evaluate("[...document.querySelectorAll('#targets .dot')].map((each) => each.style.background)")
    assert len(set(dots)) == 2
    lines = opened.evaluate(LINES, "#curves")
    assert [name for _, name, _ in lines] == [upper, lower]
    assert {color for _, _, color in lines} >= set(colors)
    words = opened.evaluate("[...document.querySelectorAll('#drawing .target-name')].map((each) => each.textContent)")
    assert {each.rstrip("?") for each in words} <= {upper, lower}


def test_a_target_has_the_name_that_a_person_gives_it(opened: Any) -> None:
    click_row(opened, APART)
    (old,) = rows(opened)
    opened.locator("#targets .name").dblclick()
    opened.keyboard.type(NAMES)
    opened.keyboard.press("Enter")
    wait_until(opened, lambda: rows(opened) == [NAMES])
    assert state_of(opened)["targets"][0]["name"] == NAMES
    assert opened.locator("#targets b, #curves b").count() == 0
    wait_until(opened, lambda: [name for _, name, _ in opened.evaluate(LINES, "#curves")] == [NAMES])
    opened.get_by_label(f"rename {NAMES}").click()
    opened.keyboard.type("nobody")
    opened.keyboard.press("Escape")
    click_row(opened, UPPER)
    opened.locator("#targets li").nth(1).locator(".rename").click()
    opened.keyboard.type(NAMES.upper())
    opened.keyboard.press("Enter")
    wait_until(opened, "document.querySelector('#notes').innerText.includes('already')")
    assert rows(opened)[0] == NAMES
    assert rows(opened)[1] not in (NAMES.upper(), old)


def test_names_in_the_picture_are_short_and_beside_each_other(opened: Any) -> None:
    click_row(opened, APART)
    opened.locator("#targets li .all").click()
    wait_until(opened, lambda: len(rows(opened)) == 3)
    given = ["🏀" * 29, "w" * 60, "third"]
    for row, name in enumerate(given):
        opened.locator("#targets .rename").nth(row).click()
        opened.keyboard.insert_text(name)
        opened.keyboard.press("Enter")
    names = "[...document.querySelectorAll('#targets .words')].map((each) => each.textContent)"
    wait_until(opened, lambda: opened.evaluate(names) == given)
    opened.locator("#targets summary").locator("visible=true").click()
    chosen = opened.locator("#targets .chosen .words").inner_text()
    assert opened.get_by_label(f"diameter of {chosen}").is_visible()
    assert opened.get_by_label(f"width of the marker of {chosen}").is_visible()
    seen, boxes = set[str](), list[Any]()
    for _ in range(60):  # they pass each other
        drawn = opened.evaluate(BOXES)
        seen |= {words.rstrip("?") for words, *_ in drawn}
        boxes += [(a, b) for k, a in enumerate(drawn) for b in drawn[:k]]
        opened.wait_for_timeout(50)
    assert seen == {"🏀" * 23 + "…", "w" * 23 + "…", "third"}
    for (_, left, right, top, bottom), (_, begin, end, high, low) in boxes:
        assert min(right, end) - max(left, begin) < 3.0 or min(bottom, low) - max(top, high) < 5.0


def test_all_like_one_are_found_and_their_lives_are_marked(opened: Any) -> None:
    click_row(opened, APART)
    opened.locator("#targets li .all").click()
    wait_until(opened, lambda: len(rows(opened)) == 3)
    wait_until(opened, "document.querySelector('#targets .chosen .all').getAttribute('aria-pressed') === 'true'")
    (clicked,) = opened.locator("#targets .chosen .words").all_inner_texts()
    assert clicked == rows(opened)[0]  # what is found so does not take its place
    ids = [each["id"] for each in state_of(opened)["targets"]]
    births = [[each, "born"] for each in ids]
    wait_until(opened, lambda: [mark[:2] for mark in opened.evaluate(MARKS, "#curves")] == births)
    assert "first seen" in opened.evaluate(MARKS, "#curves")[0][2]
    opened.locator("#targets li .all").locator("visible=true").click()  # no more are looked for
    wait_until(opened, lambda: not any(each.get("finds") for each in state_of(opened)["targets"]))
    opened.locator("#targets li").first.locator(".drop").click()
    wait_until(opened, lambda: [ids[0], "ended"] in [mark[:2] for mark in opened.evaluate(MARKS, "#curves")])


def test_a_video_has_the_births_of_its_targets_on_the_time_line(show: Any, page: Any, video: Path) -> None:
    address = show(str(video))
    heard = Heard(page)
    page.goto(address)
    wait_for_picture(page)
    page.mouse.click(*on_screen(page, *crossing_balls.places(0)[0]))
    wait_until(page, lambda: len(rows(page)) == 1)
    page.locator("#targets .all").click()
    wait_until(page, lambda: len(rows(page)) == 3)
    wait_until(page, lambda: len(page.evaluate(MARKS, "#file")) == 3)
    marks = page.evaluate(MARKS, "#file")
    assert [mark[:2] for mark in marks[:2]] == [[1, "born"], [2, "born"]]
    assert marks[0][2].endswith("first seen in frame 0")
    first = int(marks[2][2].split()[-1])
    assert crossing_balls.LATE <= first < crossing_balls.LATE + 8
    tell(address, "rename", target=3, name="late one")
    names = ["circle 1", "circle 2", "late one"]
    wait_until(page, lambda: [name for _, name, _ in page.evaluate(LINES, "#file")] == names)
    hold(heard)
    box = page.locator("#file .lives svg").bounding_box()
    page.mouse.click(box["x"] + 0.8 * box["width"], box["y"] + 2.5 * 16.0)  # on its line: it is chosen, and shown there
    wait_until(page, "document.querySelector('#targets .chosen .words').textContent === 'late one'")
    wait_until(page, lambda: abs(state_of(page)["index"] - 0.8 * (crossing_balls.FRAMES - 1)) < 2.0)
