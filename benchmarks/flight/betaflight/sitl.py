"""Betaflight's simulator target as a process in lock-step with a world: `Sitl`."""

import contextlib
import os
import select
import socket
import struct
import subprocess
import time
from pathlib import Path
from typing import Self

import numpy as np
import numpy.typing as npt

ROOT = Path(__file__).resolve().parents[3]
HOME = Path(os.environ.get("MATCHSET_BETAFLIGHT", ROOT / ".bench" / "betaflight"))
SETTINGS = Path(__file__).with_name("settings.txt")
RATE = 960  # Hz, of the packets with the vehicle's state
MOTORS, STATE, STICKS, SERIAL = 9002, 9003, 9004, 5760  # its ports, moved by an offset
PATIENCE = 30.0  # s of real time until it is believed to hang
BOOT = 8.0  # s of its time until it accepts sticks

Floats = npt.NDArray[np.float64]


def is_built() -> bool:
    """Whether `.ci/setup-betaflight` was run."""
    return (HOME / "betaflight").exists() and (HOME / "clock.so").exists()


class Sitl:
    """The program; its time passes only in `step`.

    Parameters
    ----------
    folder : Path
        Where it keeps its settings (``eeprom.bin``) and its log.

    Raises
    ------
    RuntimeError
        By every method, if it has ended or hangs.

    Attributes
    ----------
    time : float
        Since it was started, s.
    motors : list of 4 floats
        What it wants of front right, rear left, front left, rear right, 0 ... 1.
    """

    def __init__(self, folder: Path) -> None:
        self._ports, self._steps, self.motors = _free_ports(), 0, [0.0] * 4
        self._in = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._in.bind(("127.0.0.1", MOTORS + self._ports))
        self._in.setblocking(False)
        self._out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._report, theirs = os.pipe()
        environment = os.environ | {
            "LD_PRELOAD": str(HOME / "clock.so"),
            "BETAFLIGHT_REPORT": str(theirs),
            "BETAFLIGHT_PORTS": str(self._ports),
            "BETAFLIGHT_STEP": str(round(1e9 / RATE)),
        }
        self._log = (folder / "betaflight.log").open("ab")
        self._process = subprocess.Popen(
            [HOME / "betaflight"], cwd=folder, env=environment, pass_fds=(theirs,), stdout=self._log, stderr=self._log
        )
        os.close(theirs)
        self._serial: dict[int, socket.socket] = {}
        self._wait("M")

    @property
    def time(self) -> float:
        """Since it was started, s."""
        return self._steps / RATE

    def step(self, attitude: Floats, rates: Floats, acceleration: Floats) -> None:
        """Let 1/960 s pass.

        Parameters
        ----------
        attitude : (4,)
            Quaternion of the body, w first; axes forward, right, down, as of the room.
        rates : (3,)
            About the axes forward, right, down, rad/s.
        acceleration : (3,)
            What an accelerometer feels, forward, left, up, m/s^2.
        """
        self._out.sendto(
            struct.pack("<18d", 1.0, *rates, *-acceleration, *attitude, *([0.0] * 6), 101325.0),
            ("127.0.0.1", STATE + self._ports),
        )
        self._wait("M")
        self._steps += 1
        with contextlib.suppress(BlockingIOError):
            while len(data := self._in.recv(64)) == 16:
                self.motors = [min(max(each, 0.0), 1.0) for each in struct.unpack("<4f", data)]

    def rest(self, seconds: float) -> None:
        """Let time pass for a vehicle that lies still."""
        level, still, up = np.array((1.0, 0.0, 0.0, 0.0)), np.zeros(3), np.array((0.0, 0.0, 9.80665))
        for _ in range(round(seconds * RATE)):
            self.step(level, still, up)

    def sticks(self, channels: list[int]) -> None:
        """Send sixteen channels by UDP, microseconds, 1000 ... 2000."""
        self._out.sendto(struct.pack("<d16H", 1.0, *channels), ("127.0.0.1", STICKS + self._ports))
        self._wait("R")

    def write(self, port: int, data: bytes) -> None:
        """Send bytes to a serial port, from 1, and wait until they were read."""
        self._connect(port).sendall(data)
        self._wait("B", len(data))

    def read(self, port: int) -> bytes:
        """Return what a serial port has said; never waits."""
        found = bytearray()
        with contextlib.suppress(BlockingIOError):
            while data := self._connect(port).recv(4096, socket.MSG_DONTWAIT):
                found += data
        return bytes(found)

    def __enter__(self) -> Self:
        """Return it."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the program."""
        self._process.kill()
        self._process.wait()
        for each in (self._in, self._out, *self._serial.values()):
            each.close()
        os.close(self._report)
        self._log.close()

    def wait_for_end(self) -> None:
        """Wait until the program ends by itself."""
        self._process.wait(PATIENCE)

    def _connect(self, port: int) -> socket.socket:
        if port not in self._serial:
            self._serial[port] = socket.create_connection(("127.0.0.1", SERIAL + port + self._ports), PATIENCE)
            self._serial[port].setblocking(True)
            self._serial[port].setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return self._serial[port]

    def _wait(self, kind: str, count: int = 0) -> None:
        """Wait for a message of a kind, of bytes until so many were read."""
        while True:
            if not select.select([self._report], [], [], PATIENCE)[0]:
                raise RuntimeError(f"Betaflight does not answer ({kind})")
            message = os.read(self._report, 5)
            if len(message) < 5:
                raise RuntimeError(f"Betaflight has ended: {Path(self._log.name)}")
            if chr(message[0]) == kind:
                count -= int.from_bytes(message[1:], "little")
                if count <= 0:
                    return


def configure(folder: Path, lines: list[str]) -> str:
    """Type lines into its command line and save; returns what it answered.

    Raises
    ------
    RuntimeError
        If it did not understand a line.
    """
    said = ""

    def answer(sitl: Sitl, data: str, end: str) -> str:
        sitl.write(1, data.encode())
        found, limit = "", time.monotonic() + PATIENCE
        while not found.endswith(end):
            sitl.rest(0.01)
            found += sitl.read(1).decode("latin-1")
            if time.monotonic() > limit:
                raise RuntimeError(f"Betaflight's command line hangs after {data!r}: {found!r}")
        return found

    with Sitl(folder) as sitl:
        sitl.rest(BOOT)
        answer(sitl, "#", "# ")  # and silence: a line end would cancel it
        for line in lines:
            heard = answer(sitl, line + "\n", "# ")
            said += heard
            if "error" in heard.lower() or "invalid" in heard.lower() or "unknown" in heard.lower():
                raise RuntimeError(f"Betaflight does not understand {line!r}: {heard}")
        sitl.write(1, b"save\n")
        with contextlib.suppress(RuntimeError, ConnectionError):
            sitl.rest(5.0)
        sitl.wait_for_end()
    return said


def settings() -> list[str]:
    """Return the lines of ``settings.txt`` without its comments."""
    lines = SETTINGS.read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def _free_ports() -> int:
    """Find an offset at which all its ports are free."""
    for offset in range(1000 + os.getpid() % 500 * 20, 50_000, 20):
        with contextlib.ExitStack() as stack:
            try:
                for port in (MOTORS - 1, MOTORS, STATE, STICKS):
                    one = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                    one.bind(("127.0.0.1", port + offset))
                for port in range(1, 9):
                    one = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_STREAM))
                    one.bind(("127.0.0.1", SERIAL + port + offset))
            except OSError:
                continue
            return offset
    raise RuntimeError("no free ports for Betaflight")
