"""Bags for tests, written by the package rosbags: an implementation that is not ours."""

import importlib.util
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

KINDS = ("ros1", "sqlite", "mcap", "db3 file", "mcap file")
NANO = 10**9

Picture = npt.NDArray[np.uint8]


def need_rosbags() -> None:
    """Skip a test where the package is missing, and fail in CI."""
    if importlib.util.find_spec("rosbags") is None:
        missing = "the package rosbags is missing: it is in the dependency group `test`"
        if os.environ.get("CI"):
            pytest.fail(missing)
        pytest.skip(missing)


def store(ros1: bool) -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)


def header(types: Any, stamp: int) -> Any:
    time = types.types["builtin_interfaces/msg/Time"](stamp // NANO, stamp % NANO)
    words = {"seq": 7} if "seq" in types.types["std_msgs/msg/Header"].__dataclass_fields__ else {}
    return types.types["std_msgs/msg/Header"](stamp=time, frame_id="camera", **words)


def image(types: Any, stamp: int, pixels: Any, encoding: str, size: tuple[int, int], **more: int) -> Any:
    """A sensor_msgs/Image of the bytes of its pixels; size: height and width."""
    data = np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8)
    step = more.get("step", len(data) // size[0])
    return types.types["sensor_msgs/msg/Image"](
        header=header(types, stamp),
        height=size[0],
        width=size[1],
        encoding=encoding,
        is_bigendian=more.get("big", 0),
        step=step,
        data=data,
    )


def compressed(types: Any, stamp: int, data: bytes, form: str = "jpeg") -> Any:
    return types.types["sensor_msgs/msg/CompressedImage"](
        header=header(types, stamp), format=form, data=np.frombuffer(data, np.uint8)
    )


def write_bag(folder: Path, kind: str, messages: Iterable[tuple[str, int, Any]]) -> Path:
    """Write (topic, time of recording in ns, message) into a bag of a kind; return the path to open."""
    messages = list(messages)
    writer: Any
    if kind == "ros1":
        from rosbags.rosbag1 import Writer as Writer1

        path, writer = folder / "flight.bag", Writer1(folder / "flight.bag")
    else:
        from rosbags.rosbag2 import StoragePlugin
        from rosbags.rosbag2 import Writer as Writer2

        plugin = StoragePlugin.MCAP if "mcap" in kind else StoragePlugin.SQLITE3
        path, writer = folder / "flight", Writer2(folder / "flight", version=9, storage_plugin=plugin)
    types = store(kind == "ros1")
    with writer:
        connections: dict[str, Any] = {}
        for topic, time, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, message.__msgtype__, typestore=types)
            pack = types.serialize_ros1 if kind == "ros1" else types.serialize_cdr
            writer.write(connections[topic], time, pack(message, message.__msgtype__))
    return next(path.glob("flight.*")) if kind.endswith("file") else path
