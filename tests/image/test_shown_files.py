"""Video files as they are to be looked at: square pixels, the right way up, the right stream, what is damaged."""

import itertools
import math
import struct
from fractions import Fraction
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.pose import Pose
from matchset.media.upright.orientation import ALL
from matchset.media.video import Video
from matchset.media.video_files import stream_choice
from matchset.shapes.circle import Circle
from matchset.tracking.detection import detect
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker
from matroska_clips import write_posed
from shown_clips import Picture, ball_picture, middle_of, need_av, with_matrix, with_ratio, write_clip

RADIUS = 40.0
PAL, HDV, NTSC, DVD = Fraction(64, 45), Fraction(4, 3), Fraction(10, 11), Fraction(8, 9)
FORMATS = {
    PAL: ((720, 576), (1024, 576)),
    HDV: ((480, 360), (640, 360)),
    NTSC: ((720, 480), (655, 480)),
    DVD: ((720, 480), (640, 480)),
}
EIGHT = [(each.a, each.b, each.c, each.d) for each in sorted(ALL)]


def anamorphic(ratio: Fraction, count: int = 6) -> list[Picture]:
    """A ball that moves to the right and down, as it is stored."""
    size, _ = FORMATS[ratio]
    path = [(size[0] * (0.3 + 0.02 * k), size[1] * (0.4 + 0.01 * k), RADIUS) for k in range(count)]
    return [ball_picture(size, circle, float(ratio)) for circle in path]


@pytest.mark.parametrize(
    ("name", "codec", "ratio"),
    [
        ("clip.mp4", "libx264", PAL),
        ("clip.mp4", "libx264", HDV),
        ("clip.mov", "mpeg4", NTSC),
        ("clip.mkv", "libx264", NTSC),
        ("clip.avi", "mpeg4", PAL),
        ("clip.vob", "mpeg2video", PAL),
        ("clip.vob", "mpeg2video", DVD),  # MPEG-2 says the shape of the whole picture: 4:3
        ("clip.h264", "libx264", PAL),
        ("clip.h264", "libx264", NTSC),
        ("clip.m4v", "mpeg4", HDV),
        ("clip.m4v", "mpeg4", NTSC),
    ],
)
def test_pictures_come_square(tmp_path: Path, name: str, codec: str, ratio: Fraction) -> None:
    options = {"crf": "16"} if codec == "libx264" else {}
    (width, height), shown = FORMATS[ratio]
    path = write_clip(tmp_path / name, [anamorphic(ratio)], codec, ratio, options=options)
    with Video(path) as video:
        assert (video.width, video.height) == shown
        assert video.pixel_aspect == 1.0
        (note,) = [each for each in video.warnings if "pixels" in each]
        frames = list(video)
    assert note == (
        f"pixels are not square, {ratio.numerator}:{ratio.denominator}: pictures of {width} x {height} px are made "
        f"{shown[0]} x {shown[1]} px"
    )
    assert len(frames) == 6
    for k, frame in enumerate(frames):
        x, y, radius = middle_of(frame.image)
        expected = (width * (0.3 + 0.02 * k) + 0.5) * shown[0] / width - 0.5, height * (0.4 + 0.01 * k)
        assert (x, y) == pytest.approx(expected, abs=1.0)
        assert radius == pytest.approx(RADIUS, rel=0.01)


@pytest.mark.parametrize("ratio", [PAL, HDV, NTSC])
def test_the_distance_is_right_with_the_field_of_view_of_the_lens(tmp_path: Path, ratio: Fraction) -> None:
    stored, (width, height) = FORMATS[ratio]
    near_the_axis = [(0.5 * stored[0] - 8.0 + 3 * k, 0.5 * stored[1] + 2.0 * k, RADIUS) for k in range(6)]
    pictures = [ball_picture(stored, circle, float(ratio)) for circle in near_the_axis]
    path = write_clip(tmp_path / "clip.mp4", [pictures], ratio=ratio, options={"crf": "12"})
    focal = 1.2 * width
    camera = CameraModel.from_fov(width, height, 2.0 * math.atan(0.5 * width / focal))
    localizer, tracker, poses = Localizer(camera, BallTarget(0.2)), None, []
    with Video(path) as video:
        for frame in video:
            x, y, _ = middle_of(frame.image)
            if tracker is None:
                tracker = Tracker(Circle, ColorModel.pick(frame.image, x, y), start=(x, y))
            track = tracker.update(frame)
            assert isinstance(track, Track)
            assert track.shape.radius == pytest.approx(RADIUS, rel=0.01)
            poses.append(localizer.update(track))
    distance = 0.1 * math.sqrt(1.0 + (focal / RADIUS) ** 2)
    for pose in poses:
        assert isinstance(pose, Pose)
        assert math.hypot(*pose.position) == pytest.approx(distance, rel=0.01)


def test_stored_pixels_on_demand(tmp_path: Path) -> None:
    path = write_clip(tmp_path / "clip.mp4", [anamorphic(HDV)], ratio=HDV)
    with Video(path, square=False) as video:
        assert (video.width, video.height) == (480, 360)
        assert video.pixel_aspect == pytest.approx(4 / 3)
        assert video.warnings == ["pixels are not square, 4:3, and handed out as they are stored: circles are ellipses"]
    with Video(path, square=False, turn=90) as video:
        assert (video.width, video.height) == (360, 480)
        assert video.pixel_aspect == pytest.approx(3 / 4)


def test_what_is_tracked_in_stored_pixels_is_not_located(tmp_path: Path) -> None:
    path = write_clip(tmp_path / "clip.mp4", [anamorphic(HDV)], ratio=HDV)
    for square, aspect in ((False, 4 / 3), (True, 1.0)):
        with Video(path, square=square) as video:
            frame = next(video)
            localizer = Localizer(CameraModel.from_fov(video.width, video.height, 1.0), BallTarget(diameter=0.2))
        assert frame.pixel_aspect == pytest.approx(aspect)
        x, y, _ = middle_of(frame.image)
        color = ColorModel.pick(frame.image, x, y)
        tracker = Tracker(Circle, color, start=(x, y))
        for track in (tracker.update(frame), detect(frame, Circle, color)[0]):
            assert isinstance(track, Track)
            assert track.pixel_aspect == frame.pixel_aspect
            if square:
                assert isinstance(localizer.update(track), Pose)
                continue
            with pytest.raises(ValueError, match=r"pixels are 1\.333 times as wide .* leave out square=False"):
                localizer.update(track)


@pytest.mark.parametrize("ratio", [(0, 1), (1, 0), (10_000, 1), (1, 10_000)])
def test_a_header_that_lies_is_ignored_and_told(tmp_path: Path, ratio: tuple[int, int]) -> None:
    path = write_clip(tmp_path / "clip.mp4", [anamorphic(HDV)], "mpeg4", HDV)
    plain = write_clip(tmp_path / "plain.mp4", [anamorphic(HDV)], "mpeg4")
    with Video(with_ratio(path, *ratio)) as video:
        size, notes = (video.width, video.height), video.warnings
    assert any("are not credible: ignored" in note for note in notes), notes
    with Video(plain) as video:
        if ratio[0] and ratio[1]:  # 0: the codec's own header counts, which says 4:3
            assert size == (video.width, video.height)


def lossless(path: Path) -> tuple[Path, list[Picture]]:
    """Write a clip without a symmetry, and return its pictures as they are decoded."""
    random = np.random.default_rng(3)
    small = [random.integers(0, 256, (6, 9, 3)).astype(np.uint8) for _ in range(3)]
    pictures = [np.asarray(cv2.resize(each, (144, 96)), np.uint8) for each in small]
    write_clip(path, [pictures], "libx264rgb", pixels="rgb24", options={"qp": "0"})
    return path, pictures


def as_ffmpeg_shows(picture: Picture, matrix: tuple[int, int, int, int]) -> Picture:
    """Put a picture through the filters that the program ffmpeg inserts for a matrix (fftools/ffmpeg_filter.c)."""
    av = need_av()
    a, b, c, d = matrix
    angle = round(math.degrees(math.atan2(b, a))) % 360
    filters: list[tuple[str, str]] = []
    if angle == 90:
        filters = [("transpose", "cclock_flip" if c > 0 else "clock")]
    elif angle == 180:
        filters = [("hflip", "")] * (a < 0) + [("vflip", "")] * (d < 0)
    elif angle == 270:
        filters = [("transpose", "clock_flip" if c < 0 else "cclock")]
    elif d < 0:
        filters = [("vflip", "")]
    graph = av.filter.Graph()
    height, width = picture.shape[:2]
    nodes = [graph.add_buffer(width=width, height=height, format="bgr24", time_base=Fraction(1, 25))]
    nodes += [graph.add(name, arguments) if arguments else graph.add(name) for name, arguments in filters]
    nodes.append(graph.add("buffersink"))
    graph.link_nodes(*nodes).configure()
    frame = av.VideoFrame.from_ndarray(picture, format="bgr24")
    frame.pts, frame.time_base = 0, Fraction(1, 25)
    graph.push(frame)
    shown: Any = graph.pull()
    return np.asarray(shown.to_ndarray(format="bgr24"), np.uint8)


@pytest.mark.parametrize("matrix", EIGHT)
@pytest.mark.parametrize("by_pyav", [False, True])
def test_eight_display_matrices_pixel_for_pixel(
    tmp_path: Path, matrix: tuple[int, int, int, int], by_pyav: bool
) -> None:
    path, _ = lossless(tmp_path / "clip.mp4")
    with Video(path, damaged=True if by_pyav else None) as video:
        stored = [frame.image for frame in video]
    with Video(with_matrix(path, matrix), damaged=True if by_pyav else None) as video:
        frames = list(video)
        assert video.warnings == []
        assert (video.height, video.width) == frames[0].image.shape[:2]
    assert len(frames) == len(stored) == 3
    for frame, before in zip(frames, stored, strict=True):
        np.testing.assert_array_equal(frame.image, as_ffmpeg_shows(before, matrix))


@pytest.mark.parametrize("roll", [0.0, 90.0, 180.0, -90.0])
@pytest.mark.parametrize("yaw", [0.0, 180.0])
def test_eight_poses_of_matroska_as_ffmpeg_reads_them(tmp_path: Path, yaw: float, roll: float) -> None:
    av = need_av()
    random = np.random.default_rng(4)
    small = random.integers(0, 256, (6, 9, 3)).astype(np.uint8)
    picture = np.asarray(cv2.resize(small, (144, 96)), np.uint8)
    with Video(write_posed(tmp_path / "plain.mkv", [picture] * 3, 0.0, 0.0)) as video:
        stored = next(video).image
    path = write_posed(tmp_path / "posed.mkv", [picture] * 3, yaw, roll)
    with av.open(str(path)) as container:
        beside = next(container.decode(video=0)).side_data.get("DISPLAYMATRIX")
    matrix = (1, 0, 0, 1)
    if beside is not None:
        a, b, _, c, d, *_ = struct.unpack("9i", bytes(beside))
        matrix = tuple(round(value / 65536) for value in (a, b, c, d))
    assert (yaw or roll) == 0.0 or beside is not None
    with Video(path) as video:
        np.testing.assert_array_equal(next(video).image, as_ffmpeg_shows(stored, matrix))
        assert not [each for each in video.warnings if "matrix" in each]


def test_a_matrix_of_the_movie_comes_after_that_of_the_track(tmp_path: Path) -> None:
    path, _ = lossless(tmp_path / "clip.mp4")
    with Video(path) as video:
        (stored, *_) = [frame.image for frame in video]
    path = with_matrix(path, (0, 1, -1, 0))
    data = bytearray(path.read_bytes())
    at = data.find(b"mvhd") + 4 + 36
    data[at : at + 36] = struct.pack(">9i", -1 << 16, 0, 0, 0, 1 << 16, 0, 0, 0, 1 << 30)
    path.write_bytes(data)
    with Video(path) as video:
        np.testing.assert_array_equal(next(video).image, np.rot90(stored, -1)[:, ::-1])


@pytest.mark.parametrize(
    ("matrix", "words"),
    [((0, 0, 0, 0), "display matrix is zero, or has no turn by quarters"), ((1, 1, -1, 1), "has no turn by quarters")],
)
def test_a_matrix_that_is_none_is_ignored_and_told(
    tmp_path: Path, matrix: tuple[int, int, int, int], words: str
) -> None:
    path, _ = lossless(tmp_path / "clip.mp4")
    with Video(path) as video:
        stored = next(video).image
    with Video(with_matrix(path, matrix)) as video:
        np.testing.assert_array_equal(next(video).image, stored)
        (note,) = [each for each in video.warnings if "matrix" in each]
    assert words in note


@pytest.mark.parametrize("turn", [0, 90, 180, 270])
@pytest.mark.parametrize("mirror", [False, True])
def test_a_user_turns_what_the_header_has_turned(tmp_path: Path, turn: int, mirror: bool) -> None:
    path, _ = lossless(tmp_path / "clip.mp4")
    path = with_matrix(path, (0, 1, -1, 0))
    with Video(path) as video:
        upright = [frame.image for frame in video]
    with Video(path, turn=turn, mirror=mirror) as video:
        for frame, before in zip(video, upright, strict=True):
            shown = np.rot90(before, -turn // 90)
            np.testing.assert_array_equal(frame.image, shown[:, ::-1] if mirror else shown)
        again = video.again()
    with again:
        assert (again.width, again.height) == (video.width, video.height)


def test_pictures_are_turned_too(tmp_path: Path) -> None:
    picture = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)
    cv2.imwrite(str(tmp_path / "0.png"), picture)
    with Video(tmp_path, turn=90) as video:
        assert (video.width, video.height) == (4, 6)
        np.testing.assert_array_equal(next(video).image, np.rot90(picture, -1))
    with Video(tmp_path, mirror=True) as video:
        np.testing.assert_array_equal(next(video).image, picture[:, ::-1])


def two_streams(path: Path) -> Path:
    """Write a thumbnail of four pictures, then twenty pictures of another size."""
    small = [np.full((60, 80, 3), 40 + 5 * k, np.uint8) for k in range(4)]
    large = [np.full((120, 160, 3), 100 + 5 * k, np.uint8) for k in range(20)]
    return write_clip(path, [small, large])


@pytest.mark.parametrize("name", ["clip.mp4", "clip.mkv", "clip.mov", "clip.ts"])
def test_of_several_streams_the_one_that_plays_longest_is_read(tmp_path: Path, name: str) -> None:
    path = two_streams(tmp_path / name)
    with Video(path) as video:
        assert (video.width, video.height) == (160, 120)
        (note,) = video.warnings
        frames = list(video)
    assert note == (
        "the file has several video streams, 0 (80 x 60, 0.2 s), 1 (160 x 120, 0.8 s): 1 is read; --stream chooses"
    )
    assert [round(float(frame.image.mean())) for frame in frames] == pytest.approx(
        [100 + 5 * k for k in range(20)], abs=5
    )
    assert [frame.time for frame in frames] == pytest.approx([0.04 * k for k in range(20)], abs=1e-3)
    with Video(path, stream=0) as video:
        assert (video.width, video.height, len(list(video)), video.warnings) == (80, 60, 4, [])


def test_a_stream_that_is_not_there(tmp_path: Path) -> None:
    path = two_streams(tmp_path / "clip.mp4")
    with pytest.raises(ValueError, match=r"has the video streams 0 \(80 x 60, 0.2 s\), 1 .*, there is no stream 2"):
        Video(path, stream=2)
    cv2.imwrite(str(tmp_path / "0.png"), np.zeros((4, 6, 3), np.uint8))
    with pytest.raises(ValueError, match="a stream is one of those of a video file, not of"):
        Video(tmp_path / "0.png", stream=0)


def test_without_pyav_the_first_stream_is_read_and_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = two_streams(tmp_path / "clip.mp4")
    monkeypatch.setattr(stream_choice, "has_pyav", lambda: False)
    with Video(path) as video:
        assert (video.width, video.height) == (80, 60)
        (note,) = [each for each in video.warnings if "streams" in each]
    assert "0 is read; --stream chooses; pip install 'av>=15' reads the longest" in note


def with_losses(path: Path, lost: list[int]) -> Path:
    """Copy a raw H.264 video without the second half of some of its pictures."""
    data = path.read_bytes()
    starts = [place for place in range(len(data) - 3) if data[place : place + 3] == b"\0\0\1"] + [len(data)]
    pieces = [data[begin:end] for begin, end in itertools.pairwise(starts)]
    coded = [number for number, piece in enumerate(pieces) if piece[3] & 31 in (1, 5)]
    for picture in lost:
        number = coded[picture]
        pieces[number] = pieces[number][: len(pieces[number]) // 2]
    result = path.with_stem("lost")
    result.write_bytes(b"".join(pieces))
    return result


def moving_clip(path: Path, count: int = 30) -> Path:
    pictures = [ball_picture((320, 240), (60.0 + 6 * k, 120.0, 30.0)) for k in range(count)]
    options = {"g": "10", "bf": "0", "crf": "18", "x264-params": "scenecut=0:slices=1:sliced-threads=0"}
    return write_clip(path, [pictures], options=options)


def test_damaged_pictures_are_known_until_the_next_key_picture(tmp_path: Path) -> None:
    path = with_losses(moving_clip(tmp_path / "clip.h264"), [13])
    with Video(path, damaged=True) as video:
        frames = list(video)
        assert video.damaged == 7
        assert video.warnings[-1] == "7 damaged frames handed out"
    assert [frame.index for frame in frames if frame.damaged] == [13, 14, 15, 16, 17, 18, 19]
    with Video(path, damaged=False) as video:
        frames = list(video)
        assert video.damaged == 7
        assert video.warnings[-1] == "7 damaged frames left out"
    assert [frame.index for frame in frames] == [*range(13), *range(20, 30)]
    assert not any(frame.damaged for frame in frames)


def test_a_video_of_which_every_second_picture_is_damaged(tmp_path: Path) -> None:
    path = with_losses(moving_clip(tmp_path / "clip.h264"), list(range(1, 30, 2)))
    with Video(path, damaged=True) as video:
        frames = list(video)
        assert video.damaged >= 15
    assert not any(frame.damaged for frame in frames if frame.index % 10 == 0)
    with Video(path) as video:  # by OpenCV, which does not say
        assert len(list(video)) >= 15


def test_a_whole_video_has_no_damaged_picture(tmp_path: Path) -> None:
    with Video(moving_clip(tmp_path / "clip.mp4"), damaged=False) as video:
        assert len(list(video)) == 30
        assert (video.damaged, video.warnings) == (0, [])
