"""Folders of pictures, and single ones."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from matchset.media.video import Video
from matchset.media.video_files.image_folder import natural

COUNT, WIDTH, HEIGHT = 12, 160, 120
Picture = npt.NDArray[np.uint8]


def picture(index: int) -> Picture:
    return np.full((HEIGHT, WIDTH, 3), (index, 0, 255 - index), np.uint8)


def index_of(image: Picture) -> int:
    return int(image[0, 0, 0])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for index in range(COUNT):
        cv2.imwrite(str(tmp_path / f"view{index}.png"), picture(index))
    (tmp_path / "notes.txt").write_text("not a picture")
    (tmp_path / ".view3.png").write_bytes(b"hidden")
    return tmp_path


def test_a_folder_is_read_in_natural_order(folder: Path) -> None:
    with Video(str(folder)) as video:
        assert (video.length, video.fps, video.live) == (COUNT, 30.0, False)
        frames = list(video)
    assert [index_of(frame.image) for frame in frames] == list(range(COUNT))
    np.testing.assert_allclose([frame.time for frame in frames], np.arange(COUNT) / 30)


def test_one_picture_is_a_video_of_one_frame(folder: Path) -> None:
    with Video(folder / "view7.png") as video:
        assert [index_of(frame.image) for frame in video] == [7]


def test_gray_pictures_stay_gray(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), picture(3)[..., 0])
    with Video(tmp_path) as video:
        assert video.channels == 1
        assert next(video).image.shape == (HEIGHT, WIDTH)


def test_broken_pictures_in_a_folder_are_skipped_and_counted(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (folder / "view0.png").write_bytes(b"")
    (folder / "view5.png").write_bytes(b"no picture at all" * 10)
    (folder / "view6.png").unlink()
    (folder / "view6.png").mkdir()
    with Video(folder) as video:
        assert [frame.index for frame in video] == [1, 2, 3, 4, 7, 8, 9, 10, 11]
    assert video.broken == 3
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("odd", "found"),
    [(picture(5)[:60], "160 x 60 in color"), (picture(5)[..., 0], "160 x 120 in gray")],
)
def test_pictures_that_change_are_refused(folder: Path, odd: Picture, found: str) -> None:
    cv2.imwrite(str(folder / "view5.png"), odd)
    with Video(folder) as video:
        for _ in range(5):
            next(video)
        with pytest.raises(ValueError, match=rf"frame 5 is {found}, those before it are 160 x 120 in color"):
            next(video)


def test_numbers_in_names_count_as_numbers() -> None:
    names = ["b1", "a10", "a9b", "a9", "A2", "3", "a007", "a7", "20", "a", "_1"]
    expected = ["3", "20", "_1", "a", "A2", "a007", "a7", "a9", "a9b", "a10", "b1"]
    assert sorted(names, key=natural) == expected
