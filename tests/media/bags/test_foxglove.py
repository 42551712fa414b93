"""Pictures of Foxglove and videos in messages: JSON, Protocol Buffers, ROS; H.264 piece by piece; deep pictures."""

import base64
import builtins
import json
import struct
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bags
from matchset.media.bags.foxglove import KINDS, read_foxglove
from matchset.media.bags.packed_fields import CDR, JSON, PROTOBUF, ROS1
from matchset.media.video import Video
from shown_clips import access_units, ball_picture, middle_of

START, STEP = 1_700_000_000 * bags.NANO, 40_000_000
PICTURES = [ball_picture((160, 120), (40.0 + 4 * k, 60.0, 20.0)) for k in range(12)]


def varint(value: int) -> bytes:
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])


def field(number: int, content: bytes | int) -> bytes:
    if isinstance(content, int):
        return varint(number << 3) + varint(content)
    return varint(number << 3 | 2) + varint(len(content)) + content


def packed(kind: str, packing: str, form: str, stamp: int, data: bytes) -> bytes:
    """Pack a message as Foxglove's programs do."""
    seconds, nanoseconds = divmod(stamp, bags.NANO)
    if packing == JSON:
        time = {"sec": seconds, "nsec": nanoseconds}
        return json.dumps(
            {"timestamp": time, "frame_id": "cam", "format": form, "data": base64.b64encode(data).decode()}
        ).encode()
    if packing == PROTOBUF:
        numbers = {"data": 2, "format": 3, "frame": 4} if "Image" in kind else {"data": 3, "format": 4, "frame": 2}
        time_field = field(1, field(1, seconds) + field(2, nanoseconds))
        return (
            time_field
            + field(numbers["frame"], b"cam")
            + field(numbers["data"], data)
            + field(numbers["format"], form.encode())
        )
    ends = b"\0" if packing == CDR else b""
    out = bytearray(struct.pack("<II", seconds, nanoseconds))
    for content in (b"cam" + ends, data, form.encode() + ends):
        if packing == CDR:
            out += bytes(-len(out) % 4)
        out += struct.pack("<I", len(content)) + content
    return (b"\0\1\0\0" if packing == CDR else b"") + bytes(out)


def write_mcap(path: Path, kind: str, packing: str, form: str, data: Sequence[bytes]) -> Path:
    pytest.importorskip("mcap", reason="the package mcap is missing: it is in the dependency group `test`")
    from mcap.writer import Writer

    schema = {JSON: "jsonschema", PROTOBUF: "protobuf", ROS1: "ros1msg", CDR: "ros2msg"}[packing]
    name = kind if packing in (JSON, PROTOBUF) else kind.replace("foxglove.", "foxglove_msgs/msg/")
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("/camera", packing, writer.register_schema(name, schema, b""))
        for k, each in enumerate(data):
            message = packed(kind, packing, form, START + k * STEP, each)
            writer.add_message(channel, START + k * STEP + 5, message, START + k * STEP)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def png(picture: Any) -> bytes:
    return bytes(cv2.imencode(".png", picture)[1].tobytes())


@pytest.mark.parametrize("packing", [JSON, PROTOBUF, ROS1, CDR])
def test_compressed_images(tmp_path: Path, packing: str) -> None:
    path = write_mcap(tmp_path / "a.mcap", "foxglove.CompressedImage", packing, "png", [png(each) for each in PICTURES])
    with Video(path) as video:
        assert (video.topic, video.length, video.width, video.height) == ("/camera", 12, 160, 120)
        frames = list(video)
        assert video.warnings == []
    for k, frame in enumerate(frames):
        np.testing.assert_array_equal(frame.image, PICTURES[k])
        assert frame.time == (START + k * STEP) / bags.NANO


@pytest.mark.parametrize("packing", [JSON, PROTOBUF, ROS1, CDR])
@pytest.mark.parametrize("kind", ["foxglove.CompressedVideo", "foxglove.CompressedImage"])
def test_videos_piece_by_piece(tmp_path: Path, packing: str, kind: str) -> None:
    path = write_mcap(tmp_path / "a.mcap", kind, packing, "h264", access_units(PICTURES))
    with Video(path) as video:
        frames = list(video)
        assert (video.broken, video.damaged, video.warnings) == (0, 0, [])
    assert [frame.index for frame in frames] == list(range(12))
    for k, frame in enumerate(frames):
        assert middle_of(frame.image) == pytest.approx((40.0 + 4 * k, 60.0, 20.0), abs=0.5)
        assert frame.time == (START + k * STEP) / bags.NANO


@pytest.mark.parametrize("kind", ["ros1", "mcap file"])
def test_h264_in_messages_of_ros(tmp_path: Path, kind: str) -> None:
    bags.need_rosbags()
    types = bags.store(kind == "ros1")
    units = access_units(PICTURES)
    messages = [
        ("/cam", START + k * STEP, bags.compressed(types, START + k * STEP, unit, "h264"))
        for k, unit in enumerate(units)
    ]
    with Video(bags.write_bag(tmp_path, kind, messages)) as video:
        frames = list(video)
    assert [middle_of(frame.image)[0] for frame in frames] == pytest.approx([40.0 + 4 * k for k in range(12)], abs=0.5)


def test_a_recording_that_begins_in_the_middle(tmp_path: Path) -> None:
    pictures = [*PICTURES, *PICTURES]
    units = access_units(pictures)[4:]  # key pictures at 0, 10, 20
    path = write_mcap(tmp_path / "a.mcap", "foxglove.CompressedVideo", PROTOBUF, "h264", units)
    with Video(path) as video:
        frames = list(video)
        assert video.broken + video.damaged == 6
    whole = [frame for frame in frames if not frame.damaged]
    assert [frame.index for frame in whole] == list(range(6, 20))
    assert middle_of(whole[0].image)[0] == pytest.approx(80.0, abs=0.5)
    with Video(path, damaged=False) as video:
        assert [frame.index for frame in video] == list(range(6, 20))


def test_pictures_that_follow_a_loss_are_damaged(tmp_path: Path) -> None:
    units = access_units([*PICTURES, *PICTURES])
    units[13] = units[13][: len(units[13]) // 2]
    path = write_mcap(tmp_path / "a.mcap", "foxglove.CompressedVideo", JSON, "h264", units)
    with Video(path) as video:
        damaged = [frame.index for frame in video if frame.damaged]
        assert video.damaged + video.broken == 7
        assert f"{len(damaged)} damaged frames handed out" in video.warnings
    assert damaged[-1] == 19


def test_pictures_that_are_missing_are_noticed(tmp_path: Path) -> None:
    units = access_units([*PICTURES, *PICTURES])
    path = write_mcap(tmp_path / "a.mcap", "foxglove.CompressedVideo", JSON, "h264", [*units[:13], *units[14:]])
    with Video(path) as video:
        damaged = [frame.index for frame in video if frame.damaged]
    assert damaged == list(range(13, 19))


def test_without_pyav_it_is_one_clear_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_mcap(tmp_path / "a.mcap", "foxglove.CompressedVideo", JSON, "h264", access_units(PICTURES))
    real = builtins.__import__

    def absent(name: str, *rest: Any) -> Any:
        if name == "av":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.delitem(sys.modules, "av", raising=False)
    monkeypatch.setattr(builtins, "__import__", absent)
    with pytest.raises(
        ValueError, match=r"a\.mcap, /camera: its pictures are a video \(h264\), .*: pip install 'av>=15'"
    ):
        Video(path)


def test_another_packing_is_refused_with_its_name(tmp_path: Path) -> None:
    pytest.importorskip("mcap", reason="the package mcap is missing: it is in the dependency group `test`")
    from mcap.writer import Writer

    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("foxglove.CompressedImage", "flatbuffer", b"")
        writer.add_message(writer.register_channel("/camera", "flatbuffer", schema), START, b"1", START)
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(ValueError, match=r"foxglove\.CompressedImage as flatbuffer"):
        Video(tmp_path / "a.mcap")


@pytest.mark.parametrize("bits", [10, 12])
def test_deep_pictures_of_a_bag_are_scaled(tmp_path: Path, bits: int) -> None:
    bags.need_rosbags()
    types, top = bags.store(False), (1 << bits) - 1
    deep: list[Any] = [np.linspace(0, top, 24 * 32).reshape(24, 32).astype(np.uint16) for _ in range(3)]
    messages = [
        ("/cam", START + k, bags.image(types, START + k, each, "mono16", (24, 32))) for k, each in enumerate(deep)
    ]
    with Video(bags.write_bag(tmp_path, "mcap file", messages)) as video:
        frame = next(video)
        (note,) = video.warnings
    assert np.abs(frame.image - deep[0] * (255.0 / top)).max() <= 1.0
    assert note == f"pictures use {bits} of 16 bits, by the first one: they are scaled by {1 << 16 - bits}"


@given(
    data=st.binary(max_size=200),
    kind=st.sampled_from(sorted(KINDS)),
    packing=st.sampled_from([JSON, PROTOBUF, ROS1, CDR]),
)
def test_any_bytes_are_a_picture_or_a_value_error(data: bytes, kind: str, packing: str) -> None:
    try:
        read_foxglove(data, kind, packing)
    except ValueError:
        return
