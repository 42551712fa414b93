"""Video files as strangers have them: containers, codecs, rates, rotations, and what is damaged."""

import struct
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from matchset.media.video import Video
from matchset.media.video_files import video_file
from matchset.media.video_files.container import Container, look_into
from matchset.media.video_files.pyav_capture import open_pyav
from strange_clips import HEIGHT, WIDTH, needs_opencv5, number_of, numbered, write

FRAMES = 40
CONSTANT = [0.04 * index for index in range(FRAMES)]
VARYING = np.concatenate([[0.0], np.cumsum(np.random.default_rng(5).integers(10, 400, FRAMES - 1)) / 1000]).tolist()
CODECS = {"mp4": "libx264", "mov": "mpeg4", "mkv": "libx264", "webm": "libvpx", "ts": "libx264", "flv": "libx264"}


def times_of(video: Video) -> list[float]:
    """Times of all frames, which must be those that were written, in their order."""
    frames = list(video)
    assert [number_of(frame.image) for frame in frames] == [frame.index for frame in frames]
    return [frame.time for frame in frames]


@pytest.mark.parametrize("kind", CODECS)
@pytest.mark.parametrize("stamps", [CONSTANT, VARYING], ids=["constant", "varying"])
def test_times_are_exact_and_nothing_is_said(tmp_path: Path, kind: str, stamps: list[float]) -> None:
    with Video(write(tmp_path / f"clip.{kind}", CODECS[kind], stamps)) as video:
        assert times_of(video) == pytest.approx(stamps, abs=0.0006)  # mkv, webm and flv count milliseconds
        assert video.warnings == []
        assert video.length is not None
        assert FRAMES / 2 < video.length < 2 * FRAMES


@pytest.mark.parametrize("kind", ["mp4", "mkv", "webm", "ts", "flv"])
def test_equal_stamps_cost_less_than_a_tick(tmp_path: Path, kind: str) -> None:
    true = [index / 30.0 for index in range(FRAMES)]
    grid = [round(24.0 * time) / 24.0 for time in true]
    with Video(write(tmp_path / f"clip.{kind}", CODECS[kind], grid)) as video:
        times = times_of(video)
        assert [words for words in video.warnings if "usable time stamp" not in words] == []
    assert len(times) == FRAMES
    assert all(early < late for early, late in pairwise(times))
    assert max(abs(time - right) for time, right in zip(times, true, strict=True)) < 1.0 / 24.0


@pytest.mark.parametrize("frames_between", ["0", "2"])
def test_h264_in_avi_has_its_own_rate(tmp_path: Path, frames_between: str) -> None:
    path = write(tmp_path / "clip.avi", "libx264", CONSTANT, ticks=600, options={"bf": frames_between})
    with Video(path) as video:
        assert video.fps == pytest.approx(25.0)
        assert video.length == pytest.approx(FRAMES, abs=1)
        times = times_of(video)
        assert [time - times[0] for time in times] == pytest.approx(CONSTANT)
        assert [words for words in video.warnings if "usable time stamp" not in words] == []


@needs_opencv5
def test_a_raw_stream_says_which_rate_is_assumed(tmp_path: Path) -> None:
    path = write(tmp_path / "clip.h264", "libx264", CONSTANT)
    with Video(path) as video:
        assert "the file's time stamps say nothing: 25 frames/s are assumed" in video.warnings[0]
        assert "--fps" in video.warnings[0]
        assert times_of(video) == pytest.approx(CONSTANT)
    with Video(path, fps=50.0) as video:
        assert times_of(video) == pytest.approx([time / 2.0 for time in CONSTANT])
        assert video.warnings == []


def cut(path: Path, share: float) -> Path:
    """Copy the first part of a file."""
    data = path.read_bytes()
    result = path.with_stem("cut")
    result.write_bytes(data[: int(share * len(data))])
    return result


@pytest.mark.parametrize(("kind", "codec"), [("mp4", "mpeg4"), ("avi", "mjpeg")])
def test_a_truncated_file_says_so(tmp_path: Path, kind: str, codec: str) -> None:
    muxer = {"movflags": "faststart"} if kind == "mp4" else {}
    pixels = "yuvj420p" if codec == "mjpeg" else "yuv420p"
    path = write(tmp_path / f"clip.{kind}", codec, CONSTANT, ticks=25, pixels=pixels, muxer=muxer)
    with Video(cut(path, 0.7)) as video:
        count = len([frame.index for frame in video])
        assert 5 < count < FRAMES
        assert any(f"the file announces {FRAMES} frames, it ends after" in words for words in video.warnings)


def test_a_truncated_avi_with_empty_periods_says_when_it_ends(tmp_path: Path) -> None:
    path = write(tmp_path / "clip.avi", "mjpeg", VARYING, ticks=100, pixels="yuvj420p")
    with Video(path) as video:
        assert len(list(video)) == FRAMES
        assert video.warnings == []
    with Video(cut(path, 0.6)) as video:
        list(video)
        assert any("s, it ends at" in words for words in video.warnings)


def trimmed(path: Path, share: float) -> Path:
    """Let the edit list of an MP4 play only the first part of its samples, as a phone trims."""
    data = bytearray(path.read_bytes())
    at = data.find(b"elst") + 12
    (played,) = struct.unpack(">I", data[at : at + 4])
    data[at : at + 4] = struct.pack(">I", int(share * played))
    result = path.with_stem("trimmed")
    result.write_bytes(data)
    return result


def test_a_trimmed_mp4_and_one_in_fragments_are_whole(tmp_path: Path) -> None:
    plain = write(tmp_path / "clip.mp4", "libx264", CONSTANT)
    assert look_into(plain)._replace(tracks=()) == Container(counts_frames=True)
    with Video(trimmed(plain, 0.5)) as video:
        assert len(list(video)) == FRAMES // 2
        assert video.warnings == []
    fragments = {"movflags": "frag_keyframe+empty_moov"}
    pieces = write(tmp_path / "pieces.mp4", "libx264", VARYING, options={"g": "8"}, muxer=fragments)
    assert look_into(pieces)._replace(tracks=()) == Container()
    with Video(pieces) as video:
        assert times_of(video) == pytest.approx(VARYING)
        assert video.warnings == []


@pytest.mark.parametrize(("kind", "codec"), [("mp4", "mp4v"), ("avi", "MJPG")])
def test_a_whole_file_with_something_behind_it_is_whole(tmp_path: Path, kind: str, codec: str) -> None:
    path = tmp_path / f"clip.{kind}"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*codec), 25.0, (WIDTH, HEIGHT))
    for index in range(FRAMES):
        writer.write(numbered(index))
    writer.release()
    data = bytearray(path.read_bytes())
    if kind == "avi":  # the length of the whole file in place of what follows
        data[4:8] = len(data).to_bytes(4, "little")
    else:
        data += b"\x7f\xff\xff\xffgps " + bytes(100)
    path.write_bytes(data)
    with Video(path) as video:
        assert times_of(video) == pytest.approx(CONSTANT)
        assert video.warnings == []


def test_an_mp4_that_was_never_finished_says_so(tmp_path: Path) -> None:
    path = tmp_path / "clip.mp4"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 25.0, (WIDTH, HEIGHT))
    for index in range(FRAMES):
        writer.write(numbered(index))
    writer.release()
    with pytest.raises(ValueError, match=r"cut\.mp4 is cut off or was never finished: .* \(moov\)"):
        Video(cut(path, 0.6))


@pytest.mark.parametrize("kind", ["mp4", "mkv", "webm"])
def test_av1_is_named_or_decoded_by_pyav(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    path = write(tmp_path / f"clip.{kind}", "libsvtav1", CONSTANT)
    with Video(path) as video:
        assert times_of(video) == pytest.approx(CONSTANT, abs=0.0006)
        assert (video.width, video.height, video.broken, video.warnings) == (WIDTH, HEIGHT, 0, [])
    decoded = cv2.VideoCapture(str(path)).read()[0]
    monkeypatch.setattr(video_file, "open_pyav", lambda _: None)
    if decoded:  # a build of OpenCV that decodes AV1
        return
    with pytest.raises(ValueError, match=r"its codec is AV1 \(AV01\): pip install 'av>=15', or convert it"):
        Video(path)


def test_an_encrypted_file_is_one_clear_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    key = {"encryption_scheme": "cenc-aes-ctr", "encryption_key": "7" * 32, "encryption_kid": "a" * 32}
    path = write(tmp_path / "clip.mp4", "libx264", CONSTANT, muxer=key)
    with pytest.raises(ValueError, match=r"clip\.mp4 is encrypted: it can only be decoded with its key"):
        Video(path)


def test_a_file_in_which_nothing_decodes_names_its_codec(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "clip.mkv", "libx264", CONSTANT)
    data = bytearray(path.read_bytes())
    begin = data.find(b"\x1fC\xb6u") + 40  # the first cluster
    data[begin:] = np.random.default_rng(1).bytes(len(data) - begin)
    path.write_bytes(data)
    words = r"no frame of .*clip\.mkv could be decoded, its codec is h264: it is encrypted"
    with pytest.raises(ValueError, match=words + " or damaged$"):
        Video(path)
    monkeypatch.setattr(video_file, "open_pyav", lambda _: None)
    with pytest.raises(ValueError, match=words + ", damaged, or needs another decoder: pip install"):
        Video(path)


@needs_opencv5
@pytest.mark.parametrize(
    ("codec", "pixels"), [("libx265", "yuv420p"), ("libx265", "yuv420p10le"), ("libx264", "yuv420p10le")]
)
def test_hevc_and_ten_bits_come_out_as_bgr(tmp_path: Path, codec: str, pixels: str) -> None:
    with Video(write(tmp_path / "clip.mp4", codec, CONSTANT, pixels=pixels)) as video:
        frame = next(video)
        assert frame.image.dtype == np.uint8
        assert frame.image.shape == (HEIGHT, WIDTH, 3)
        assert np.abs(frame.image.astype(int) - numbered(0)).max() < 12
        assert times_of(video) == pytest.approx(CONSTANT[1:])


def test_a_gif_has_its_delays_as_times(tmp_path: Path) -> None:
    delays = [100, 50, 250, 600, 30, 40]
    pictures = [Image.fromarray(numbered(index)) for index in range(len(delays))]
    path = tmp_path / "clip.gif"
    pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=delays)
    with Video(path) as video:
        assert times_of(video) == pytest.approx([0.0, 0.1, 0.15, 0.4, 1.0, 1.03])
        assert (video.length, video.warnings) == (len(delays), [])
    pictures[3].save(path)
    with Video(path) as video:
        assert [number_of(frame.image) for frame in video] == [3]
        assert video.warnings == []


def turned(path: Path, quarters: int) -> Path:
    """Set the rotation of an MP4, as a phone does that was held upright, in the matrix of its track header."""
    cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters]
    data = bytearray(path.read_bytes())
    at = data.find(b"tkhd") + 4 + 40
    for place, value in enumerate((cosine, sine, 0, -sine, cosine, 0, 0, 0)):
        data[at + 4 * place : at + 4 * place + 4] = struct.pack(">i", value << 16)
    result = path.with_stem(f"turned{quarters}")
    result.write_bytes(data)
    return result


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_videos_of_a_phone_come_upright(tmp_path: Path, quarters: int, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "clip.mp4"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 25.0, (WIDTH, HEIGHT))
    for index in range(8):
        writer.write(numbered(index))
    writer.release()
    with Video(path) as video:
        plain = [frame.image for frame in video]
    path = turned(path, quarters)
    with Video(path) as video:
        assert (video.width, video.height) == ((HEIGHT, WIDTH) if quarters % 2 else (WIDTH, HEIGHT))
        for frame, before in zip(video, plain, strict=True):
            np.testing.assert_array_equal(frame.image, np.rot90(before, -quarters))
    pytest.importorskip("av", reason="the package av is missing: it is in the dependency group `test`")
    monkeypatch.setattr(video_file, "open_capture", open_pyav)
    with Video(path) as video:
        for frame, before in zip(video, plain, strict=True):
            assert np.abs(frame.image.astype(int) - np.rot90(before, -quarters)).max() < 12


def test_pyav_and_opencv_agree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "clip.mkv", "libx264", VARYING)
    with Video(path) as video:
        expected, rate = times_of(video), video.fps
    monkeypatch.setattr(video_file, "open_capture", open_pyav)
    with Video(path) as video:
        assert times_of(video) == pytest.approx(expected)
        assert video.fps == pytest.approx(rate)


def test_pyav_leaves_each_picture_its_size_and_the_video_ends_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("av", reason="the package av is missing: it is in the dependency group `test`")
    path = tmp_path / "sizes.mjpeg"
    pictures = [numbered(index) for index in range(5)] + [numbered(5, 320, 240)] * 5
    path.write_bytes(b"".join(cv2.imencode(".jpg", picture)[1].tobytes() for picture in pictures))
    monkeypatch.setattr(video_file, "open_capture", open_pyav)
    with Video(path) as video:
        assert [number_of(next(video).image) for _ in range(5)] == [0, 1, 2, 3, 4]
        with pytest.raises(ValueError, match="frame 5 is 320 x 240 in color, those before it are 160 x 120 in color"):
            next(video)
