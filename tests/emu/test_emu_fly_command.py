"""`matchset fly --camera --link` as typed: pictures in, and the sticks that the emulated firmware puts on the air."""

import contextlib
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from cable import Cable, Paced
from emulator import Board
from nrf24 import Packet
from syma import BIND_ADDRESS, sticks

import patient_matchset
from flight import BOUND, throttles
from mjpeg_server import MjpegServer
from served_neighbor import SETTINGS, ServedNeighbor

PACE = 0.25  # of the board's clock: its failsafe has tests of its own, and this computer may be busy
SHORT = f"""
[flight]
duration = 3.0
[flight.linked]
countdown = 0.5
{SETTINGS}"""


@contextlib.contextmanager
def devices() -> Iterator[tuple[Board, Cable, MjpegServer, ServedNeighbor]]:
    neighbor = ServedNeighbor()
    with Board() as board:
        board.run(BOUND)
        cable = Cable(board)
        with MjpegServer(neighbor) as camera, Paced(cable, PACE):
            yield board, cable, camera, neighbor
        cable.pull()


def flown(folder: Path, *words: str) -> tuple[int, str, str, list[Packet]]:
    """Run the command to its end; returns exit code, what it said, and what went on the air."""
    (folder / "short.toml").write_text(SHORT)
    with devices() as (board, cable, camera, neighbor):
        line = ["fly", "--camera", camera.url, "--link", f"serial://{cable.path}", *neighbor.write_files(folder)]
        line += ["--config", "short.toml", *words]
        done = subprocess.run(
            [sys.executable, patient_matchset.__file__, *line],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=500,
            check=False,
        )
        before = board.time
        while board.time < before + 0.3:  # what it does when nobody speaks to it any more
            time.sleep(0.01)
        packets = [packet for packet in board.packets if packet.address != BIND_ADDRESS]
    assert "Traceback" not in done.stderr, done.stderr
    return done.returncode, done.stdout, done.stderr, packets


def test_pictures_become_sticks_on_the_air_and_it_lands(tmp_path: Path) -> None:
    files = ("--record", "flight.mcap", "--report", "flight.html", "--video", "flight.avi")
    code, out, err, packets = flown(tmp_path, "--arm", *files)
    assert code == 0, out + err
    throttle = throttles(packets)
    assert max(throttle) > 100
    assert throttle[0] == throttle[-1] == 0
    moved = [each for packet in packets if (each := sticks(packet.payload)) is not None]
    assert any(each.roll for each in moved)
    assert any(each.pitch for each in moved)
    assert "THE MOTORS TURN in 0.5 s" in err
    assert all((tmp_path / name).stat().st_size > 1000 for name in files[1::2])
