"""The age of the picture on the screen of a real browser: `ages_on_screen`."""

import shutil
from typing import Any

from benchmarks.live.bar_code import READ

SAMPLE = """([seconds]) => new Promise((answer) => {
  const read = READ, ages = [], seen = new Set();
  let begin = null;
  const look = (now) => {
    begin ??= now;
    const found = read();
    if (found && !seen.has(found[0])) { seen.add(found[0]); ages.push(found[1]); }
    if (now - begin < 1000 * seconds) requestAnimationFrame(look); else answer(ages);
  };
  requestAnimationFrame(look);
})""".replace("READ", READ)
SETTLING = 3.0  # s before the first sample
SIZE = {"width": 1280, "height": 900}  # geometry: of the window, CSS px


def ages_on_screen(address: str, seconds: float, pages: int = 1) -> list[float]:
    """Open pages in Chromium and read the bar code of each picture in the first frame that shows it.

    Parameters
    ----------
    address : str
    seconds : float
        For how long.
    pages : int
        That look at the same time; one is read.

    Returns
    -------
    list of float
        Ages of the pictures, ms.

    Raises
    ------
    ValueError
        If there is no chromium.
    """
    from playwright.sync_api import sync_playwright

    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        raise ValueError("the benchmark of the live page needs chromium: .ci/browser installs it")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        opened: list[Any] = [browser.new_context(viewport=SIZE).new_page() for _ in range(pages)]  # type: ignore[arg-type]
        for page in opened:
            page.goto(address)
        opened[0].wait_for_timeout(1000.0 * SETTLING)
        ages: list[float] = opened[0].evaluate(SAMPLE, [seconds])
        browser.close()
    return ages
