"""A bag as a video: the pictures of one topic, with the times at which they were taken."""

import itertools
import math
import statistics
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import msgspec

from matchset.image.frame import Frame
from matchset.media.bags.bag_file import BagFile, BagMessage, BagTopic
from matchset.media.bags.mcap_images import McapImages
from matchset.media.bags.packed_fields import NANO
from matchset.media.bags.picture_message import KINDS, read_message, stamp_of
from matchset.media.bags.ros_image import ENCODINGS, IMAGE, Picture, RosPicture
from matchset.media.bags.rosbag_file import RosbagFile
from matchset.media.bags.video_messages import DecodedPicture, VideoMessages, codec_of
from matchset.media.upright.depth import DepthScaling
from matchset.media.video_files.image_folder import in_order
from matchset.media.video_files.recorded import Recorded
from matchset.media.video_files.video_file import check_readable

SUFFIXES = (".bag", ".db3", ".mcap", ".active")
DESCRIPTION, KEY = "metadata.yaml", b"rosbag2_bagfile_information"
LONGEST_BEGINNING = 4096  # format: bytes of the description within which its key stands


class BagParameters(msgspec.Struct, frozen=True):
    """How the rate of a bag's pictures is found.

    Chosen by hand; `tests/media/bags` would show a change.

    Parameters
    ----------
    probe_messages : int
        Messages at the beginning whose time stamps give the frame rate. More resists a slow start; each is held in
        memory until it is read.
    """

    probe_messages: int = 16


DEFAULT = BagParameters()


class _Picture(NamedTuple):
    """A picture that was decoded, the number of its message, and the times of that, ns."""

    number: int
    image: Picture
    recorded: int
    stamp: int
    damaged: bool = False


class Bag(Recorded):
    """The pictures of one topic of a bag, one frame each, in the order in which they were recorded.

    Parameters
    ----------
    path : Path
        A file or folder for which `is_bag` holds.
    topic : str or None
        Which topic; None if there is one only.
    fps : float or None
        Given, times are index / fps; otherwise they are those of the messages' headers, s since 1970 on most robots,
        or those of the recording where the headers have none.
    damaged : bool
        Whether pictures are handed out in which the decoder of a video reports errors.

    Raises
    ------
    ValueError
        If the bag cannot be read, the topic is not there, or is not the only one with pictures and was not named, or
        no picture of it decodes; also while reading, where the file is damaged.
    """

    def __init__(self, path: Path, topic: str | None, fps: float | None, damaged: bool = True) -> None:
        self.path, self.broken, self.damaged, self._depth, self._keeps_damaged = path, 0, 0, DepthScaling(), damaged
        self._file = open_bag(path)
        try:
            if self._file.cut_off and not self._file.topics:
                raise ValueError(f"{path} ends in the middle, before its first message")
            chosen = choose_topic(path, self._file.topics, topic)
            self.topic, self._kind, self.length = chosen.name, chosen.kind, chosen.messages
            messages = self._file.messages(chosen.name)
            first = list(itertools.islice(messages, DEFAULT.probe_messages))
            self._messages: Iterator[BagMessage] = itertools.chain(first, messages)
            self._next, self._read, self._unordered, self._last, self._recorded = 0, 0, 0, -math.inf, 0
            self._rate = fps
            stamps = [stamp_of(message, self._kind) for message in first]
            self._stamped = any(stamps)
            self.fps = fps or _frame_rate(stamps if self._stamped else [message.time for message in first])
            self._unknown = ""
            self._video: VideoMessages | None = None
            self._pictures = self._read_pictures()
            self._first = self._decode()
            if self._first is None:
                raise ValueError(f"no picture of {self.topic} in {path} could be decoded{self._unknown}")
        except BaseException:
            self.close()
            raise
        self.shape = self._first.image.shape

    @property
    def warnings(self) -> list[str]:
        """What is not as it should be, so far."""
        words = self._depth.notes
        if self._rate is None and not self._stamped:
            words.append(f"the pictures of {self.topic} have no time stamps: times are those of the recording")
        if self._unordered:
            words.append(f"time stamps that do not run forward: {self._unordered}; the recording's times count there")
        if self._file.cut_off:
            words.append(f"{self.path} ends in the middle: it was not closed")
        return words

    def _decode(self) -> Frame | None:
        for picture in self._pictures:
            self.broken += max(0, picture.number - self._next)
            self._next = picture.number + 1
            self.damaged += picture.damaged
            if not picture.damaged or self._keeps_damaged:
                time = self._time(picture.number, picture.recorded, picture.stamp)
                return Frame(picture.image, time, picture.number, picture.damaged)
        self.broken += max(0, self._read - self._next)
        self._next = self._read
        return None

    def _read_pictures(self) -> Iterator[_Picture]:
        """Yield the pictures of all messages that decode."""
        waiting: dict[int, tuple[int, int]] = {}  # times of messages whose pictures a decoder still holds
        self._read = 0
        for message in self._messages:
            index, self._read = self._read, self._read + 1
            try:
                picture = read_message(message, self._kind, self._depth)
            except ValueError as error:
                picture = RosPicture(0, str(error), None, True)
            if picture.coded:
                waiting[index] = message.time, picture.stamp
                yield from self._out_of(waiting, self._decoder(picture.encoding).decode(index, picture.coded))
            elif picture.image is not None:
                yield _Picture(index, picture.image, message.time, picture.stamp)
            elif not picture.known and not self._unknown:
                self._unknown = f": its encoding is {picture.encoding!r}, {_known(self._kind)} are read"
        if self._video is not None:
            yield from self._out_of(waiting, self._video.finish())

    def _out_of(self, waiting: dict[int, tuple[int, int]], decoded: Iterator[DecodedPicture]) -> Iterator[_Picture]:
        """Yield the pictures that a decoder hands out, each with the times of its message."""
        for number, image, damaged in decoded:
            for earlier in [each for each in waiting if each < number]:
                del waiting[earlier]
            if number in waiting:
                recorded, stamp = waiting.pop(number)
                yield _Picture(number, image, recorded, stamp, damaged)

    def _decoder(self, form: str) -> VideoMessages:
        """Return what decodes the video of this topic; ValueError where PyAV is missing."""
        if self._video is None:
            try:
                self._video = VideoMessages(codec_of(form) or "")
            except ValueError as error:
                raise ValueError(f"{self.path}, {self.topic}: {error}") from None
        return self._video

    def _time(self, index: int, recorded: int, stamp: int) -> float:
        """Time of a frame, s; always later than the one before."""
        if self._rate is not None:
            return index / self._rate
        wanted = (stamp if self._stamped else recorded) / NANO
        if wanted <= self._last:
            self._unordered += 1
            wanted = max(self._last + (recorded - self._recorded) / NANO, math.nextafter(self._last, math.inf))
        self._last, self._recorded = wanted, recorded
        return wanted

    def close(self) -> None:
        """Let go of the file."""
        self._file.close()


def is_bag(path: Path) -> bool:
    """Whether a path is that of a ROS 1 bag, a ROS 2 bag or an MCAP file, by its name or by what is in the folder."""
    if not path.is_dir():
        return path.suffix.lower() in SUFFIXES
    return _is_described(path) or (bool(_inside(path)) and not in_order(path))


def open_bag(path: Path) -> BagFile:
    """Open a bag.

    Parameters
    ----------
    path : Path
        A file or folder for which `is_bag` holds.

    Raises
    ------
    ValueError
        If it is missing, damaged, cut off or encrypted, or the package that reads it is not installed.
    """
    if path.is_dir():
        if not _is_described(path):
            file = path / _inside(path)[0]
            raise ValueError(f"{path} is no bag, it has no {DESCRIPTION}: name {file}, or try: ros2 bag reindex {path}")
        return RosbagFile(path)
    check_readable(path)
    return McapImages(path) if path.suffix.lower() == ".mcap" else RosbagFile(path)


def choose_topic(path: Path, topics: list[BagTopic], asked: str | None) -> BagTopic:
    """Choose the topic whose pictures are read.

    Parameters
    ----------
    path : Path
        The bag, for messages.
    topics : list of BagTopic
        All its topics.
    asked : str or None
        The topic that the user named.

    Raises
    ------
    ValueError
        If there is none, or not this one, or several and none was named; the message lists those there are.
    """
    pictures = [each for each in topics if each.kind in KINDS]
    if not pictures:
        there = f"its topics: {_listed(topics)}" if topics else "it has no topics"
        raise ValueError(f"{path} has no topic with pictures ({', '.join(KINDS)}); {there}")
    if asked is not None:
        for each in pictures:
            if each.name.strip("/") == asked.strip("/"):
                return each
        raise ValueError(f"{path} has no pictures in a topic {asked!r}, but in {_listed(pictures)}")
    filled = [each for each in pictures if each.messages] or pictures
    if len(filled) > 1:
        raise ValueError(f"{path} has several topics with pictures, name one with --topic: {_listed(filled)}")
    return filled[0]


def _inside(folder: Path) -> list[str]:
    """Names of the bags in a folder."""
    try:
        return sorted(each.name for each in folder.iterdir() if each.suffix.lower() in SUFFIXES)
    except OSError as error:
        raise ValueError(f"cannot read {folder}: {error.strerror}") from None


def _is_described(folder: Path) -> bool:
    """Whether a folder has the description of a ROS 2 bag; other folders may have a metadata.yaml, too."""
    file = folder / DESCRIPTION
    return file.is_file() and KEY in _beginning(file)


def _beginning(file: Path) -> bytes:
    with file.open("rb") as opened:
        return opened.read(LONGEST_BEGINNING)


def _listed(topics: list[BagTopic]) -> str:
    return ", ".join(each.description for each in topics)


def _known(kind: str) -> str:
    return ", ".join(ENCODINGS) if kind == IMAGE else "JPEG, PNG and what else OpenCV decodes"


def _frame_rate(times: Sequence[int]) -> float | None:
    """Frames per second by the middle one of the differences of times, ns; None if there is none."""
    gaps = [later - earlier for earlier, later in itertools.pairwise(times) if later > earlier]
    return NANO / statistics.median(gaps) if gaps else None
