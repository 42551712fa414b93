"""What all kinds of video share; see also test_video_file.py, test_image_folder.py and test_camera_stream.py."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from matchset.media.video import Video

FRAMES = 6


@pytest.fixture(scope="module")
def avi(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("avi") / "clip.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25.0, (64, 48))
    for index in range(FRAMES):
        writer.write(np.full((48, 64, 3), 20 * index, np.uint8))
    writer.release()
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("folder")
    for index in range(FRAMES):
        cv2.imwrite(str(path / f"{index}.png"), np.full((48, 64), 20 * index, np.uint8))
    return path


def test_the_rate_can_be_given(avi: Path, folder: Path) -> None:
    for source in (avi, folder):
        with Video(source, fps=200.0) as video:
            times = [frame.time for frame in video]
        np.testing.assert_allclose(times, np.arange(len(times)) / 200.0)


def missing(folder: Path) -> Iterator[tuple[Path, str]]:
    yield folder / "nothing.mp4", "no such file"
    (folder / "empty.mp4").touch()
    yield folder / "empty.mp4", "the file is empty"
    (folder / "text.mp4").write_text("hello\n" * 1000)
    yield folder / "text.mp4", "not a video"
    (folder / "bad.png").write_text("hello\n")
    yield folder / "bad.png", "no picture of .* could be decoded"
    (folder / "none").mkdir()
    yield folder / "none", "no pictures .* in the folder"
    (folder / "all_bad").mkdir()
    (folder / "all_bad" / "1.png").write_text("hello\n")
    yield folder / "all_bad", "no picture of .* could be decoded"


def test_bad_sources_get_one_clear_line(tmp_path: Path) -> None:
    for source, words in missing(tmp_path):
        with pytest.raises(ValueError, match=words) as caught:
            Video(source)
        assert str(source) in str(caught.value)
        assert "\n" not in str(caught.value)


def test_a_file_that_may_not_be_read_is_refused(avi: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*args: object, **options: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(ValueError, match=r"cannot read .*clip\.avi: Permission denied"):
        Video(avi)


@pytest.mark.parametrize("source", [True, None, 1.5, "", b"clip.avi"])
def test_what_is_no_source_is_refused(source: str) -> None:
    with pytest.raises(ValueError, match="a video is a path, a camera number or a URL"):
        Video(source)


@pytest.mark.parametrize(
    ("name", "value"), [("fps", 0.0), ("fps", float("nan")), ("timeout", -1.0), ("exposure", float("inf"))]
)
def test_numbers_out_of_range_are_refused(avi: Path, name: str, value: float) -> None:
    options: dict[str, Any] = {name: value}
    with pytest.raises(ValueError, match=rf"{name} must be .*{value}"):
        Video(avi, **options)


def test_a_video_is_read_once_and_not_after_it_was_closed(avi: Path) -> None:
    video = Video(avi)
    assert len(video) == FRAMES
    first = next(video)
    assert (first.index, len(video)) == (0, FRAMES)
    assert [frame.index for frame in video] == list(range(1, FRAMES))
    assert list(video) == []
    video.close()
    video.close()
    with pytest.raises(ValueError, match="is closed"):
        next(video)
    with pytest.raises(ValueError, match="is closed"):
        iter(video)


def test_a_file_has_no_exposure_and_says_so(avi: Path) -> None:
    with Video(avi, exposure=20.0) as video:
        assert video.settings == {"exposure": (20.0, None)}
        assert video.warnings == ["exposure: asked for 20, but this source has no such setting"]
