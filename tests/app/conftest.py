"""A small video of a blue ball, made once."""

from pathlib import Path

import cv2
import pytest
from blue_ball import CENTERS, SIZE, Matchset, ball_picture
from chain_flight import Flown, fly

from matchset.app import cli


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


@pytest.fixture(scope="session")
def flown() -> Flown:
    """A short flight of a chain of three."""
    return fly()
