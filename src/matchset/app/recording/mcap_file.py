"""MCAP files, written and read: `McapWriter`, `McapReader`; the only file that imports the package mcap."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from matchset.app.closing import Closing

LARGEST_RECORD = 2**30  # format: bytes; a longer record is taken for damage


class Message(NamedTuple):
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


class McapWriter(Closing):
    """Writes messages; if the program is killed, all but the last megabyte is on disk.

    Parameters
    ----------
    path : Path
    topics : list of Topic

    Raises
    ------
    ValueError
        If the package mcap is missing.
    OSError
        If the file cannot be written.
    """

    def __init__(self, path: Path, topics: list[Topic]) -> None:
        check_mcap()
        from mcap.writer import CompressionType, Writer

        self._file = path.open("wb")
        # Pictures are compressed already.
        self._writer: Any = Writer(self._file, compression=CompressionType.NONE)
        self._writer.start(profile="matchset", library="matchset")
        self._channels: dict[str, int] = {}
        schemas: dict[str, int] = {}
        for topic in topics:
            if topic.name not in schemas:
                schemas[topic.name] = self._writer.register_schema(topic.name, "jsonschema", topic.schema)
            self._channels[topic.topic] = self._writer.register_channel(topic.topic, "msgpack", schemas[topic.name])

    def write(self, message: Message, time: float, number: int) -> None:
        """Append a message, of a time in s, with its number in its topic."""
        stamp = max(round(1e9 * time), 0)
        self._writer.add_message(self._channels[message.topic], stamp, message.data, stamp, number % 2**32)

    def close(self) -> None:
        """Finish the file."""
        if not self._file.closed:
            try:
                self._writer.finish()
            finally:
                self._file.close()


class McapReader:
    """Reads messages in the order in which they were written.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    cut_off : bool
        Whether the file ends in the middle: the program that wrote it did not close it.

    Raises
    ------
    ValueError
        If the package mcap is missing; while reading, if the file is no MCAP file or is damaged.
    """

    def __init__(self, path: Path) -> None:
        check_mcap()
        self.path, self.cut_off = path, False

    def __iter__(self) -> Iterator[Message]:
        from mcap.exceptions import EndOfFile, InvalidMagic, McapError
        from mcap.records import Channel
        from mcap.records import Message as Record
        from mcap.stream_reader import StreamReader

        topics: dict[int, str] = {}
        with self.path.open("rb") as file:
            if not file.read(1):
                raise ValueError(f"{self.path} is empty")
            file.seek(0)
            try:
                for record in StreamReader(file, validate_crcs=True, record_size_limit=LARGEST_RECORD).records:
                    if isinstance(record, Channel):
                        topics[record.id] = record.topic
                    elif isinstance(record, Record):
                        yield Message(topics[record.channel_id], record.data)
            except InvalidMagic:
                raise ValueError(f"{self.path} is no MCAP file") from None
            except EndOfFile:
                self.cut_off = True
            except (McapError, ValueError, KeyError, IndexError, OverflowError, MemoryError, struct.error) as error:
                raise ValueError(f"{self.path} is damaged: {str(error) or type(error).__name__}") from error


def check_mcap() -> None:
    """Refuse to record or replay without the package mcap.

    Raises
    ------
    ValueError
        Says what to install.
    """
    try:
        import mcap  # noqa: F401
    except ImportError:
        raise ValueError("recordings need the package mcap: pip install 'matchset[record]'") from None
