"""`matchset fly --link mavlink:...`: real processes, a camera in the network, an autopilot behind a UDP socket."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from fake_autopilot import RTL, STABILIZE
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
    code, out, err = FlightProcess(
        tmp_path, "fly", *devices(tmp_path, camera.url, served.uri), *files, "--arm", "--duration", "8"
    ).ended()
    pilot = served.pilot
    assert code in (0, 1), out + err
    assert errors(err) == []
    assert max(z for _, _, z, _ in pilot.sticks) >= FLIES
    assert pilot.mode == STABILIZE
    assert not pilot.armed
    assert pilot.heard.count("HEARTBEAT") >= 8


def test_its_refusal_is_one_line_with_its_reason(
    tmp_path: Path, camera: MjpegServer, served: ServedAutopilot, files: list[str]
) -> None:
    served.pilot.refusal = "PreArm: Compass not calibrated"
    code, out, err = FlightProcess(tmp_path, "fly", *devices(tmp_path, camera.url, served.uri), *files, "--arm").ended()
    assert code == 3, out + err
    assert len(errors(err)) == 1
    assert "arming refused by ArduPilot (failed): PreArm: Compass not calibrated" in errors(err)[0]
    assert not served.pilot.armed


def test_when_it_takes_over_the_flight_ends_and_it_is_left_alone(
    tmp_path: Path, camera: MjpegServer, served: ServedAutopilot, files: list[str]
) -> None:
    flown = FlightProcess(tmp_path, "fly", *devices(tmp_path, camera.url, served.uri), *files, "--arm")
    flown.waits_for(lambda: served.has_flown(FLIES))
    served.pilot.say_text("Battery failsafe", 3)
    served.pilot.mode = RTL
    code, out, err = flown.ended()
    assert code == 1, out + err
    assert "ArduPilot is in RTL, by itself or by another pilot's switch" in out + err
    assert served.pilot.armed


def test_one_that_falls_silent_is_one_line(
    tmp_path: Path, camera: MjpegServer, served: ServedAutopilot, files: list[str]
) -> None:
    flown = FlightProcess(tmp_path, "fly", *devices(tmp_path, camera.url, served.uri), *files, "--arm")
    flown.waits_for(lambda: served.has_flown(FLIES))
    served.pilot.mute = True
    code, out, err = flown.ended()
    assert code == 3, out + err
    assert len(errors(err)) == 1
    assert "vehicle 1 has been silent for 2." in errors(err)[0]
