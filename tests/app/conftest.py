"""A small video of a blue ball, a short flight, and what flights of real devices need, each made once."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from blue_ball import CENTERS, SIZE, Matchset, ball_picture
from chain_flight import Flown, fly
from flight_process import PACE
from pty_transmitter import PtyTransmitter

from matchset.app import cli
from matchset.app.locate import path_picture
from mjpeg_server import MjpegServer
from served_neighbor import ServedNeighbor


@pytest.fixture(scope="session")
def ball_video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ball") / "my ball.mp4"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, SIZE)
    for center in CENTERS:
        writer.write(ball_picture(center))
    writer.release()
    return path


@pytest.fixture
def matchset(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Matchset:
    """Run the command line in an empty folder; returns the exit code."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> int:
        monkeypatch.setattr("sys.argv", ["matchset", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        code = ended.value.code
        assert isinstance(code, int)
        return code

    return run


@pytest.fixture
def no_path_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave `poses.png` black, of which the tests in `locate/test_path_picture.py` are: drawing it takes a while."""
    monkeypatch.setattr(path_picture, "path_picture", lambda *_: np.zeros((8, 8, 3), np.uint8))


@pytest.fixture(scope="session")
def flown() -> Flown:
    """A short flight of a chain of three."""
    return fly()


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
