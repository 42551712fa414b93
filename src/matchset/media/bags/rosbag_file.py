"""ROS 1 bags, and ROS 2 bags as folders or .db3 files; the only file that imports the package rosbags."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from matchset.media.bags.bag_file import NEEDED, BagMessage, BagTopic, kind_of
from matchset.media.bags.packed_fields import CDR, ROS1


class RosbagFile:
    """A bag that the package rosbags reads; implements `matchset.media.bags.bag_file.BagFile`.

    Parameters
    ----------
    path : Path
        A .bag or .db3 file, or a folder with a metadata.yaml.

    Raises
    ------
    ValueError
        If the package is missing, or the bag is damaged, cut off, without index or encrypted.
    """

    cut_off = False  # rosbags refuses such a file

    def __init__(self, path: Path) -> None:
        self.path, self._ros1 = path, path.is_file() and path.suffix != ".db3"
        self._reader = _reader(path, self._ros1)
        try:
            self._reader.open()
            topics = self._reader.topics
        except Exception as error:  # a damaged file brings out errors of every kind
            raise self._refusal(error) from error
        self.topics = [
            BagTopic(name, kind_of(info.msgtype or "several types"), info.msgcount) for name, info in topics.items()
        ]

    def messages(self, topic: str) -> Iterator[BagMessage]:
        """Messages of a topic, in the order in which they were recorded."""
        found = iter(self._reader.messages([each for each in self._reader.connections if each.topic == topic]))
        while True:
            try:
                _, time, data = next(found)
            except StopIteration:
                return
            except Exception as error:  # as above
                raise self._refusal(error) from error
            yield BagMessage(time, bytes(data), ROS1 if self._ros1 else CDR)

    def close(self) -> None:
        """Let go of the file."""
        if self._reader is not None:
            reader, self._reader = self._reader, None
            reader.close()

    def _refusal(self, error: Exception) -> ValueError:
        reason = str(error) or type(error).__name__
        repair = ""
        if "index" in reason.lower():
            repair = f"; try: rosbag reindex {self.path.name}"
        return ValueError(f"{self.path} cannot be read as a bag: {reason}{repair}")


def _reader(path: Path, ros1: bool) -> Any:
    try:
        if ros1:
            from rosbags.rosbag1 import Reader as Reader1

            return Reader1(path)
        from rosbags.rosbag2 import Reader as Reader2

        return Reader2(path)
    except ImportError:
        raise ValueError(f"{path} is a ROS bag: {NEEDED} reads it") from None
