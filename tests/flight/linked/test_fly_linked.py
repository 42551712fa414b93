"""`matchset fly --camera --link`: real processes, a camera in the network, a transmitter behind a pseudo-terminal."""

import signal
import time
from pathlib import Path

import pytest
from pty_transmitter import PtyTransmitter

from blue_ball import Matchset
from flight_process import PACE, SHORT, FlightProcess, devices, errors
from matchset.links.arduino.arduino_link import ArduinoLink
from mjpeg_server import MjpegServer
from served_neighbor import ServedNeighbor

pytestmark = pytest.mark.usefixtures("signals_end_programs")

FOLLOWER = """
[[follower]]
camera = "{camera}"
link = "serial://{link}"
camera_file = "camera.toml"
color = ["ball.npz"]
marker_color = ["marker.npz"]
"""


@pytest.fixture
def line(tmp_path: Path, camera: MjpegServer, transmitter: PtyTransmitter, files: list[str]) -> list[str]:
    """Options of a flight with all that it needs."""
    return [*devices(tmp_path, camera.url, f"serial://{transmitter.path}"), *files]


def test_a_dry_run_sends_no_throttle_and_goes_on_where_a_stream_breaks_off(
    tmp_path: Path, neighbor: ServedNeighbor, transmitter: PtyTransmitter, files: list[str]
) -> None:
    with MjpegServer(neighbor, each=45) as server:
        words = devices(tmp_path, server.url, f"serial://{transmitter.path}")
        flown = FlightProcess(tmp_path, "fly", *words, *files)
        flown.waits_for(lambda: bool(transmitter.port.heard))
        opened = server.connections
        flown.waits_for(lambda: server.connections >= opened + 2)
        flown.process.send_signal(signal.SIGTERM)
        code, out, err = flown.ended()
    assert code == 128 + signal.SIGTERM, out + err
    assert {moment.throttle for moment in transmitter.moments} == {0}
    assert "armed" not in {moment.state for moment in transmitter.moments}
    assert all(heard[2] == heard[4] == 172 for heard in transmitter.port.heard)  # throttle and arm switch low
    assert "dry run: no throttle was sent; everybody would have taken off" in out
    assert "gives no time of capture" in err
    assert "DRY RUN: no throttle is sent" in err
    assert f"note: {server.url} broke off; it is opened again, for 10 s at most" in err
    assert f"note: {server.url} is back after" in err
    assert errors(err) == []


@pytest.mark.parametrize("number", [signal.SIGUSR1, signal.SIGTERM])
def test_signals_stop_the_motors(
    tmp_path: Path, camera: MjpegServer, transmitter: PtyTransmitter, line: list[str], number: signal.Signals
) -> None:
    flown = FlightProcess(tmp_path, "fly", *line, "--arm", "--report", "flight.html")
    flown.flies(transmitter)
    begin = time.monotonic()
    flown.process.send_signal(number)
    code, out, err = flown.ended()
    assert code == (1 if number == signal.SIGUSR1 else 128 + number), out + err
    assert "A flight" in (tmp_path / "flight.html").read_text()
    assert transmitter.port.throttle == 0
    assert transmitter.port.state == "locked"
    after = [packet.throttle for packet in transmitter.packets_since(begin)]
    if number == signal.SIGUSR1:
        assert after.index(0) <= 2
        assert "vehicle 1 was cut: SIGUSR1 came" in out
    else:
        assert len([throttle for throttle in after if throttle]) > 15  # a landing, no fall
        assert "note: stopped; everyone landed" in err


def test_two_followers_of_a_file_and_one_camera_that_is_gone(
    tmp_path: Path, neighbor: ServedNeighbor, camera: MjpegServer, transmitter: PtyTransmitter, files: list[str]
) -> None:
    assert files
    with MjpegServer(neighbor) as other, PtyTransmitter(PACE) as second:
        pairs = ((camera.url, transmitter.path), (other.url, second.path))
        text = SHORT + "".join(FOLLOWER.format(camera=url, link=path) for url, path in pairs)
        (tmp_path / "two.toml").write_text(text)
        flown = FlightProcess(tmp_path, "fly", "--config", "two.toml", "--arm")
        for each in (transmitter, second):
            flown.flies(each)
        other.stop()
        code, out, err = flown.ended()
        assert code == 3, out + err
        assert len(errors(err)) == 1
        assert f"{other.url} has delivered no picture" in errors(err)[0]
        for each in (transmitter, second):
            assert (each.port.throttle, each.port.state) == (0, "locked")
        assert "vehicle 2 came down along the safety path" in out


def test_a_port_that_vanishes_is_one_line(
    tmp_path: Path, camera: MjpegServer, transmitter: PtyTransmitter, line: list[str]
) -> None:
    flown = FlightProcess(tmp_path, "fly", *line, "--arm")
    flown.flies(transmitter)
    transmitter.unplug()
    code, out, err = flown.ended()
    assert code == 3, out + err
    assert len(errors(err)) == 1
    assert "has gone (unplugged?)" in errors(err)[0]


def test_two_programs_do_not_share_a_port(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], transmitter: PtyTransmitter, line: list[str]
) -> None:
    with ArduinoLink(transmitter.path):
        assert matchset("fly", *line) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert errors(err) == [f"error: cannot open {transmitter.path}: another program uses it"]


def test_what_does_not_open_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], tmp_path: Path, camera: MjpegServer, files: list[str]
) -> None:
    assert matchset("fly", *devices(tmp_path, camera.url, "serial:///dev/ttyNONE"), *files) == 3
    out, err = capsys.readouterr()
    assert (out, len(errors(err))) == ("", 1)
    assert "/dev/ttyNONE" in errors(err)[0]
    assert matchset("fly", *devices(tmp_path, camera.url, "serial:///dev/ttyNONE")) == 2
    out, err = capsys.readouterr()
    assert (out, len(errors(err))) == ("", 1)
    assert "matchset calibrate" in errors(err)[0]
