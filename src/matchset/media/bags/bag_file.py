"""What a bag offers, whatever package reads it: topics, and the messages of one (`BagFile`)."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol

from matchset.numeric.imports import advice

NEEDED = advice("ros")


class BagTopic(NamedTuple):
    """A topic of a bag.

    Attributes
    ----------
    name : str
    kind : str
        Type of its messages as in ROS 1: ``sensor_msgs/Image``.
    messages : int
        How many there are.
    """

    name: str
    kind: str
    messages: int

    @property
    def description(self) -> str:
        """Name, type and number of messages, for a list."""
        return f"{self.name} ({self.kind}, {self.messages})"


class BagMessage(NamedTuple):
    """A message of a bag.

    Attributes
    ----------
    time : int
        When it was recorded, ns.
    data : bytes
    packing : str
        `ROS1`, `CDR`, `JSON` or `PROTOBUF` of `packed_fields`.
    """

    time: int
    data: bytes
    packing: str


class BagFile(Protocol):
    """A bag that is open.

    Attributes
    ----------
    topics : list of BagTopic
        In the order of their names.
    cut_off : bool
        Whether the file ends in the middle, as far as known.
    """

    topics: list[BagTopic]
    cut_off: bool

    def messages(self, topic: str) -> Iterator[BagMessage]:
        """Messages of a topic, in the order in which they were recorded.

        Raises
        ------
        ValueError
            If the file is damaged.
        """

    def close(self) -> None:
        """Let go of the file."""


def kind_of(name: str) -> str:
    """Type of a message as in ROS 1: without the ``msg`` in the middle that ROS 2 puts there."""
    return name.replace("/msg/", "/")
