from pathlib import Path

import cv2
import numpy as np
import pytest

from matchset.app.drawing import video_writer as recorder
from matchset.app.drawing.video_writer import MPEG4, Codec, Recorder, set_frame_rate

SIZE = 64, 48


def pictures(count: int) -> list[np.ndarray]:
    return [np.full((SIZE[1], SIZE[0], 3), 5 * index, np.uint8) for index in range(count)]


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
@pytest.mark.parametrize("fps", [23.976, 60.0])
def test_a_video_holds_every_picture_at_its_rate(tmp_path: Path, suffix: str, fps: float) -> None:
    path = tmp_path / f"out{suffix}"
    with Recorder(path, fps, SIZE) as out:
        for picture in pictures(20):
            out.write(picture)
    video = cv2.VideoCapture(str(path))
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(fps, rel=1e-3)
    levels, stamps = [], []
    while (got := video.read())[0]:
        levels.append(float(got[1].mean()))
        stamps.append(video.get(cv2.CAP_PROP_POS_MSEC))
    assert levels == pytest.approx([5.0 * index for index in range(20)], abs=4.0)
    assert np.diff(stamps) == pytest.approx(1000.0 / fps, abs=1.1)


def test_the_mp4_is_vp9(tmp_path: Path) -> None:
    with Recorder(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    assert b"vp09" in (tmp_path / "out.mp4").read_bytes()
    assert ".webm" in out.note


def test_without_vp9_it_falls_back_and_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(recorder.CODECS, ".mp4", (Codec("none", "none"), MPEG4))
    with Recorder(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    assert "browsers do not" in out.note
    monkeypatch.setitem(recorder.CODECS, ".mp4", (Codec("none", "none"),))
    with pytest.raises(ValueError, match="OpenCV cannot write"):
        Recorder(tmp_path / "new.mp4", 30.0, SIZE)
    assert not (tmp_path / "new.mp4").exists()


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
