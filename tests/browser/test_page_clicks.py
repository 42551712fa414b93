"""A click on the page: a ring at once, the outline or the words why not, a next click that counts; faults in full."""

import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from live_clips import LAST
from live_pages import WAIT, Heard, on_screen, state_of, wait_for_picture, wait_until
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from mjpeg_server import MjpegServer

Clip = tuple[Path, BallFlightClip]
BALL, NOTHING = (100, 120), (290, 20)  # px
LOOK = """() => {
  window.seen = [];
  const look = () => {
    const ring = document.querySelectorAll('#clicks .ring').length;
    const outline = document.querySelectorAll('#drawing .outline').length;
    const last = window.seen[window.seen.length - 1];
    const now = [ring, outline, document.getElementById('hint').textContent];
    if (!last || String(last) !== String(now)) window.seen.push(now);
    requestAnimationFrame(look);
  };
  look();
}"""  # notes what stands on the picture, whenever that is something else
OUTSIDE = """(id) => {
  const box = document.getElementById(id).getBoundingClientRect();
  const range = document.createRange();
  range.selectNodeContents(document.getElementById(id));
  return [...range.getClientRects()].filter((line) => line.left < box.left - 1 || line.right > box.right + 1
    || line.top < box.top - 1 || line.bottom > box.bottom + 1).length;
}"""  # lines of words that are not inside of their place


def scene(number: int) -> npt.NDArray[np.uint8]:
    """A blue ball before gray."""
    image = np.random.default_rng(number % 8).normal(90.0, 2.0, (240, 320, 3))
    cv2.circle(image, (BALL[0] + number % 2, BALL[1]), 30, (210, 90, 30), cv2.FILLED, cv2.LINE_AA)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7).astype(np.uint8)


def test_a_ring_is_there_before_any_answer_and_goes_when_the_outline_comes(opened: Any) -> None:
    ring = opened.evaluate(
        """([x, y]) => {
          const options = { clientX: x, clientY: y, pointerId: 99, button: 0, bubbles: true };
          for (const name of ["pointerdown", "pointerup"]) view.dispatchEvent(new PointerEvent(name, options));
          const box = document.querySelector('#clicks .ring')?.getBoundingClientRect();
          return box && [box.x + box.width / 2 - x, box.y + box.height / 2 - y, hint.textContent];
        }""",
        list(on_screen(opened, *BALL)),
    )  # in the same task as the click: nothing can have come from the server
    assert ring[:2] == pytest.approx([0, 0], abs=1.5)
    assert ring[2] == "finding it …"
    wait_until(opened, "document.querySelector('#drawing .outline') !== null")
    wait_until(opened, "document.querySelector('#clicks .ring') === null")
    assert opened.locator("#hint").is_hidden()
    assert opened.locator("#said").is_hidden()


def test_a_wrong_click_is_refused_in_words_that_stay_and_the_next_one_counts(opened: Any) -> None:
    opened.mouse.click(*on_screen(opened, *NOTHING))
    said = opened.locator("#said")
    said.wait_for(timeout=WAIT)
    words = said.inner_text()
    assert len(words) > 20
    wait_until(opened, "document.querySelectorAll('#targets li').length === 0")
    begun = state_of(opened)["sequence"]
    wait_until(opened, lambda: state_of(opened)["sequence"] > begun + 40)  # many pictures and states come meanwhile
    assert said.inner_text() == words
    assert opened.locator("#clicks .refused").count() == 1
    assert words.rstrip("×").strip() not in opened.locator("#notes").inner_text()  # it is said once
    opened.mouse.click(*on_screen(opened, *BALL))
    said.wait_for(state="hidden", timeout=WAIT)
    wait_until(opened, "document.querySelector('#drawing .outline') !== null")
    opened.mouse.click(*on_screen(opened, *NOTHING))
    said.wait_for(timeout=WAIT)
    said.get_by_role("button").click()
    said.wait_for(state="hidden", timeout=WAIT)
    assert opened.locator("#clicks").evaluate("(each) => each.childElementCount") == 0


def test_a_ring_stands_still_where_no_motion_is_wanted(camera: MjpegServer, show: Any, new_page: Any) -> None:
    for wish, animation in (("reduce", "none"), ("no-preference", "pulse")):
        page = new_page(reduced_motion=wish)
        page.goto(show(camera.url))
        wait_for_picture(page)
        page.route("**/*", lambda route: route.abort())
        name = page.evaluate(
            """([x, y]) => {
              const options = { clientX: x, clientY: y, pointerId: 99, button: 0, bubbles: true };
              for (const name of ["pointerdown", "pointerup"]) view.dispatchEvent(new PointerEvent(name, options));
              return getComputedStyle(document.querySelector('#clicks .ring')).animationName;
            }""",
            list(on_screen(page, *NOTHING)),
        )
        assert name == animation


def test_the_outline_is_in_the_clicked_picture_of_a_video_and_it_plays_as_far_as_it_is_tracked(
    show: Any, page: Any, clip: Clip
) -> None:
    heard = Heard(page)
    page.goto(show(str(clip[0])))
    wait_for_picture(page)
    wait_until(page, lambda: heard.painted is not None)
    page.evaluate(LOOK)
    (pixel,) = clip[1].camera.project(clip[1].place(0.0)[None])
    page.mouse.click(*on_screen(page, *pixel))
    wait_until(page, lambda: heard.states[-1].index > 20)
    found = [state for state in heard.states if state.targets and state.targets[0].found]
    assert found[0].index == 0
    shown = [state for state in heard.states if state.index > 0]
    assert all(state.targets and not state.targets[0].pending for state in shown)
    assert page.locator("#reading .lost").count() == 0
    seen = page.evaluate("window.seen")
    assert ["finding it …" in each for each in seen].index(True) < [each[1] > 0 for each in seen].index(True)
    page.get_by_text(f"frame {LAST} of {LAST}").wait_for(timeout=3 * WAIT)


def test_a_click_without_a_connection_is_said(serve: Any, page: Any, clip: Clip) -> None:
    page.goto(serve(str(clip[0])))
    wait_for_picture(page)
    (server,) = serve.processes
    server.terminate()
    server.wait(30)
    page.locator("#link").get_by_text(re.compile("no connection|connecting again")).wait_for(timeout=WAIT)
    page.mouse.click(*on_screen(page, *BALL))
    page.locator("#said").get_by_text("no connection").wait_for(timeout=WAIT)
    assert page.locator("#clicks .ring").count() == 0


@pytest.mark.parametrize("size", [(1280, 900), (390, 844)])
def test_a_long_fault_is_read_in_full_on_an_upright_picture(
    film: Any, serve: Any, new_page: Any, size: tuple[int, int]
) -> None:
    camera = film(lambda _: np.full((320, 90, 3), 90, np.uint8))
    page = new_page(viewport={"width": size[0], "height": size[1]})
    page.goto(serve(camera.url))
    wait_for_picture(page)
    camera.stop()
    page.locator("#veil").get_by_text(re.compile("tried again every 1 s")).wait_for(timeout=WAIT)
    assert page.evaluate(OUTSIDE, "veil") == 0
    assert "127.0.0.1" in page.locator("#veil").inner_text()


def test_a_picture_that_is_gone_is_said_in_one_place(film: Any, serve: Any, page: Any) -> None:
    camera = film(scene)
    page.goto(serve(camera.url))
    wait_for_picture(page)
    page.mouse.click(*on_screen(page, *BALL))
    wait_until(page, "document.querySelector('#reading .number') !== null")
    camera.stop()
    page.locator("#veil").get_by_text(re.compile("tried again every 1 s")).wait_for(timeout=WAIT)
    page.locator("#reading .why").get_by_text("no picture comes", exact=True).wait_for(timeout=WAIT)
    assert "tried again" not in page.locator("#reading").inner_text()
    assert "tried again" not in page.locator("#notes").inner_text()
    assert state_of(page)["fault"]
