"""MCAP files with messages of ROS 1, ROS 2 or Foxglove, also cut off ones; imports the package mcap when one is opened.

A file that was closed has an index at its end: the topics stand there, and only the parts with the topic are read. A
file that was not closed is read from its beginning as far as it goes.
"""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from matchset.image.files.limits import LIMITS
from matchset.media.bags.bag_file import NEEDED, BagMessage, BagTopic, kind_of
from matchset.media.bags.mcap_records import LARGEST_RECORD, DamagedChunk, read_records
from matchset.media.bags.packed_fields import CDR, JSON, PROTOBUF, ROS1

FOXGLOVE = "foxglove."  # format: how the names of its messages begin


class _Channel(NamedTuple):
    """A channel of the file: several may have one topic."""

    topic: str
    kind: str
    encoding: str

    @property
    def is_read(self) -> bool:
        """Whether messages that are packed so are read, if they hold a picture."""
        return self.encoding in (ROS1, CDR) or (self.encoding in (JSON, PROTOBUF) and self.kind.startswith(FOXGLOVE))

    @property
    def shown(self) -> str:
        """Type of its messages as in ROS 1; with how they are packed, if they are not read."""
        return kind_of(self.kind) if self.is_read else f"{self.kind} as {self.encoding}"


class McapImages:
    """An MCAP file; implements `matchset.media.bags.bag_file.BagFile`.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    cut_off : bool
        Whether it ends in the middle: it was not closed.

    Raises
    ------
    ValueError
        If the package mcap is missing, or the file is no MCAP file or is damaged.
    """

    def __init__(self, path: Path) -> None:
        try:
            import mcap  # noqa: F401
        except ImportError:
            raise ValueError(f"{path} is an MCAP file: {NEEDED} reads it") from None
        self.path, self.cut_off = path, False
        self._channels: dict[int, _Channel] = {}
        self._counts: Counter[int] = Counter()
        self._file = path.open("rb")
        try:
            self._indexed = self._read_index()
            if not self._indexed:
                self._count_all()
        except BaseException:
            self.close()
            raise
        self.topics = [topic for _, topic in sorted(self._topics().items())]

    def messages(self, topic: str) -> Iterator[BagMessage]:
        """Messages of a topic: of a file with an index in the order of their times, else as they stand in the file."""
        for message in self._in_order(topic) if self._indexed else self._in_file():
            channel = self._channels[message.channel_id]
            if channel.topic == topic and channel.is_read:
                yield BagMessage(message.log_time, message.data, channel.encoding)

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()

    def _topics(self) -> dict[str, BagTopic]:
        found: dict[str, BagTopic] = {}
        for number, channel in self._channels.items():
            before = found[channel.topic].messages if channel.topic in found else 0
            found[channel.topic] = BagTopic(channel.topic, channel.shown, before + self._counts[number])
        return found

    def _read_index(self) -> bool:
        """Read the topics from the index at the end of the file; False if it has none."""
        from mcap.reader import SeekingReader

        try:
            reader = SeekingReader(self._file, record_size_limit=LARGEST_RECORD)
        except Exception:  # what does not begin as one brings out errors of every kind
            raise ValueError(f"{self.path} is no MCAP file") from None
        try:
            summary = reader.get_summary()
        except Exception:  # the end is missing or damaged: what is before it may be whole
            return False
        if summary is None or summary.statistics is None or not summary.chunk_indexes:
            return False
        if any(chunk.uncompressed_size > LIMITS.chunk for chunk in summary.chunk_indexes):
            return False
        for channel in summary.channels.values():
            self._add(channel, summary.schemas.get(channel.schema_id))
        self._counts.update(summary.statistics.channel_message_counts)
        return True

    def _count_all(self) -> None:
        """Read the topics, and how many messages they have, by reading the whole file."""
        self._counts.update(message.channel_id for message in self._in_file())

    def _add(self, channel: Any, schema: Any) -> None:
        name = "unknown" if schema is None else schema.name
        self._channels[channel.id] = _Channel(channel.topic, name, channel.message_encoding)

    def _in_order(self, topic: str) -> Iterator[Any]:
        from mcap.reader import SeekingReader

        self._file.seek(0)
        reader = SeekingReader(self._file, validate_crcs=True, record_size_limit=LARGEST_RECORD)
        found = reader.iter_messages([topic], log_time_order=True)
        while True:
            try:
                _, _, message = next(found)
            except StopIteration:
                return
            except Exception as error:  # a damaged file brings out errors of every kind
                raise self._damage(error) from error
            yield message

    def _in_file(self) -> Iterator[Any]:
        """All messages from the beginning, as far as the file goes; notes channels on the way."""
        from mcap.exceptions import EndOfFile
        from mcap.records import Channel, Message, Schema

        self._file.seek(0)
        schemas: dict[int, Any] = {}
        records = read_records(self._file)
        while True:
            try:
                record = next(records)
            except StopIteration:
                return
            except EndOfFile:
                self.cut_off = True
                return
            except Exception as error:  # as above
                raise self._damage(error) from error
            if isinstance(record, DamagedChunk):
                raise ValueError(f"{self.path} is damaged: {record.reason}")
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                self._add(record, schemas.get(record.schema_id))
            elif isinstance(record, Message) and record.channel_id in self._channels:
                yield record

    def _damage(self, error: Exception) -> ValueError:
        return ValueError(f"{self.path} is damaged: {str(error) or type(error).__name__}")
