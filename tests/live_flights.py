"""A flight on the live page: how a test looks at it, and takes off as a person does."""

import functools
import json
import time
import urllib.request
from collections.abc import Callable
from typing import Any, ClassVar

from matchset.links.simulation_parameters import SimulationParameters

CHAIN = "sim://chain?vehicles=2&seed=5&width=320&height=240"  # small pictures: little work for a busy computer
RADIO = SimulationParameters().vehicle.radio_delay  # s, from a command to the motors
WAIT = 60.0  # s, at most
ATTEMPTS = 3
SILENT = "was silent"


class LiveFlight:
    """A flight that a server shows, seen by a program.

    Parameters
    ----------
    url : str
    page : playwright page
        Waiting lets it go on, until it is closed: what a test does between it and the server needs that.
    """

    last: ClassVar["LiveFlight | None"] = None

    def __init__(self, url: str, page: Any) -> None:
        self.url, self._page = url, page
        LiveFlight.last = self

    @property
    def state(self) -> dict[str, Any]:
        """What pages are told of it."""
        with urllib.request.urlopen(f"{self.url}state.json", timeout=10) as answer:
            panels = json.load(answer)["session"]["panels"]
        return {"duty": "idle", "page": "", "reason": "", "ready": False, "followers": [], **panels.get("flight", {})}

    def wait(self, what: Callable[[dict[str, Any]], object], seconds: float = WAIT) -> dict[str, Any]:
        """Wait until its state is so; returns it. A flight that silence has ended will not come to it."""
        end = time.monotonic() + seconds
        while not what(state := self.state):
            assert time.monotonic() < end, state
            assert state["duty"] != "stopped" or SILENT not in state["reason"], state
            if self._page.is_closed():
                time.sleep(0.02)
            else:
                self._page.wait_for_timeout(20)
        return state

    def wait_for_duty(self, duty: str) -> dict[str, Any]:
        """Wait for what is to be done."""
        return self.wait(lambda state: state["duty"] == duty)


def again_if_silent(test: Callable[..., None]) -> Callable[..., None]:
    """Begin a test again whose flight ended since a busy computer kept its page from saying that it is alive."""

    @functools.wraps(test)
    def run(*args: Any, **fixtures: Any) -> None:
        for left in reversed(range(ATTEMPTS)):
            try:
                test(*args, **fixtures)
            except Exception:  # an assertion, or a wait in the browser
                if not left or LiveFlight.last is None or SILENT not in LiveFlight.last.state["reason"]:
                    raise
            else:
                return

    return run


def hold(page: Any, seconds: float) -> None:
    """Press the button with the mouse for so long."""
    box = page.locator("#flight-arm").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.wait_for_timeout(1000.0 * seconds)
    page.mouse.up()


def take_off(page: Any, flight: LiveFlight) -> dict[str, Any]:
    """Hold the button, and wait until the first follower flies by what it sees."""
    page.locator("#flight-arm:enabled").wait_for(timeout=1000.0 * WAIT)
    hold(page, 1.2)
    state = flight.wait(lambda now: now["duty"] == "stopped" or now["duty"] == phase_of(now) == "flying")
    assert state["duty"] == "flying", state
    return state


def phase_of(state: dict[str, Any]) -> str:
    """Phase of the first follower."""
    return state["followers"][0]["phase"] if state["followers"] else ""
