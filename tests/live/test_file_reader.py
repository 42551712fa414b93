"""Any order of reading gives the frames of a plain reading, whatever the file."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from interlaced_videos import ball_clip, pictures_of
from matchset.image.frame import Frame
from matchset.media.exact_reader import (
    ExactReader,
    InterruptedReadingError,
    KeptPictures,
    ReaderParameters,
)
from matchset.media.frame_list import FrameList, StampedVideo
from strange_clips import WIDTH, numbered, write

FRAMES = 60
CONSTANT = [0.04 * index for index in range(FRAMES)]
VARYING = np.concatenate([[0.0], np.cumsum(np.random.default_rng(5).integers(10, 400, FRAMES - 1)) / 1000]).tolist()
EQUAL = [round(24.0 * index / 30.0) / 24.0 for index in range(FRAMES)]
JUMPS = ReaderParameters(near=3, before=(2, 12, 40), kept_mb=1.0, ahead_mb=0.5, behind=4)  # 17 and 8 pictures

Known = tuple[Path, FrameList, list[Frame]]


def known(path: Path) -> Known:
    """Read a file once."""
    frames, plain = FrameList(), []
    with StampedVideo(path) as video:
        for frame in video:
            frames.append(frame, video.stamp)
            plain.append(frame)
    frames.complete = True
    return path, frames, plain


def broken_avi(path: Path) -> Path:
    """Motion JPEG, three of whose pictures do not decode."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25.0, (WIDTH, 120))
    for index in range(FRAMES):
        writer.write(numbered(index))
    writer.release()
    data = bytearray(path.read_bytes())
    starts = [at for at in range(len(data) - 3) if data[at : at + 3] == b"\xff\xd8\xff"]
    for index in (7, 30, 31):
        size = int.from_bytes(data[starts[index] - 4 : starts[index]], "little")
        data[starts[index] : starts[index] + size] = bytes(size)
    path.write_bytes(data)
    return path


def upright(path: Path) -> Path:
    """An MP4 that says it is turned by a quarter, as those of a phone do, in the matrix of its track header."""
    data = bytearray(path.read_bytes())
    at = data.find(b"tkhd") + 4 + 40
    data[at : at + 20] = struct.pack(">5i", 0, 1 << 16, 0, -1 << 16, 0)
    path.write_bytes(data)
    return path


def pictures(folder: Path) -> Path:
    """Write a folder of pictures."""
    folder.mkdir()
    for index in range(FRAMES // 3):
        cv2.imwrite(str(folder / f"{index}.png"), numbered(index))
    return folder


LONG, SHORT, OPEN = {"bf": "2", "g": "250"}, {"bf": "0", "g": "10"}, {"bf": "3", "g": "12", "x264-params": "open-gop=1"}
KINDS: dict[str, Any] = {
    "one key picture": lambda folder: write(folder / "a.mp4", "libx264", CONSTANT, options=LONG),
    "many": lambda folder: write(folder / "b.mp4", "libx264", CONSTANT, options=SHORT),
    "open groups": lambda folder: write(folder / "c.mkv", "libx264", CONSTANT, options=OPEN),
    "varying rate": lambda folder: write(folder / "d.mp4", "libx264", VARYING, options=SHORT),
    "equal stamps": lambda folder: write(folder / "e.mkv", "libx264", EQUAL, options=SHORT),
    "transport stream": lambda folder: write(folder / "f.ts", "libx264", CONSTANT, options=LONG | {"g": "12"}),
    "webm": lambda folder: write(folder / "g.webm", "libvpx", CONSTANT),
    "avi": lambda folder: write(folder / "h.avi", "mpeg4", CONSTANT, options={"g": "12"}),
    "av1": lambda folder: write(folder / "i.mp4", "libsvtav1", CONSTANT),
    "gray": lambda folder: write(folder / "j.mkv", "ffv1", CONSTANT, pixels="gray"),
    "upright": lambda folder: upright(write(folder / "m.mp4", "libx264", CONSTANT, options=SHORT)),
    "broken": lambda folder: broken_avi(folder / "k.avi"),
    "pictures": lambda folder: pictures(folder / "l"),
}


@pytest.fixture(scope="module", params=KINDS)
def file(request: Any, tmp_path_factory: pytest.TempPathFactory) -> Known:
    """A file of each kind, with its plain reading."""
    return known(KINDS[request.param](tmp_path_factory.mktemp("files")))


@pytest.fixture
def reader(file: Known) -> Iterator[ExactReader]:
    """A reader that jumps."""
    with ExactReader(lambda: StampedVideo(file[0]), file[1], JUMPS) as made:
        yield made


def same(one: Frame, other: Frame) -> bool:
    return one.index == other.index and one.time == other.time and np.array_equal(one.image, other.image)


@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.floats(0.0, 1.0, exclude_max=True), max_size=8))
def test_any_order_gives_the_frames_of_a_plain_reading(file: Known, reader: ExactReader, shares: list[float]) -> None:
    _, _, plain = file
    for share in shares:
        place = int(share * len(plain))
        assert same(reader.frame(place), plain[place])


def test_a_file_is_read_backward(file: Known, reader: ExactReader) -> None:
    _, _, plain = file
    backward = list(reader.backward(len(plain) - 1))
    assert len(backward) == len(plain)
    assert all(same(frame, right) for frame, right in zip(backward, reversed(plain), strict=True))


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.integers(-12, 5), max_size=12), st.floats(0.0, 1.0, exclude_max=True))
def test_steps_to_and_fro_show_the_picture_of_that_place(
    file: Known, reader: ExactReader, steps: list[int], begin: float
) -> None:
    _, _, plain = file
    shown, place = KeptPictures(reader, JUMPS), int(begin * len(plain))
    for step in steps:
        place = min(max(place + step, 0), len(plain) - 1)
        assert same(shown.frame(place), plain[place])
        assert len(shown) <= 1_000_000 // plain[0].image.nbytes


def test_most_files_are_read_by_jumps(tmp_path: Path) -> None:
    path, frames, plain = known(KINDS["many"](tmp_path))
    with ExactReader(lambda: StampedVideo(path), frames, JUMPS) as reader:
        for place in (50, 5, 33, 12, 58):
            assert same(reader.frame(place), plain[place])
        assert reader.failed == 0


def test_a_file_that_was_changed_meanwhile_is_said_in_words(tmp_path: Path) -> None:
    path, frames, _ = known(KINDS["many"](tmp_path))
    with ExactReader(lambda: StampedVideo(path), frames, JUMPS) as reader:
        write(path, "libx264", CONSTANT[:30])
        with pytest.raises(ValueError, match="was the file changed"):
            reader.frame(40)


def test_places_of_indices_and_times(tmp_path: Path) -> None:
    _, frames, plain = known(broken_avi(tmp_path / "broken.avi"))
    assert [frame.index for frame in plain][:9] == [0, 1, 2, 3, 4, 5, 6, 8, 9]
    assert [frames.with_index(index) for index in (0, 6, 7, 8, 59, 1000)] == [0, 6, 7, 7, 56, 56]
    assert [frames.at_time(time) for time in (-1.0, 0.0, 0.05, 0.3, 99.0)] == [0, 0, 1, 6, 56]


def test_a_reading_can_be_interrupted_and_goes_on_where_it_was(tmp_path: Path) -> None:
    path, frames, plain = known(write(tmp_path / "clip.mp4", "libx264", CONSTANT))
    asked: list[int] = []
    never = ReaderParameters(near=3, before=())  # no jumps: it reads from the beginning

    def interrupted() -> bool:
        asked.append(1)
        return len(asked) == 20

    with ExactReader(lambda: StampedVideo(path), frames, never) as reader:
        reader.failed = 10**6
        reader.interrupted = interrupted
        with pytest.raises(InterruptedReadingError):
            reader.frame(50)
        assert len(asked) == 20
        np.testing.assert_array_equal(reader.frame(50).image, plain[50].image)
        assert len(asked) == 20 + 51 - 19  # not once more from the beginning


def test_half_frames_are_read_again_in_any_order(tmp_path: Path) -> None:
    path = tmp_path / "interlaced.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (320, 240))
    for picture in pictures_of(ball_clip()):
        writer.write(picture)
    writer.release()
    frames, plain = FrameList(), []
    with StampedVideo(path, fields="top") as video:
        for frame in video:
            frames.append(frame, video.stamp)
            plain.append(frame)
    with ExactReader(lambda: StampedVideo(path, fields="top"), frames, JUMPS) as reader:
        for place in (20, 3, 21, 10, 9, 0):
            frame = reader.frame(place)
            assert (frame.index, frame.time, frame.rows) == (place, plain[place].time, plain[place].rows)
            np.testing.assert_array_equal(frame.image, plain[place].image)
