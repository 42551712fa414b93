"""`matchset fly --link mavlink:...`: real processes, a camera in the network, an autopilot behind a UDP socket."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from fake_autopilot import STABILIZE

from flight_process import FlightProcess, devices, errors
from mjpeg_server import MjpegServer
from served_autopilot import ServedAutopilot

pytestmark = pytest.mark.usefixtures("signals_end_programs")

FLIES = 235  # of 1000, what no other test's throttle reaches


@pytest.fixture
def served() -> Iterator[ServedAutopilot]:
    with ServedAutopilot() as autopilot:
        yield autopilot


def test_it_is_armed_flown_and_landed(
    tmp_path: Path, camera: MjpegServer, served: ServedAutopilot, files: list[str]
) -> None:
    flown = FlightProcess(tmp_path, "fly", *devices(tmp_path, camera.url, served.uri), *files, "--arm")
    flown.waits_for(lambda: served.has_flown(FLIES))
    flown.process.send_signal(signal.SIGTERM)
    code, out, err = flown.ended()
    assert code == 128 + signal.SIGTERM, out + err
    assert errors(err) == []
    assert served.pilot.mode == STABILIZE
    assert not served.pilot.armed
    assert "HEARTBEAT" in served.pilot.heard
