"""Real vehicles under a page: a camera in the network, and a transmitter behind a pseudo-terminal."""

import functools
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pty_transmitter import PtyTransmitter

from matchset.links.arduino.protocol import ArduinoParameters
from matchset.live.piloting.flight_feed import FlightFeed, linked_flight
from matchset.live.piloting.messages import Alive, Arm, Kill
from matchset.live.session import Session
from matchset.live.sources.found_sources import given_source
from matchset.live.sources.opening import Opening, open_feed
from mjpeg_server import MjpegServer
from served_neighbor import SETTINGS, ServedNeighbor

WAIT = 120.0  # s
PACE = 0.25  # of the transmitter's clock: its failsafe has tests of its own
FLIES = 60  # of 255
TOML = f"""
{SETTINGS}
[[follower]]
camera = "{{camera}}"
link = "serial://{{link}}"
camera_file = "camera.toml"
color = ["ball.npz"]
marker_color = ["marker.npz"]
"""


class Page:
    """A page that looks at the flight of a file."""

    def __init__(self, path: Path, transmitter: PtyTransmitter) -> None:
        self.notes: list[str] = []
        feed = open_feed(given_source(str(path)), Opening(lambda _: None, self.notes.append))
        assert isinstance(feed, FlightFeed)
        self.feed, self.transmitter, self.session = feed, transmitter, Session()
        self.session.show(feed)

    def wait(self, what: Callable[[], object], alive: bool = True) -> None:
        """Wait until something holds, and say meanwhile that the page is alive."""
        end = time.monotonic() + WAIT
        while not what():
            state = self.feed.loop.state()
            assert time.monotonic() < end, (state.duty, state.fault, state.reason, state.followers)
            if alive:
                self.session.take(Alive(self.feed.streams[0].seen.state.sequence), "page 1")
            time.sleep(0.02)

    def take_off(self) -> None:
        """Arm, and wait until the motors turn."""
        self.wait(lambda: self.feed.loop.state().ready)
        assert self.transmitter.port.throttle == 0
        assert self.transmitter.port.state == "locked"
        self.session.take(Arm(), "page 1")
        self.wait(lambda: self.transmitter.port.throttle >= FLIES)


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Page]:
    patient = functools.partial(ArduinoParameters, timeout=4.0, startup_timeout=20.0, arm_timeout=20.0)
    monkeypatch.setattr("matchset.links.arduino.arduino_link.ArduinoParameters", patient)
    neighbor = ServedNeighbor()
    neighbor.write_files(tmp_path)
    with MjpegServer(neighbor) as camera, PtyTransmitter(PACE) as transmitter:
        (tmp_path / "flight.toml").write_text(TOML.format(camera=camera.url, link=transmitter.path))
        opened = Page(tmp_path / "flight.toml", transmitter)
        yield opened
        opened.session.close()


def test_a_silent_page_holds_then_descends_then_the_motors_are_off(page: Page) -> None:
    page.take_off()
    page.wait(lambda: page.feed.loop.state().duty == "holding", alive=False)
    assert page.transmitter.port.throttle > 0
    page.wait(lambda: page.feed.loop.state().duty == "descending", alive=False)
    page.wait(lambda: page.feed.loop.state().duty == "stopped", alive=False)
    page.wait(lambda: page.transmitter.port.throttle == 0)
    assert page.feed.loop.state().reason == "page 1 was silent for 1 s"
    assert "from their arrival" in page.notes[0]


def test_a_kill_stops_the_motors_with_the_next_packet(page: Page) -> None:
    page.take_off()
    page.session.take(Kill(), "page 2")
    taken = time.monotonic()
    page.wait(lambda: page.transmitter.port.throttle == 0, alive=False)
    still = {packet for packet in page.transmitter.packets_since(taken) if packet.throttle}  # read together: one
    assert len(still) <= 2
    assert page.transmitter.port.state == "locked"
    page.wait(lambda: page.feed.loop.state().duty == "stopped", alive=False)


def test_the_end_of_the_server_lands(page: Page) -> None:
    page.take_off()
    begin = time.monotonic()
    page.session.close()
    since = [packet.throttle for packet in page.transmitter.packets_since(begin)]
    assert len([throttle for throttle in since if throttle]) > 10  # a ramp, no fall
    assert page.transmitter.port.throttle == 0
    assert page.transmitter.port.state == "locked"


def test_settings_without_vehicles_are_refused_in_words(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("[flight]\nduration = 3\n")
    with pytest.raises(ValueError, match=r"names no real vehicle: it has no \[\[follower\]\]"):
        linked_flight(path, lambda _: None, lambda _: None)
    path.write_text('[[follower]]\ncamera = 0\nlink = "serial:///dev/ttyUSB0"\nfov_deg = 60\n')
    with pytest.raises(ValueError, match=r"say what color the ball has: .*matchset learn 0"):
        linked_flight(path, lambda _: None, lambda _: None)
