import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from matchset.app.drawing import codecs
from matchset.app.drawing.codecs import MPEG4, Codec
from matchset.app.drawing.opencv_encoder import set_frame_rate
from matchset.app.drawing.video_writer import Recorder

SIZE = 64, 48


@pytest.fixture
def without_pyav(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "av", None)


@pytest.fixture(params=["PyAV", "OpenCV"])
def either(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param == "OpenCV":
        monkeypatch.setitem(sys.modules, "av", None)
    else:
        pytest.importorskip("av")


def pictures(count: int) -> list[np.ndarray]:
    return [np.full((SIZE[1], SIZE[0], 3), 5 * index, np.uint8) for index in range(count)]


@pytest.mark.usefixtures("either")
@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
@pytest.mark.parametrize("fps", [23.976, 60.0])
def test_a_video_holds_every_picture_at_its_rate(tmp_path: Path, suffix: str, fps: float) -> None:
    path = tmp_path / f"out{suffix}"
    with Recorder(path, fps, SIZE) as out:
        for picture in pictures(20):
            out.write(picture)
    video = cv2.VideoCapture(str(path))
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(fps, rel=1e-3)
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == 20
    levels, stamps = [], []
    while (got := video.read())[0]:
        levels.append(float(got[1].mean()))
        stamps.append(video.get(cv2.CAP_PROP_POS_MSEC))
    assert levels == pytest.approx([5.0 * index for index in range(20)], abs=4.0)
    assert np.diff(stamps) == pytest.approx(1000.0 / fps, abs=1.1)


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
def test_odd_sizes_and_rates_are_packed(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"out{suffix}"
    for fps in (1.0, 29.97, 999.0):
        with Recorder(path, fps, (161, 121)) as out:
            for _ in range(5):
                out.write(np.full((121, 161, 3), 90, np.uint8))
        video = cv2.VideoCapture(str(path))
        assert sum(video.grab() for _ in range(9)) == 5


@pytest.mark.usefixtures("either")
def test_the_mp4_is_vp9(tmp_path: Path) -> None:
    with Recorder(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    assert b"vp09" in (tmp_path / "out.mp4").read_bytes()


@pytest.mark.usefixtures("without_pyav")
def test_without_pyav_the_user_learns_what_a_killed_program_would_cost(tmp_path: Path) -> None:
    with Recorder(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    assert "if the program is killed" in out.note
    assert "matchset[av]" in out.note
    assert ".webm" in out.note


@pytest.mark.usefixtures("without_pyav")
def test_without_vp9_it_falls_back_and_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(codecs.CODECS, ".mp4", (Codec("none", "none"), MPEG4))
    with Recorder(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    assert "browsers do not" in out.note
    monkeypatch.setitem(codecs.CODECS, ".mp4", (Codec("none", "none"),))
    with pytest.raises(ValueError, match="OpenCV cannot write"):
        Recorder(tmp_path / "new.mp4", 30.0, SIZE)
    assert not (tmp_path / "new.mp4").exists()


@pytest.mark.usefixtures("without_pyav")
def test_a_live_mp4_keeps_up(tmp_path: Path) -> None:
    with Recorder(tmp_path / "out.mp4", 30.0, SIZE, live=True) as out:
        out.write(pictures(1)[0])
    assert b"vp09" not in (tmp_path / "out.mp4").read_bytes()


def test_misuse_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must end in \.mp4, \.webm, \.avi"):
        Recorder(tmp_path / "out.mkv", 30.0, SIZE)
    with pytest.raises(ValueError, match="cannot write"):
        Recorder(tmp_path / "none" / "out.mp4", 30.0, SIZE)
    with (
        Recorder(tmp_path / "out.webm", 30.0, SIZE) as out,
        pytest.raises(ValueError, match="must have"),
    ):
        out.write(np.zeros((10, 10, 3), np.uint8))
    out.close()  # again does no harm


def test_only_ffmpegs_webm_is_changed(tmp_path: Path) -> None:
    path = tmp_path / "other.webm"
    for data in (b"", b"\x2a\xd7\xb1", b"\x2a\xd7\xb1\x83\x00\x00\x01"):
        path.write_bytes(data)
        with pytest.raises(ValueError, match=r"WebM|milliseconds"):
            set_frame_rate(path, 30.0)
        assert path.read_bytes() == data
