"""What flights of real devices need: a neighbor that a camera in the network sees, a transmitter, files of settings."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from pty_transmitter import PtyTransmitter

from flight_process import PACE
from mjpeg_server import MjpegServer
from served_neighbor import ServedNeighbor


@pytest.fixture(scope="module")
def neighbor() -> ServedNeighbor:
    return ServedNeighbor()


@pytest.fixture
def camera(neighbor: ServedNeighbor) -> Iterator[MjpegServer]:
    """The neighbor, seen by a camera in the network."""
    with MjpegServer(neighbor) as server:
        yield server


@pytest.fixture
def transmitter() -> Iterator[PtyTransmitter]:
    with PtyTransmitter(PACE) as opened:
        yield opened


@pytest.fixture
def files(neighbor: ServedNeighbor, tmp_path: Path) -> list[str]:
    """Options of a flight that name camera file and colors."""
    return neighbor.write_files(tmp_path)
