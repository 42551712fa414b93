"""A command that flies something real, as a process, and what it is told so that a test is short."""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from pty_transmitter import PtyTransmitter

import patient_matchset
from served_neighbor import SETTINGS

PACE = 0.25  # of the transmitter's clock: its failsafe has tests of its own, on a computer that does nothing else
FLIES = 60  # of 255, what no other test's throttle reaches
SHORT = f"""
[flight]
duration = 30.0
[flight.linked]
countdown = 0.5
{SETTINGS}"""


def devices(folder: Path, camera: str, link: str) -> list[str]:
    """Options that name them, and a file of settings."""
    (folder / "short.toml").write_text(SHORT)
    return ["--camera", camera, "--link", link, "--config", str(folder / "short.toml")]


class FlightProcess:
    """A command that flies something real, as a process."""

    def __init__(self, folder: Path, *words: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, patient_matchset.__file__, *words],
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
