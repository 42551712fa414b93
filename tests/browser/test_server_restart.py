"""A server that dies and comes back while a page looks at it."""

from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from live_pages import WAIT, Heard, click_ball, wait_until
from matchset.sim.clips.ball_flight_clip import BallFlightClip

NUMBERED = 60  # pictures, after which those of the new server have smaller numbers


def test_a_page_connects_again_by_itself(serve: Any, page: Any, clip: tuple[Path, BallFlightClip]) -> None:
    path, truth = clip
    heard = Heard(page)
    address = serve(str(path))
    page.goto(address)
    wait_until(page, lambda: heard.painted is not None)
    page.locator("#file .play").click()
    wait_until(page, lambda: heard.states[-1].sequence > NUMBERED)
    click_ball(heard, truth)
    page.evaluate("window.sameDocument = true")
    (server,) = serve.processes
    server.kill()
    server.wait()
    page.locator("#link[data-state=bad]").wait_for(timeout=WAIT)
    page.locator("#veil").wait_for(timeout=WAIT)  # the picture is old, and that is said
    before = len(heard.states)
    assert serve(str(path), "--port", str(urlsplit(address).port)) == address
    wait_until(page, lambda: len(heard.states) > before)
    page.locator("#veil").wait_for(state="hidden", timeout=WAIT)
    page.locator("#link[data-state=bad]").wait_for(state="detached", timeout=WAIT)
    # What was followed is unknown to the new server: the list says so, and a click is answered.
    page.locator("#targets li").wait_for(state="detached", timeout=WAIT)
    click_ball(heard, truth)
    assert page.evaluate("window.sameDocument")
