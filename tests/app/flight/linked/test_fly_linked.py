"""`matchset fly --camera --link`: real processes, a camera in the network, a transmitter behind a pseudo-terminal."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pty_transmitter import PtyTransmitter

import patient_matchset
from mjpeg_server import MjpegServer
from served_neighbor import ServedNeighbor

pytestmark = pytest.mark.usefixtures("signals_end_programs")

PACE = 0.25  # of the transmitter's clock: its failsafe has tests of its own, on a computer that does nothing else
FLIES = 60  # of 255, what no other test's throttle reaches
PROGRAM = Path(patient_matchset.__file__)
SHORT = """
[flight]
duration = 30.0
[flight.linked]
countdown = 0.5
[flight.pilot.safety]
fresh = 1.0
[flight.pilot.follower.answer]
limit = 100.0
"""
# The camera does not answer to the sticks, which is known after some seconds, rightly.
FOLLOWER = """
[[follower]]
camera = "{camera}"
link = "serial://{link}"
camera_file = "camera.toml"
color = ["ball.npz"]
marker_color = ["marker.npz"]
"""


def devices(folder: Path, camera: str, link: str) -> list[str]:
    """Options that name them, and a file of settings."""
    (folder / "short.toml").write_text(SHORT)
    return ["--camera", camera, "--link", link, "--config", str(folder / "short.toml")]


class Flown:
    """A real flight as a process."""

    def __init__(self, folder: Path, *words: str) -> None:
        line = ["fly", *words]
        self.process = subprocess.Popen(
            [sys.executable, str(PROGRAM), *line],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def flies(self, transmitter: PtyTransmitter) -> None:
        """Wait until motors turn."""
        self.waits_for(lambda: transmitter.port.throttle >= FLIES)

    def waits_for(self, happens: Callable[[], bool]) -> None:
        """Wait until something happens, which a process that has ended does not do."""
        end = time.monotonic() + 300.0
        while not happens():
            assert self.process.poll() is None, self.process.communicate()
            assert time.monotonic() < end
            time.sleep(0.01)

    def ended(self) -> tuple[int, str, str]:
        out, err = self.process.communicate(timeout=300)
        assert "Traceback" not in err, err
        return self.process.returncode, out, err


def errors(err: str) -> list[str]:
    return [line for line in err.splitlines() if line.startswith("error: ")]


@pytest.fixture(scope="module")
def neighbor() -> ServedNeighbor:
    return ServedNeighbor()


@pytest.fixture
def camera(neighbor: ServedNeighbor) -> Iterator[MjpegServer]:
    with MjpegServer(neighbor) as server:
        yield server


@pytest.fixture
def patient() -> Iterator[PtyTransmitter]:
    with PtyTransmitter(PACE) as opened:
        yield opened


@pytest.fixture
def files(neighbor: ServedNeighbor, tmp_path: Path) -> list[str]:
    return neighbor.write_files(tmp_path)


@pytest.fixture
def line(tmp_path: Path, camera: MjpegServer, patient: PtyTransmitter, files: list[str]) -> list[str]:
    """Options of a flight with all that it needs."""
    return [*devices(tmp_path, camera.url, f"serial://{patient.path}"), *files]


def test_a_dry_run_sends_no_throttle_and_says_what_it_would_send(
    tmp_path: Path, camera: MjpegServer, patient: PtyTransmitter, line: list[str]
) -> None:
    code, out, err = Flown(tmp_path, *line, "--duration", "7").ended()
    assert code == 0, out + err
    assert {moment.throttle for moment in patient.moments} == {0}
    assert "armed" not in {moment.state for moment in patient.moments}
    assert all(heard[2] == heard[4] == 172 for heard in patient.port.heard)  # throttle and arm switch low
    assert "dry run: no throttle was sent; everybody would have taken off" in out
    assert re.search(r"flying, 1\.\d\d m.*would send roll [+-]0\.\d\d pitch .* throttle 0\.[2-9]", err), err
    assert "gives no time of capture" in err
    assert "DRY RUN: no throttle is sent" in err


def test_a_camera_that_is_gone_brings_it_down_by_the_pilots_safety(
    tmp_path: Path, camera: MjpegServer, patient: PtyTransmitter, line: list[str]
) -> None:
    flown = Flown(tmp_path, *line, "--arm")
    flown.flies(patient)
    camera.stop()
    code, out, err = flown.ended()
    assert code == 3, out + err
    assert len(errors(err)) == 1
    assert "has delivered no picture for" in errors(err)[0]
    assert "came down along the safety path" in out
    assert patient.port.throttle == 0
    assert patient.port.state == "locked"


@pytest.mark.parametrize("number", [signal.SIGUSR1, signal.SIGINT, signal.SIGTERM])
def test_signals_stop_the_motors(
    tmp_path: Path, camera: MjpegServer, patient: PtyTransmitter, line: list[str], number: signal.Signals
) -> None:
    flown = Flown(tmp_path, *line, "--arm", "--report", "flight.html")
    flown.flies(patient)
    begin = time.monotonic()
    flown.process.send_signal(number)
    code, out, err = flown.ended()
    assert code == (1 if number == signal.SIGUSR1 else 128 + number), out + err
    assert "A flight" in (tmp_path / "flight.html").read_text()
    assert patient.port.throttle == 0
    assert patient.port.state == "locked"
    after = [packet.throttle for packet in patient.packets_since(begin)]
    if number == signal.SIGUSR1:
        assert after.index(0) <= 2
        assert "vehicle 1 was cut: SIGUSR1 came" in out
    else:
        assert len([throttle for throttle in after if throttle]) > 15  # a landing, no fall
        assert "note: stopped; everyone landed" in err


def test_two_followers_of_a_file_and_one_camera_that_is_gone(
    tmp_path: Path, neighbor: ServedNeighbor, camera: MjpegServer, patient: PtyTransmitter, files: list[str]
) -> None:
    assert files
    with MjpegServer(neighbor) as other, PtyTransmitter(PACE) as second:
        pairs = ((camera.url, patient.path), (other.url, second.path))
        text = SHORT + "".join(FOLLOWER.format(camera=url, link=path) for url, path in pairs)
        (tmp_path / "two.toml").write_text(text)
        flown = Flown(tmp_path, "--config", "two.toml", "--arm")
        for each in (patient, second):
            flown.flies(each)
        other.stop()
        code, out, err = flown.ended()
        assert code == 3, out + err
        assert len(errors(err)) == 1
        assert f"{other.url} has delivered no picture" in errors(err)[0]
        for each in (patient, second):
            assert (each.port.throttle, each.port.state) == (0, "locked")
        assert "vehicle 2 came down along the safety path" in out


def test_a_port_that_vanishes_is_one_line(
    tmp_path: Path, camera: MjpegServer, patient: PtyTransmitter, line: list[str]
) -> None:
    flown = Flown(tmp_path, *line, "--arm")
    flown.flies(patient)
    patient.unplug()
    code, out, err = flown.ended()
    assert code == 3, out + err
    assert len(errors(err)) == 1
    assert "has gone (unplugged?)" in errors(err)[0]


def test_one_that_answers_garbage_is_one_line(
    tmp_path: Path, camera: MjpegServer, patient: PtyTransmitter, line: list[str]
) -> None:
    flown = Flown(tmp_path, *line, "--arm")
    flown.flies(patient)
    patient.babble = True
    code, out, err = flown.ended()
    assert code == 3, out + err
    assert len(errors(err)) == 1
    assert "has been silent" in errors(err)[0]
    assert patient.port.throttle == 0


def test_two_programs_do_not_share_a_port(
    tmp_path: Path, camera: MjpegServer, patient: PtyTransmitter, line: list[str]
) -> None:
    from matchset.links.arduino.arduino_link import ArduinoLink

    with ArduinoLink(patient.path):
        code, out, err = Flown(tmp_path, *line).ended()
    assert (code, out) == (3, "")
    assert errors(err) == [f"error: cannot open {patient.path}: another program uses it"]


def test_what_does_not_open_is_one_line(tmp_path: Path, camera: MjpegServer, files: list[str]) -> None:
    code, out, err = Flown(tmp_path, *devices(tmp_path, camera.url, "serial:///dev/ttyNONE"), *files).ended()
    assert (code, out, len(errors(err))) == (3, "", 1)
    assert "/dev/ttyNONE" in errors(err)[0]
    code, out, err = Flown(
        tmp_path, *devices(tmp_path, f"http://127.0.0.1:{camera.port}/", "serial:///dev/ttyNONE")
    ).ended()
    assert (code, out, len(errors(err))) == (2, "", 1)
    assert "matchset calibrate" in errors(err)[0]
