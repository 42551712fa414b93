"""MCAP files, written and read: `McapWriter`, `McapReader`; it imports the package mcap when one is opened.

A file is a bag of ROS 2 as well. rosbag2 opens a file only if all of its topics are CDR, so a message in msgpack is
packed as the only member of a message of ROS 2, ``uint8[] msgpack``: eight bytes before it (decision 086).
"""

import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from matchset.app.viewers.mcap_writer import Channel, ChannelWriter, check_mcap
from matchset.media.bags.mcap_records import DamagedChunk, read_records
from matchset.sharing.ros2.cdr import HEADER

PACKAGE = "matchset_msgs/msg/"
BEGINNING = b"# MessagePack; its JSON Schema: "
PACKED_SCHEMA = BEGINNING + b"%s\nuint8[] msgpack"
PACKED = struct.Struct("<4sI")  # format: header of CDR, and length of the bytes that follow


class RecordedMessage(NamedTuple):
    """One message.

    Attributes
    ----------
    topic : str
    data : bytes
    """

    topic: str
    data: bytes


class Topic(NamedTuple):
    """A topic, and the schema of its messages.

    Attributes
    ----------
    topic : str
    name : str
        Name of the schema.
    schema : bytes
        JSON Schema of the content, which is encoded as msgpack.
    """

    topic: str
    name: str
    schema: bytes


class RosTopic(NamedTuple):
    """A topic with messages of ROS 2.

    Attributes
    ----------
    topic : str
    name : str
        Name of the type: ``sensor_msgs/msg/CameraInfo``.
    schema : bytes
        Definitions of the type and of those in it, "ros2msg"; the content is CDR.
    """

    topic: str
    name: str
    schema: bytes


class McapWriter(ChannelWriter):
    """Writes the messages of a recording, see `ChannelWriter`.

    Parameters
    ----------
    path : Path
    topics : list of Topic or RosTopic

    Raises
    ------
    ValueError, OSError
        As those of `ChannelWriter`.
    """

    def __init__(self, path: Path, topics: Sequence[Topic | RosTopic]) -> None:
        super().__init__(path, "ros2")
        self._packed: set[str] = set()
        for topic in topics:
            self.add_topic(topic)

    def add_topic(self, topic: Topic | RosTopic) -> None:
        """Add a topic; also after messages of others."""
        packs = isinstance(topic, Topic)
        if packs:
            self._packed.add(topic.topic)
        schema = PACKED_SCHEMA % topic.schema if packs else topic.schema
        self.add_channel(Channel(topic.topic, topic.name, schema, "ros2msg", "cdr"))

    def write(self, message: RecordedMessage, time: float, number: int) -> None:
        """Append a message, of a time in s, with its number in its topic."""
        data = packed(message.data) if message.topic in self._packed else message.data
        self.append(message.topic, data, time, number)


class McapReader:
    """Reads messages in the order in which they were written; those in msgpack without what they are packed in.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    cut_off : bool
        Whether the file ends in the middle: the program that wrote it did not close it.
    damaged : list of DamagedChunk
        Chunks that were left out so far; what follows them is read.

    Raises
    ------
    ValueError
        If the package mcap is missing; while reading, if the file is no MCAP file or is damaged outside its chunks.
    """

    def __init__(self, path: Path) -> None:
        check_mcap()
        self.path, self.cut_off = path, False
        self.damaged: list[DamagedChunk] = []

    def __iter__(self) -> Iterator[RecordedMessage]:
        from mcap.exceptions import EndOfFile, InvalidMagic, McapError
        from mcap.records import Channel, Schema
        from mcap.records import Message as Record

        topics: dict[int, str] = {}
        packing: set[int] = set()
        inside: set[int] = set()
        with self.path.open("rb") as file:
            if not file.read(1):
                raise ValueError(f"{self.path} is empty")
            file.seek(0)
            try:
                for record in read_records(file):
                    if isinstance(record, DamagedChunk):
                        self.damaged.append(record)
                    elif isinstance(record, Schema) and record.data.startswith(BEGINNING):
                        packing.add(record.id)
                    elif isinstance(record, Channel):
                        topics[record.id] = record.topic
                        if record.schema_id in packing:
                            inside.add(record.id)
                    elif isinstance(record, Record):
                        data = unpacked(record.data) if record.channel_id in inside else record.data
                        yield RecordedMessage(topics[record.channel_id], data)
            except InvalidMagic:
                raise ValueError(f"{self.path} is no MCAP file") from None
            except EndOfFile:
                self.cut_off = True
            except (McapError, ValueError, KeyError, IndexError, OverflowError, MemoryError, struct.error) as error:
                raise ValueError(f"{self.path} is damaged: {str(error) or type(error).__name__}") from error


def packed(data: bytes) -> bytes:
    """Pack bytes as a message of ROS 2 whose only member is ``uint8[] msgpack``, in CDR."""
    return PACKED.pack(HEADER, len(data)) + data


def unpacked(data: bytes) -> bytes:
    """Return the bytes in a message of ROS 2 whose only member is ``uint8[] msgpack``.

    Raises
    ------
    ValueError
        If it is none.
    """
    if len(data) < PACKED.size or PACKED.unpack_from(data) != (HEADER, len(data) - PACKED.size):
        raise ValueError("a message is not packed as its length says")
    return data[PACKED.size :]
