import csv
from pathlib import Path

import cv2
import numpy as np
import pytest

from matchset.app.films.clip_export import write_clip
from matchset.sim.clips.clip import Clip

CLIP = Clip(frames=3, width=160, height=120, radii=(8.0, 30.0), hidden=((1, 2),))


@pytest.mark.parametrize("name", ["clip.avi", "clip.mkv"])
def test_a_video_is_lossless(tmp_path: Path, name: str) -> None:
    write_clip(CLIP, tmp_path / name)
    video = cv2.VideoCapture(str(tmp_path / name))
    for frame, _ in CLIP:
        read, image = video.read()
        assert read
        np.testing.assert_array_equal(image, frame.image)
    assert not video.read()[0]


def test_pictures_and_the_truth_table(tmp_path: Path) -> None:
    write_clip(CLIP, tmp_path / "shot")
    image = cv2.imread(str(tmp_path / "shot" / "000002.png"))
    pairs = list(CLIP)
    np.testing.assert_array_equal(image, pairs[2][0].image)
    with (tmp_path / "shot.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["video", "frame", "x", "y", "r", "visible", "method"]
    circle = pairs[0][1].circle
    assert circle is not None
    assert float(rows[0]["x"]) == pytest.approx(circle.x, abs=1e-4)
    assert rows[0]["method"] == "rendered"
    assert [row["visible"] for row in rows] == ["1", "0", "1"]
    assert (rows[1]["x"], rows[1]["r"]) == ("", "")


def test_mp4_and_misuse(tmp_path: Path) -> None:
    write_clip(CLIP, tmp_path / "clip.mp4", tmp_path / "truth.csv")
    assert cv2.VideoCapture(str(tmp_path / "clip.mp4")).get(cv2.CAP_PROP_FRAME_COUNT) == 3
    assert (tmp_path / "truth.csv").exists()
    with pytest.raises(ValueError, match="gif"):
        write_clip(CLIP, tmp_path / "clip.gif")
    (tmp_path / "full").mkdir()
    with pytest.raises(ValueError, match="exists"):
        write_clip(CLIP, tmp_path / "full")
