"""MCAP files of any encoding, written message by message: `ChannelWriter`; it imports the package mcap when opened."""

from pathlib import Path
from typing import IO, Any, NamedTuple, cast

from matchset.app.disk import WholeFile
from matchset.media.closing import Closing
from matchset.numeric.imports import advice


class Channel(NamedTuple):
    """A topic, and how its messages are encoded.

    Attributes
    ----------
    topic : str
    name : str
        Name of the schema.
    schema : bytes
    schema_encoding : str
        "ros2msg", "protobuf".
    encoding : str
        Of the messages: "cdr", "protobuf".
    """

    topic: str
    name: str
    schema: bytes
    schema_encoding: str
    encoding: str


class ChannelWriter(Closing):
    """Writes messages; what came before the last `flush` is on disk if the program is killed or the disk is full.

    Parameters
    ----------
    path : Path
    profile : str
        Of the file: "ros2", or none.

    Raises
    ------
    ValueError
        If the package mcap is missing.
    OSError
        If the file cannot be written, with its name; also by the methods. Nothing is written any more after that.
    """

    def __init__(self, path: Path, profile: str = "") -> None:
        check_mcap()
        from mcap.writer import CompressionType, Writer

        self._file = WholeFile(path)
        # Pictures are compressed already.
        self._writer: Any = Writer(cast(IO[bytes], self._file), compression=CompressionType.NONE)
        self._closed = False
        try:
            self._writer.start(profile=profile, library="matchset")
        except BaseException:
            self.discard()
            raise
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}

    def add_channel(self, channel: Channel) -> None:
        """Add a topic, if it is not there; also after messages of others."""
        topic, name, schema, schema_encoding, encoding = channel
        if topic in self._channels:
            return
        if name not in self._schemas:
            self._schemas[name] = self._writer.register_schema(name, schema_encoding, schema)
        self._channels[topic] = self._writer.register_channel(topic, encoding, self._schemas[name])

    def append(self, topic: str, data: bytes, time: float, number: int) -> None:
        """Append a message of a topic, of a time in s, with its number in its topic."""
        stamp = max(round(1e9 * time), 0)
        self._writer.add_message(self._channels[topic], stamp, data, stamp, number % 2**32)

    def flush(self) -> None:
        """Give everything to the operating system, as a chunk of the file."""
        self._writer.flush()
        self._file.mark()

    def close(self) -> None:
        """Finish the file."""
        if self._closed:
            return
        self._closed = True
        try:
            if self._file.error is None:
                self.flush()
                self._writer.finish()
        finally:
            self._file.close()

    def discard(self) -> None:
        """Delete what was written; what was there before stays."""
        self._closed = True
        self._file.discard()


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
        raise ValueError(f"recordings need the package mcap: {advice('record')}") from None
