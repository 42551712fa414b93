"""A page that is open for long: its memory does not grow with the pictures that it was sent."""

from typing import Any

from live_pages import wait_for_picture

BEGIN, END = 800, 1800  # pictures; the heap grows by 0.1 MB up to 800, and by 6 kB in 1,500 more
LARGEST = 3e5  # bytes that the page's heap may grow from one to the other: 300 a picture

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
