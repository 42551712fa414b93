"""A page that falls silent in flight: closed, hidden, hung, cut off; all hold, then land, and it never arms again."""

from collections.abc import Callable
from typing import Any

import pytest

from live_flights import CHAIN, WAIT, LiveFlight, again_if_silent, take_off

Silence = Callable[[Any, dict[str, bool]], None]


def close(page: Any, _: dict[str, bool]) -> None:
    page.close()


def hide(page: Any, _: dict[str, bool]) -> None:
    page.evaluate("Object.defineProperty(document, 'hidden', { get: () => true })")


def hang(page: Any, _: dict[str, bool]) -> None:
    busy = "const end = performance.now() + 4000; while (performance.now() < end);"
    page.evaluate(f"setTimeout(() => {{ {busy} }}, 0)")


def cut_off(_: Any, line: dict[str, bool]) -> None:
    line["works"] = False


@pytest.mark.parametrize("silence", [close, hide, hang, cut_off])
@again_if_silent
def test_silence_holds_then_lands(show: Any, page: Any, silence: Silence) -> None:
    line = {"works": True}

    def relay(socket: Any) -> None:
        server = socket.connect_to_server()
        socket.on_message(lambda data: server.send(data) if line["works"] else None)
        server.on_message(lambda data: socket.send(data) if line["works"] else None)

    flight = LiveFlight(show(CHAIN), page)
    if silence is cut_off:
        page.route_web_socket("**/ws", relay)
    page.goto(flight.url)
    commands = take_off(page, flight)["page"]
    silence(page, line)
    held = flight.wait_for_duty("holding")
    assert held["followers"][0]["phase"] == "flying"
    assert held["page"] == commands
    flight.wait_for_duty("descending")
    state = flight.wait_for_duty("stopped")
    assert state["reason"] == f"{commands} was silent for 1 s"
    assert state["followers"][0]["throttle"] == 0.0


@again_if_silent
def test_a_page_that_reconnects_does_not_command_and_never_arms(show: Any, page: Any) -> None:
    flight, sockets = LiveFlight(show(CHAIN), page), list[Any]()

    def relay(socket: Any) -> None:
        sockets.append(socket)
        server = socket.connect_to_server()
        socket.on_message(server.send)
        server.on_message(socket.send)

    page.route_web_socket("**/ws", relay)
    page.goto(flight.url)
    commands = take_off(page, flight)["page"]
    sockets[0].close()
    flight.wait_for_duty("holding")
    state = flight.wait_for_duty("stopped")
    assert state["reason"] == f"{commands} was silent for 1 s"
    assert len(sockets) == 2
    page.get_by_text("Motors off: this page was silent").wait_for()
    page.click("#flight-again")
    page.locator("#flight-arm:enabled").wait_for(timeout=1000.0 * WAIT)
    page.wait_for_timeout(500)
    state = flight.state
    assert (state["duty"], state["page"]) == ("idle", "")
    assert state["followers"][0]["reason"] == "not armed"
