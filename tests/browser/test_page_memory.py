"""A page that is open for long: its memory does not grow with the pictures that it was sent, nor is a week too long."""

from typing import Any

from live_pages import Heard, click_ball, hold, state_of, wait_for_picture, wait_until

BEGIN, END = 800, 1800  # pictures; the heap grows by 0.1 MB up to 800, and by 6 kB in 1,500 more
LARGEST = 3e5  # bytes that the page's heap may grow from one to the other: 300 a picture

WEEK = 7 * 24 * 3600 * 30  # pictures

REPLAY = """(() => {
  const Real = window.WebSocket;
  window.WebSocket = class extends Real {
    set onmessage(take) {
      super.onmessage = (event) => {
        const flags = new DataView(event.data).getUint32(4, true);
        if ((flags & 3) === 1) window.sample ??= event.data.slice(0);
        if (!window.replaying) take(event);
      };
      window.feedPage = async (count) => {
        window.replaying = true;
        for (let i = 0; i < count; i++) {
          const data = window.sample.slice(0);
          const view = new DataView(data);
          window.number = (window.number ?? view.getUint32(0, true)) + 1;
          view.setUint32(0, window.number, true);
          view.setFloat64(8, window.number / 30, true);
          take({ data });
          await new Promise((done) => setTimeout(done, 4));
        }
      };
    }
  };
})()"""


def heap(page: Any) -> float:
    """Bytes that the page's scripts hold after a collection of garbage."""
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.collectGarbage")
    used: float = page.evaluate("performance.memory.usedJSHeapSize")
    return used


def test_memory_does_not_grow_with_pictures(served: str, page: Any) -> None:
    page.add_init_script(REPLAY)
    page.goto(served)
    wait_for_picture(page)
    page.evaluate("(count) => window.feedPage(count)", BEGIN)
    before = heap(page)
    page.evaluate("(count) => window.feedPage(count)", END - BEGIN)
    assert heap(page) - before < LARGEST
    assert page.evaluate("window.number") >= END


def test_a_page_that_is_open_for_a_week_shows_follows_and_draws(served: str, page: Any, clip: Any) -> None:
    heard = Heard(page)
    page.add_init_script(REPLAY)
    page.goto(served)
    click_ball(heard, clip[1])
    wait_until(page, "!document.getElementById('hint').checkVisibility()")
    hold(heard)
    clicked = state_of(page)["index"]
    page.locator("#file button.forward").click()
    wait_until(page, lambda: state_of(page)["index"] > clicked)
    wait_until(page, lambda: page.locator("#reading .number").count() >= 3)
    page.evaluate("(number) => { window.sample = undefined; window.number = number; }", WEEK)
    page.locator("#file button.back").click()  # to a frame in which the ball is known when it is shown
    wait_until(page, "window.sample !== undefined")
    page.evaluate("(count) => window.feedPage(count)", 200)
    assert page.evaluate("window.number") == WEEK + 200
    wait_until(page, lambda: any(number > WEEK for number in heard.acknowledged))
    assert page.locator("#reading .number").count() >= 3
    page.locator("#targets .drop").click()
