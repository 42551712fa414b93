"""`Video(fields=)`: files, folders and cameras hand out half-frames; the pictures say what they are."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from cameras import PATIENCE, Camera
from interlaced_videos import Pictures, ball_clip, frames_of, pictures_of, upside_down
from matchset.media.fields.field_reader import STILL, FieldReader
from matchset.media.video import Video
from matchset.sim.analog_link import CLEAN
from shown_clips import need_av


def folder_of(pictures: Pictures, folder: Path) -> Path:
    folder.mkdir()
    for index, picture in enumerate(pictures):
        cv2.imwrite(str(folder / f"{index}.png"), picture)
    return folder


@pytest.fixture(scope="module")
def interlaced(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return folder_of(pictures_of(ball_clip()), tmp_path_factory.mktemp("fields") / "top")


def test_frames_are_as_they_were(interlaced: Path) -> None:
    pictures = pictures_of(ball_clip())
    with Video(interlaced) as video:
        assert (video.fields, video.fps, video.length, video.warnings) == ("frames", 30.0, len(pictures), [])
        for frame, picture in zip(video, pictures, strict=True):
            assert frame.rows == "all"
            np.testing.assert_array_equal(frame.image, picture)


@pytest.mark.parametrize("fields", ["top", "bottom"])
def test_each_field_is_a_frame_of_its_own_time(interlaced: Path, fields: Any) -> None:
    pictures = pictures_of(ball_clip())
    with Video(interlaced, fields=fields) as video:
        assert (video.fields, video.fps, video.length) == (fields, 60.0, 2 * len(pictures))
        found = list(video)
    assert [frame.rows for frame in found[:2]] == (["top", "bottom"] if fields == "top" else ["bottom", "top"])
    assert [frame.index for frame in found] == list(range(2 * len(pictures)))
    assert [frame.time for frame in found] == pytest.approx([(k - 0.5) / 60.0 for k in range(len(found))])
    for k, frame in enumerate(found):
        new = 0 if frame.rows == "top" else 1
        np.testing.assert_array_equal(frame.image[new::2], pictures[k // 2][new::2])


def test_the_pictures_say_which_field_is_first_and_that_is_said_once(interlaced: Path, tmp_path: Path) -> None:
    with Video(interlaced, fields="auto") as video:
        assert (video.fields, len(list(video))) == ("top", 24)
        assert video.warnings == ["fields: the pictures are interlaced, the top field first"]
        again = video.again()
    assert (again.fields, again.warnings, len(list(again))) == ("top", [], 24)
    other = folder_of(upside_down(pictures_of(ball_clip())), tmp_path / "bottom")
    with Video(other, fields="auto") as video:
        assert video.fields == "bottom"


def test_progressive_and_still_pictures_come_whole(tmp_path: Path) -> None:
    progressive = folder_of(pictures_of(ball_clip(CLEAN)), tmp_path / "progressive")
    with Video(progressive, fields="auto") as video:
        assert (video.fields, video.fps, len(list(video))) == ("frames", 30.0, 12)
        assert video.warnings == ["fields: the pictures are not interlaced"]
    still = folder_of(pictures_of(ball_clip())[:1] * 8, tmp_path / "still")
    with Video(still, fields="auto") as video:
        assert (video.fields, {frame.rows for frame in video}, video.warnings) == ("frames", {"all"}, [STILL])


def test_a_wrong_order_is_obeyed_and_said_once(interlaced: Path) -> None:
    with Video(interlaced, fields="bottom") as video:
        assert len(list(video)) == 24
        (words,) = video.warnings
    assert words == (
        "fields: the pictures are interlaced, the top field first; "
        "they are read as interlaced, the bottom field first, as was asked for"
    )


def test_a_missing_field_is_left_out_and_said(tmp_path: Path) -> None:
    pictures = [picture.copy() for picture in pictures_of(ball_clip(frames=30))]
    pictures[5][1::2] = pictures[4][1::2]
    pictures[8][0::2] = 0
    folder = folder_of(tuple(pictures), tmp_path / "missing")
    with Video(folder, fields="auto") as video:
        found = list(video)
        assert [frame.index for frame in found] == [k for k in range(60) if k not in (11, 16)]
        assert "2 fields missing in interlaced frames, left out" in video.warnings


def test_an_order_that_changes_where_a_field_was_lost_is_followed(tmp_path: Path) -> None:
    pictures, lost = pictures_of(ball_clip(frames=40)), 16
    shifted = [picture.copy() for picture in pictures[:-1]]
    for k in range(lost, len(shifted)):
        shifted[k][0::2] = pictures[k + 1][0::2]  # even rows of the next one: the odd ones are the first
    with Video(folder_of(tuple(shifted), tmp_path / "lost"), fields="auto") as video:
        found = list(video)
        (first, second) = video.warnings
    assert first == "fields: the pictures are interlaced, the top field first"
    changed = int(second.partition("from frame ")[2].partition(" ")[0])
    assert second.endswith("on the bottom field comes first")
    assert lost < changed < lost + 16
    rows = [frame.rows for frame in found]
    assert rows[: 2 * changed] == ["top", "bottom"] * changed
    assert rows[2 * changed :] == ["bottom", "top"] * (len(shifted) - changed)
    assert (np.diff([frame.time for frame in found]) > 0.0).all()


def test_a_camera_upside_down_swaps_the_fields(interlaced: Path) -> None:
    pictures = pictures_of(ball_clip())
    for fields in ("top", "auto"):
        with Video(interlaced, fields=fields, turn=180) as video:
            frame = next(video)
            assert (video.fields, frame.rows) == ("top", "bottom")
        np.testing.assert_array_equal(frame.image[1::2], pictures[0][::-1, ::-1][1::2])


def test_rows_that_become_columns_have_no_fields(interlaced: Path) -> None:
    with pytest.raises(ValueError, match="fields lie in the rows of a picture, and these pictures are turned"):
        Video(interlaced, fields="top", turn=90)
    with Video(interlaced, fields="auto", turn=90) as video:
        assert (video.fields, next(video).rows) == ("frames", "all")
        assert video.warnings == ["fields: these pictures are turned by a quarter, so whole frames are used"]


@pytest.mark.parametrize("wrong", ["odd", "", None, 1])
def test_other_fields_are_refused(interlaced: Path, wrong: Any) -> None:
    with pytest.raises(ValueError, match=r"fields must be one of frames, top, bottom, auto, got"):
        Video(interlaced, fields=wrong)


def write(path: Path, pictures: Pictures, order: int, options: dict[str, str]) -> Path:
    av = need_av()
    height, width = pictures[0].shape[:2]
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=30, options={"crf": "12"} | options)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.codec_context.field_order = order
        for picture in pictures:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")))
        container.mux(stream.encode())
    return path


@pytest.mark.parametrize("name", ["top.mp4", "top.mkv"])
def test_the_pictures_win_over_the_header_of_a_file(tmp_path: Path, name: str) -> None:
    path = write(tmp_path / name, upside_down(pictures_of(ball_clip())), 2, {"x264-params": "tff=1"})
    with Video(path, fields="auto") as video:
        found = list(video)
        assert (video.fields, len(found), found[0].rows) == ("bottom", 24, "bottom")
        words = [each for each in video.warnings if each.startswith("fields")]
    assert words == [
        "fields: the pictures are interlaced, the bottom field first; "
        "the header says interlaced, the top field first, the pictures count"
    ]


def test_a_file_that_is_marked_as_interlaced_has_its_pictures(tmp_path: Path) -> None:
    pictures = pictures_of(ball_clip())
    path = write(tmp_path / "marked.mp4", pictures, 2, {"x264-params": "tff=1"})
    with Video(path) as video:
        for frame, picture in zip(video, pictures, strict=True):
            assert np.abs(frame.image.astype(float) - picture).mean() < 12.0  # OpenCV 5 has nothing there


def live(camera: Camera, monkeypatch: pytest.MonkeyPatch, **how: Any) -> Video:
    monkeypatch.setattr("matchset.media.camera_stream.open_capture", lambda *_: camera)
    return Video(0, timeout=PATIENCE, **how)


def test_of_a_camera_that_waits_only_the_newest_field_is_handed_out(monkeypatch: pytest.MonkeyPatch) -> None:
    camera, pictures = Camera(), pictures_of(ball_clip())
    camera._pictures.append(pictures[0])
    with live(camera, monkeypatch, fields="top") as video:
        first = next(video)  # it waited while the video was opened
        assert (first.index, first.rows, video.dropped) == (1, "bottom", 1)
        assert video.fps == 60.0
        camera.unplug()


def test_no_stale_field_is_handed_out() -> None:
    frames = iter(frames_of(pictures_of(ball_clip())))
    reader = FieldReader("top", 30.0)
    taken = [reader.take(lambda: next(frames), waits) for waits in (False, False, False, True, True, False, False)]
    assert [half.index for half in taken if half is not None] == [0, 1, 2, 5, 7, 8, 9]
    assert reader.left_out == 3


def test_of_a_live_source_frames_are_whole_until_the_pictures_tell() -> None:
    pictures = pictures_of(ball_clip())
    frames = iter(frames_of((pictures[0],) * 4 + pictures))
    reader = FieldReader(None, 30.0)
    found = [reader.take(lambda: next(frames, None)) for _ in range(26)]
    rows = [half.rows for half in found if half is not None]
    begin = rows.index("top")
    assert set(rows[:begin]) == {"all"}
    assert rows[begin : begin + 4] == ["top", "bottom", "top", "bottom"]
    indices = [half.index for half in found if half is not None]
    assert indices == list(range(len(indices)))
    assert (np.diff([half.time for half in found if half is not None]) > 0.0).all()
    assert reader.warnings == ["fields: the pictures are interlaced, the top field first"]


def test_where_stamps_are_those_of_arrival_no_field_is_of_the_future() -> None:
    frames = iter(frames_of(pictures_of(ball_clip())))
    reader = FieldReader("top", 30.0, lambda: True)
    found = [reader.take(lambda: next(frames)) for _ in range(4)]
    assert [half.time for half in found if half is not None] == pytest.approx([-1 / 60, 0.0, 1 / 60, 2 / 60])
