"""Bags as videos: every kind of file, topics, times, and what is said of a file that cannot be read."""

import builtins
import itertools
import random
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import bags
from matchset.media.video import Video

SIZE = (24, 32)
START = 1_700_000_000 * bags.NANO
STEP = 40_000_000  # ns between two pictures


@pytest.fixture(autouse=True)
def _rosbags() -> None:
    bags.need_rosbags()


def picture(index: int) -> bags.Picture:
    return np.full((*SIZE, 3), (10 * index + 5, 60, 200 - 10 * index), np.uint8)


def pictures(kind: str, count: int = 5, topic: str = "/cam/image_raw") -> list[tuple[str, int, Any]]:
    types = bags.store(kind == "ros1")
    return [
        (topic, START + k * STEP + 9_000_000, bags.image(types, START + k * STEP, picture(k), "bgr8", SIZE))
        for k in range(count)
    ]


def imu(kind: str) -> tuple[str, int, Any]:
    types = bags.store(kind == "ros1")
    return "/temperature", START, types.types["sensor_msgs/msg/Temperature"](bags.header(types, START), 21.0, 0.1)


@pytest.mark.parametrize("kind", bags.KINDS)
def test_every_kind_gives_all_pictures_at_the_times_of_their_capture(kind: str, tmp_path: Path) -> None:
    path = bags.write_bag(tmp_path, kind, [imu(kind), *pictures(kind)])
    with Video(path) as video:
        frames = list(video)
        assert (video.topic, video.length, video.live) == ("/cam/image_raw", 5, False)
        assert (video.width, video.height, video.channels) == (32, 24, 3)
        assert video.fps == pytest.approx(25.0)
        assert video.warnings == []
    assert [frame.index for frame in frames] == list(range(5))
    assert [frame.time for frame in frames] == [(START + k * STEP) / bags.NANO for k in range(5)]
    for k, frame in enumerate(frames):
        assert np.array_equal(frame.image, picture(k))
        assert frame.image.flags.writeable


@pytest.mark.parametrize("kind", bags.KINDS)
def test_compressed_pictures(kind: str, tmp_path: Path) -> None:
    types = bags.store(kind == "ros1")
    png = cv2.imencode(".png", picture(3))[1].tobytes()
    jpeg = cv2.imencode(".jpg", picture(4))[1].tobytes()
    messages = [
        ("/cam/compressed", START + 1, bags.compressed(types, START, png, "bgr8; png compressed bgr8")),
        ("/cam/compressed", START + 2, bags.compressed(types, START + STEP, jpeg)),
    ]
    first, second = Video(str(bags.write_bag(tmp_path, kind, messages)))
    assert np.array_equal(first.image, picture(3))
    assert np.abs(second.image.astype(int) - picture(4)).max() <= 3


def test_two_topics_are_listed_and_one_is_chosen(tmp_path: Path) -> None:
    path = bags.write_bag(tmp_path, "ros1", [*pictures("ros1", 2), *pictures("ros1", 3, "/down/image_raw")])
    with pytest.raises(ValueError, match="several topics with pictures, name one with --topic") as caught:
        Video(path)
    assert "/cam/image_raw (sensor_msgs/Image, 2), /down/image_raw (sensor_msgs/Image, 3)" in str(caught.value)
    assert len(list(Video(path, topic="/down/image_raw"))) == 3
    assert len(list(Video(path, topic="cam/image_raw"))) == 2
    with pytest.raises(ValueError, match=r"no pictures in a topic '/up', but in /cam/image_raw \("):
        Video(path, topic="/up")


@pytest.mark.parametrize("kind", bags.KINDS)
def test_a_bag_without_pictures_lists_its_topics(kind: str, tmp_path: Path) -> None:
    path = bags.write_bag(tmp_path, kind, [imu(kind)])
    with pytest.raises(ValueError, match=r"no topic with pictures .*: /temperature \(sensor_msgs/Temperature, 1\)"):
        Video(path)


def test_a_topic_belongs_to_a_bag(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "0.png"), picture(0))
    (tmp_path / "metadata.yaml").write_text("author: me\n")
    assert Video(tmp_path).topic is None
    with pytest.raises(ValueError, match="a topic belongs to a bag"):
        Video(tmp_path, topic="/cam")
    with pytest.raises(ValueError, match=r"a topic belongs to a bag .* not to camera 0"):
        Video(0, topic="/cam")


def stamped(stamps: list[int], recorded: list[int], tmp_path: Path) -> tuple[list[float], Video]:
    types = bags.store(False)
    messages = [
        ("/cam", time, bags.image(types, stamp, picture(0), "bgr8", SIZE))
        for stamp, time in zip(stamps, recorded, strict=True)
    ]
    video = Video(bags.write_bag(tmp_path, "mcap file", messages))
    return [frame.time for frame in video], video


def test_without_stamps_the_times_of_the_recording_count(tmp_path: Path) -> None:
    times, video = stamped([0, 0, 0], [5 * bags.NANO, 6 * bags.NANO, 8 * bags.NANO], tmp_path)
    assert times == [5.0, 6.0, 8.0]
    assert video.warnings == ["the pictures of /cam have no time stamps: times are those of the recording"]


def test_single_stamps_that_do_not_run_forward_are_bridged(tmp_path: Path) -> None:
    half = bags.NANO // 2
    times, video = stamped([2 * half, 3 * half, 3 * half, 0, 6 * half], [half * k for k in range(10, 15)], tmp_path)
    assert times == [1.0, 1.5, 2.0, 2.5, 3.0]
    assert video.warnings == ["time stamps that do not run forward: 2; the recording's times count there"]


def test_equal_stamps_at_equal_times_still_run_forward(tmp_path: Path) -> None:
    times, _ = stamped([START] * 4, [START] * 4, tmp_path)
    assert all(early < late for early, late in itertools.pairwise(times))
    assert times[-1] - START / bags.NANO < 1e-6


def test_the_rate_can_be_given(tmp_path: Path) -> None:
    video = Video(bags.write_bag(tmp_path, "sqlite", pictures("sqlite")), fps=10.0)
    assert [frame.time for frame in video] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])


def test_a_broken_picture_is_skipped_and_keeps_its_number(tmp_path: Path) -> None:
    types = bags.store(True)
    good = cv2.imencode(".png", picture(1))[1].tobytes()
    messages = [
        ("/cam", START + k, bags.compressed(types, START + k * STEP, data)) for k, data in enumerate([good, b"", good])
    ]
    video = Video(bags.write_bag(tmp_path, "ros1", messages))
    assert [frame.index for frame in video] == [0, 2]
    assert video.warnings == ["1 broken frame skipped"]


def test_a_size_that_changes_is_refused(tmp_path: Path) -> None:
    types = bags.store(False)
    small = np.zeros((8, 8, 3), np.uint8)
    messages = [
        *pictures("mcap", 1),
        ("/cam/image_raw", START + STEP, bags.image(types, START + STEP, small, "bgr8", (8, 8))),
    ]
    with pytest.raises(ValueError, match="frame 1 is 8 x 8 in color, those before it are 32 x 24"):
        list(Video(bags.write_bag(tmp_path, "mcap", messages)))


def test_an_encoding_that_is_not_read_is_named(tmp_path: Path) -> None:
    types = bags.store(False)
    messages = [("/depth", START, bags.image(types, START, np.zeros(SIZE, np.float32), "32FC1", SIZE))]
    with pytest.raises(ValueError, match=r"no picture of /depth .* its encoding is '32FC1', mono8, .* are read"):
        Video(bags.write_bag(tmp_path, "mcap", messages))


@pytest.mark.parametrize(("kind", "package"), [("ros1", "rosbags"), ("sqlite", "rosbags"), ("mcap file", "mcap")])
def test_a_missing_package_is_named(kind: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = bags.write_bag(tmp_path, kind, pictures(kind, 1))
    for name in [name for name in sys.modules if name.split(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    real = builtins.__import__

    def missing(name: str, *words: Any, **more: Any) -> Any:
        if name.split(".")[0] == package:
            raise ImportError(name)
        return real(name, *words, **more)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ValueError, match=r"pip install 'rosbags"):
        Video(path)


def test_a_folder_without_its_description_says_what_to_open(tmp_path: Path) -> None:
    path = bags.write_bag(tmp_path, "mcap", pictures("mcap"))
    (path / "metadata.yaml").unlink()
    with pytest.raises(ValueError, match=r"it has no metadata.yaml: name .*flight\.mcap, or try: ros2 bag reindex"):
        Video(path)


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap", ".bag.active"])
def test_what_is_no_bag_is_one_error(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"flight{suffix}"
    with pytest.raises(ValueError, match="no such file"):
        Video(path)
    path.write_bytes(b"")
    with pytest.raises(ValueError, match="is empty"):
        Video(path)
    path.write_bytes(b"this is not what its name says" * 40)
    with pytest.raises(ValueError, match="flight"):
        Video(path)


def test_an_encrypted_bag_is_refused(tmp_path: Path) -> None:
    path = bags.write_bag(tmp_path, "ros1", pictures("ros1"))
    data = path.read_bytes()
    field = b"encryptor=rosbag/AesCbcEncryptor"
    size = int.from_bytes(data[13:17], "little")
    head = data[17 : 17 + size] + len(field).to_bytes(4, "little") + field
    path.write_bytes(data[:13] + len(head).to_bytes(4, "little") + head + data[17 + size :])
    with pytest.raises(ValueError, match="encryption 'rosbag/AesCbcEncryptor' is not supported"):
        Video(path)


def test_a_bag_that_was_not_closed_says_how_to_mend_it(tmp_path: Path) -> None:
    path = bags.write_bag(tmp_path, "ros1", pictures("ros1"))
    data = bytearray(path.read_bytes())
    at = data.index(b"index_pos=") + 10
    data[at : at + 8] = bytes(8)
    path.write_bytes(data)
    with pytest.raises(ValueError, match=r"not indexed.*rosbag reindex flight\.bag"):
        Video(path)


def test_an_mcap_file_that_was_cut_off_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    from mcap.writer import CompressionType, Writer

    whole = bags.write_bag(tmp_path, "mcap", pictures("mcap"))
    path = tmp_path / "cut.mcap"
    with path.open("wb") as file, next(whole.glob("*.mcap")).open("rb") as source:
        from mcap.reader import make_reader

        writer = Writer(file, chunk_size=1000, compression=CompressionType.NONE)
        writer.start(profile="ros2")
        schema = writer.register_schema("sensor_msgs/msg/Image", "ros2msg", b"")
        channel = writer.register_channel("/cam", "cdr", schema)
        for _, _, message in make_reader(source).iter_messages():
            writer.add_message(channel, message.log_time, message.data, message.publish_time)
    path.write_bytes(path.read_bytes()[: 3 * 2600])
    video = Video(path)
    frames = list(video)
    assert 1 <= len(frames) < 5
    assert all(np.array_equal(frame.image, picture(k)) for k, frame in enumerate(frames))
    assert video.warnings == [f"{path} ends in the middle: it was not closed"]


def test_an_mcap_file_without_any_message_says_that_it_was_cut_off(tmp_path: Path) -> None:
    path = bags.write_bag(tmp_path, "mcap file", pictures("mcap file"))
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(ValueError, match="ends in the middle, before its first message"):
        Video(path)


@pytest.mark.parametrize("kind", bags.KINDS)
def test_damage_is_a_value_error(kind: str, tmp_path: Path) -> None:
    """Bytes cut off, overwritten or put in at random: pictures or a ValueError, never another exception."""
    path = bags.write_bag(tmp_path, kind, [imu(kind), *pictures(kind)])
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    whole = {file: file.read_bytes() for file in files}
    dice = random.Random(16)
    refused = 0
    for _ in range(120):
        file = dice.choice(files)
        data = bytearray(whole[file])
        for _ in range(dice.choice([1, 3, 30])):
            at = dice.randrange(len(data))
            action = dice.randrange(3)
            if action == 0:
                del data[at:]
                break
            if action == 1:
                data[at] = dice.randrange(256)
            else:
                data[at : at + dice.randrange(8)] = dice.randbytes(dice.randrange(1, 8))
        file.write_bytes(data)
        try:
            list(Video(path))
        except ValueError:
            refused += 1
        file.write_bytes(whole[file])
    assert refused > 10
