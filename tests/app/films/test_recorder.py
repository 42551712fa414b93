import os
import shutil
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from matchset.app.disk import UnfinishedFileError
from matchset.app.films import codecs
from matchset.app.films.codecs import FilmCodec
from matchset.app.films.opencv_encoder import set_frame_rate
from matchset.app.films.video_writer import FilmWriter, FilmWriterParameters

SIZE = 64, 48


@pytest.fixture
def without_pyav(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    monkeypatch.setenv("PATH", "")  # no ffmpeg either


@pytest.fixture(params=["PyAV", "ffmpeg", "OpenCV"])
def either(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param == "PyAV":
        pytest.importorskip("av")
        return
    monkeypatch.setitem(sys.modules, "av", None)
    if request.param == "OpenCV":
        monkeypatch.setenv("PATH", "")
    elif shutil.which("ffmpeg") is None:
        pytest.skip("there is no program ffmpeg")


def pictures(count: int) -> list[np.ndarray]:
    return [np.full((SIZE[1], SIZE[0], 3), 5 * index, np.uint8) for index in range(count)]


@pytest.mark.usefixtures("either")
@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
@pytest.mark.parametrize("fps", [23.976, 60.0])
def test_a_video_holds_every_picture_at_its_rate(tmp_path: Path, suffix: str, fps: float) -> None:
    path = tmp_path / f"out{suffix}"
    with FilmWriter(path, fps, SIZE) as out:
        for picture in pictures(20):
            out.write(picture)
    video = cv2.VideoCapture(str(path))
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(fps, rel=1e-3)
    levels, stamps = [], []
    while (got := video.read())[0]:
        levels.append(float(got[1].mean()))
        stamps.append(video.get(cv2.CAP_PROP_POS_MSEC))
    assert len(levels) == 20
    assert levels == pytest.approx([5.0 * index for index in range(20)], abs=4.0)
    assert np.diff(stamps) == pytest.approx(1000.0 / fps, abs=1.1)


@pytest.mark.usefixtures("either")
@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
def test_odd_sizes_and_rates_are_packed(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"out{suffix}"
    for fps in (1.0, 29.97, 999.0):
        with FilmWriter(path, fps, (161, 121)) as out:
            for _ in range(5):
                out.write(np.full((121, 161, 3), 90, np.uint8))
        video = cv2.VideoCapture(str(path))
        assert sum(video.grab() for _ in range(9)) == 5


@pytest.mark.usefixtures("either")
def test_the_mp4_is_h264_where_pyav_or_ffmpeg_is(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    with FilmWriter(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    content = (tmp_path / "out.mp4").read_bytes()
    by_opencv = "OpenCV" in request.node.name
    assert (b"avc1" in content, b"mp4v" in content) == (not by_opencv, by_opencv)
    assert bool(out.note) == by_opencv


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
@pytest.mark.usefixtures("either")
def test_no_film_takes_a_tenth_of_a_second_a_picture(tmp_path: Path, suffix: str) -> None:
    """OpenCV's VP9 took 0.8 s a picture of 640 x 480; noise, which nothing packs well, gets 0.1 s."""
    noise = [np.random.default_rng(k).integers(80, 170, (480, 640, 3), np.uint8) for k in range(4)]
    begin = os.times()
    with FilmWriter(tmp_path / f"out{suffix}", 30.0, (640, 480)) as out:
        for k in range(40):
            out.write(noise[k % 4])
    end = os.times()
    took = sum(end[:4]) - sum(begin[:4])  # of this process and of those that it started
    assert took < 40 * 0.1


@pytest.mark.usefixtures("either")
@pytest.mark.parametrize("suffix", [".mp4", ".webm"])
def test_a_small_film_of_noise_takes_less_than_a_megabyte_a_second(tmp_path: Path, suffix: str) -> None:
    """The noise of a bad link is what takes the room: 640 x 480, 25 gray levels, new in every picture."""
    rows = np.arange(480)[:, None, None]
    sizes = {}
    for small in (False, True):
        random = np.random.default_rng(0)
        with FilmWriter(
            tmp_path / f"{small}{suffix}", 30.0, (640, 480), parameters=FilmWriterParameters(small=small)
        ) as out:
            for k in range(30):
                noise = cv2.GaussianBlur(random.normal(0.0, 40.0, (480, 640, 3)), (5, 1), 1.0)
                out.write(np.asarray((90 + 60 * np.sin(rows / 90.0 + k / 20.0) + noise).clip(0, 255), np.uint8))
        sizes[small] = (tmp_path / f"{small}{suffix}").stat().st_size
        video = cv2.VideoCapture(str(tmp_path / f"{small}{suffix}"))
        assert sum(video.grab() for _ in range(40)) == 30
    assert sizes[True] < 1e6 < sizes[False]


def test_a_program_without_h264_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    program = tmp_path / "ffmpeg"
    program.write_text("#!/bin/sh\necho ' V....D mpeg4  MPEG-4 part 2'\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with FilmWriter(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    assert b"mp4v" in (tmp_path / "out.mp4").read_bytes()


def test_what_ffmpeg_says_when_it_fails_is_in_the_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    program = tmp_path / "ffmpeg"
    program.write_text(
        "#!/bin/sh\nfor word; do [ \"$word\" = -encoders ] && echo ' V..... libx264 H.264' && exit 0; done\n"
        "echo 'out.mp4: something is wrong' >&2\nexit 1\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    out = FilmWriter(tmp_path / "out.mp4", 30.0, SIZE)
    out.write(pictures(1)[0])
    with pytest.raises(UnfinishedFileError, match=r"ffmpeg: out.mp4: something is wrong; it holds 0 of 1 pictures"):
        out.close()


@pytest.mark.usefixtures("without_pyav")
def test_without_h264_the_user_learns_it_and_what_a_killed_program_would_cost(tmp_path: Path) -> None:
    with FilmWriter(tmp_path / "out.mp4", 30.0, SIZE) as out:
        out.write(pictures(1)[0])
    assert "browsers do not" in out.note
    assert "if the program is killed" in out.note
    assert "pip install 'av" in out.note
    assert ".webm" in out.note


@pytest.mark.usefixtures("without_pyav")
def test_without_any_codec_it_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(codecs.CODECS, ".mp4", (FilmCodec("none", "none"),))
    with pytest.raises(ValueError, match="OpenCV cannot write"):
        FilmWriter(tmp_path / "new.mp4", 30.0, SIZE)
    assert not (tmp_path / "new.mp4").exists()


def test_misuse_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must end in \.mp4, \.webm, \.avi"):
        FilmWriter(tmp_path / "out.mkv", 30.0, SIZE)
    with pytest.raises(ValueError, match="cannot write"):
        FilmWriter(tmp_path / "none" / "out.mp4", 30.0, SIZE)
    with (
        FilmWriter(tmp_path / "out.webm", 30.0, SIZE) as out,
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
