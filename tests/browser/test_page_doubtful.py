"""All like one on the page: what is doubtful is dashed and in words, and a click follows it; how many are left out."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from doubtful_ball import BALLS, FLAT, picture
from live_pages import on_screen, rows, state_of, wait_until

MIDDLE = """() => {
  const box = document.querySelector('#doubtful .doubtful polygon').getBoundingClientRect();
  return [box.x + box.width / 2, box.y + box.height / 2];
}"""


def scene(number: int) -> npt.NDArray[np.uint8]:
    return picture(0)


def test_what_is_doubtful_is_dashed_and_a_click_follows_it(opened: Any) -> None:
    opened.mouse.click(*on_screen(opened, *BALLS[1]))
    wait_until(opened, lambda: len(rows(opened)) == 1)
    assert opened.locator("#crowd").is_hidden()
    opened.locator("#targets .all").click()
    wait_until(opened, "crowd.textContent === '3 followed, 1 doubtful, 0 left out (most 20)'")
    mark = opened.get_by_role("img", name="doubtful: may be a ball")
    assert mark.count() == 1
    assert mark.locator("polygon").last.get_attribute("stroke-dasharray")
    assert opened.evaluate(MIDDLE) == pytest.approx(on_screen(opened, *FLAT), abs=16.0)  # of something flat
    opened.mouse.click(*on_screen(opened, *FLAT))
    wait_until(opened, "crowd.textContent === '4 followed, 0 doubtful, 0 left out (most 20)'")
    assert len(rows(opened)) == 4
    wait_until(opened, "said.hidden && !document.querySelector('#clicks .ring')")
    assert mark.count() == 0
    opened.locator("#targets .drop").last.click()  # no more are looked for
    wait_until(opened, lambda: "crowd" not in state_of(opened))
    wait_until(opened, "crowd.hidden")
    assert len(rows(opened)) == 3
