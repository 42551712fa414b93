"""A simulated flight on the page: take-off, landing, the kill switch by key, by mouse and by thumb, two pages."""

import urllib.request
from typing import Any

import pytest

from live_flights import CHAIN, RADIO, WAIT, LiveFlight, again_if_silent, hold, take_off
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.links.simulation_parameters import parse_uri

TENTH = 0.1  # s, within which motors must have stopped
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}


@pytest.fixture(scope="session", autouse=True)
def flown() -> None:
    """What a flight needs is compiled before a server does."""
    with Flight(FlightParameters(duration=0.1, world=parse_uri(CHAIN))) as flight:
        assert len(list(flight)) == 3


@again_if_silent
def test_it_takes_a_second_to_arm_and_the_space_bar_stops_the_motors_at_once(show: Any, page: Any) -> None:
    flight = LiveFlight(show(CHAIN), page)
    page.goto(flight.url)
    page.locator("#flight-arm:enabled").wait_for(timeout=1000.0 * WAIT)
    hold(page, 0.4)
    page.wait_for_timeout(200)
    assert flight.state["duty"] == "idle"
    take_off(page, flight)
    page.get_by_text("You command.").wait_for()
    page.locator("#flight-land").focus()
    page.evaluate("document.body.style.minHeight = '300vh'")
    page.keyboard.press("Space")
    state = flight.wait(lambda now: now.get("stop_delay") is not None)
    assert state["stop_delay"] + RADIO < TENTH
    assert state["reason"].endswith("stopped the motors")  # and did not press the button that had the focus
    assert page.evaluate("scrollY") == 0
    assert state["followers"][0]["throttle"] == 0.0
    page.get_by_text("Motors off: ").wait_for()
    assert page.locator("#flight-arm").is_hidden()
    page.click("#flight-again")
    state = flight.wait(lambda now: now["duty"] == "idle" and now["ready"])
    assert state["followers"][0]["reason"] == "not armed"


@again_if_silent
def test_the_enter_key_arms_and_lands(show: Any, page: Any) -> None:
    flight = LiveFlight(show(CHAIN), page)
    page.goto(flight.url)
    page.locator("#flight-arm:enabled").wait_for(timeout=1000.0 * WAIT)
    page.locator("#flight-arm").focus()
    page.keyboard.down("Enter")
    page.wait_for_timeout(1200)
    page.keyboard.up("Enter")
    flight.wait(lambda state: state["duty"] == "flying" and state["followers"][0]["phase"] == "flying")
    page.locator("#flight-land").focus()
    page.keyboard.press("Enter")
    state = flight.wait_for_duty("stopped")
    assert state["reason"].endswith("ended the flight")
    assert "stop_delay" not in state


@again_if_silent
def test_two_pages_watch_and_one_commands(show: Any, new_page: Any) -> None:
    first, second = new_page(), new_page()
    flight = LiveFlight(show(CHAIN), first)
    first.goto(flight.url)
    second.goto(flight.url)
    commands = take_off(first, flight)["page"]
    second.get_by_text("Another page commands, in flight").wait_for(timeout=1000.0 * WAIT)
    assert second.locator("#flight-arm").is_disabled()
    assert second.locator("#flight-land").is_disabled()
    second.click("#flight-kill")
    state = flight.wait(lambda now: now.get("stop_delay") is not None)
    assert state["stop_delay"] + RADIO < TENTH
    assert commands not in state["reason"]
    first.get_by_text("Motors off: ").wait_for()


@again_if_silent
def test_a_program_stops_the_motors(show: Any, page: Any) -> None:
    flight = LiveFlight(show(CHAIN), page)
    page.goto(flight.url)
    take_off(page, flight)
    order = urllib.request.Request(f"{flight.url}do/kill", data=b"", method="POST")
    with urllib.request.urlopen(order, timeout=10) as answer:
        assert answer.status == 204
    state = flight.wait(lambda now: now.get("stop_delay") is not None)
    assert state["stop_delay"] + RADIO < TENTH
    assert state["reason"] == "a program stopped the motors"


@again_if_silent
def test_on_a_phone_the_red_button_is_always_under_the_thumb(show: Any, new_page: Any) -> None:
    phone = new_page(**PHONE)
    flight = LiveFlight(show(CHAIN), phone)
    phone.goto(flight.url)
    take_off(phone, flight)
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390
    for place in ("0", "document.body.scrollHeight"):
        phone.evaluate(f"window.scrollTo(0, {place})")
        box = phone.locator("#flight-kill").bounding_box()
        assert box["y"] + box["height"] <= 844
        assert box["y"] > 844 / 2
        assert box["width"] > 300
        assert box["height"] > 60
    phone.locator("#flight-kill").tap()
    state = flight.wait(lambda now: now.get("stop_delay") is not None)
    assert state["stop_delay"] + RADIO < TENTH


def test_while_it_gets_ready_the_page_says_how_far_it_is(show: Any, page: Any) -> None:
    page.goto(show(CHAIN))
    page.locator("#flight-arm:enabled").wait_for(timeout=1000.0 * WAIT)
    said = page.evaluate("""() => import('/flight/flight.js').then(({ words }) => [
      words({ duty: 'idle', ready: false, kernels: 12, preparing: 26 }, false),
      words({ duty: 'idle', ready: false }, false),
      words({ duty: 'stopped', ready: true, reason: 'page 2 stopped the motors' }, false, new Set(['page 2'])),
      words({ duty: 'stopped', ready: true, reason: 'page 2 stopped the motors' }, false, new Set(['page 3'])),
      words({ duty: 'stopped', ready: true, reason: 'a program stopped the motors' }, false, new Set(['page 3'])),
    ])""")
    assert said[0] == "Getting ready, 26 s so far: compiling, only once on this machine, 12 pieces done."
    assert said[1].startswith("Getting ready: ")
    assert said[2:] == [f"Motors off: {who} stopped the motors." for who in ("this page", "another page", "a program")]
    first = """() => import('/flight/flight_pictures.js').then(({ FollowerPicture }) => {
      const picture = new FollowerPicture(0);
      picture.painted = -26000;
      picture.refresh();
      return picture.veil.textContent;
    })"""
    assert page.evaluate(first) == "getting ready …"
    legend = page.locator("figcaption", has_text="From above")
    assert "ross" in legend.inner_text()
    above = """() => [...document.querySelectorAll('#flight-map .set-place')].map((cross) => {
      const box = cross.getBoundingClientRect();
      return document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2) === cross;
    })"""
    legend.scroll_into_view_if_needed()
    assert page.evaluate(above) == [True]  # nothing is drawn over them


def test_a_flight_fits_a_phone_before_and_after_the_motors_stop(show: Any, new_page: Any) -> None:
    phone = new_page(**PHONE)
    flight = LiveFlight(show(CHAIN), phone)
    phone.goto(flight.url)
    phone.locator("#flight-arm:enabled").wait_for(timeout=1000.0 * WAIT)
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390
    table = phone.locator(".flight-table-place")
    assert table.evaluate("(each) => each.scrollWidth <= each.clientWidth")
    narrow = "(cells) => cells.filter((each) => each.offsetParent && each.scrollWidth > each.clientWidth).length"
    assert table.locator("th, td").evaluate_all(narrow) == 0
