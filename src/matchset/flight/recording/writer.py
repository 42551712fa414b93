"""The recording of a flight, written step by step, so that it can be replayed: `RecordingWriter`."""

from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

import msgspec

from matchset.app.disk import MB, SPACE, FreeSpace, SpaceParameters, UnfinishedFileError
from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.recording.coded_camera import CodedFrame, to_jpeg
from matchset.flight.recording.encoding import colors_message, encode, step_message, to_png, truth_message
from matchset.flight.recording.mcap_file import PACKAGE, McapWriter, RecordedMessage, Topic
from matchset.flight.recording.messages import (
    CONFIGURATION,
    FORMAT,
    TRUTH,
    Configuration,
    Picture,
    sample_topic,
    step_topic,
    topics,
)
from matchset.flight.recording.ros_messages import TF, RosMessages, ros_topic
from matchset.image.frame import Frame
from matchset.media.closing import Closing
from matchset.sharing.ros2.ros_values import TRANSFORMS

COMPRESSORS = 2  # format: threads that compress pictures
MAX_WAITING = 6  # format: steps that wait for their pictures to be compressed; lost if the program is killed
STEP_BYTES = 8_000  # format: about what a step of a follower takes beside its picture


class _Waiting(NamedTuple):
    """A step whose pictures are being compressed."""

    chain_step: ChainStep
    armed: Sequence[bool]
    pictures: list[Future[bytes] | None]


class RecordingWriter(Closing):
    """Writes everything of a flight that its replay needs, the simulator's truth, and the results for tools of ROS.

    If the disk is full, or nearly, the recording ends there, whole; what comes after that is counted, and `close`
    raises: a full disk never ends a flight.

    Parameters
    ----------
    path : Path
    setup : FlightSetup
    space : SpaceParameters, optional
        How much of the disk is left free.
    jpeg : int, optional
        Quality of the pictures that come coded, for the estimate.

    Attributes
    ----------
    rate : float
        Bytes a second, estimated from the pictures from which the colors were learned.
    note : str
        How long a recording fits on the disk, in words.

    Raises
    ------
    ValueError
        If the package mcap is missing.
    OSError
        If the file cannot be written.
    """

    def __init__(self, path: Path, setup: FlightSetup, space: SpaceParameters = SPACE, jpeg: int | None = None) -> None:
        self._path, self._space = path, FreeSpace(path, space)
        self._error: OSError | None = None
        self._offered = self._written = 0
        self._ros = [RosMessages(number, camera) for number, camera in enumerate(setup.cameras, 1)]
        own = [_topic(*each) for each in topics(setup.followers).items()]
        ros = [topic for each in self._ros for topic in each.topics]
        self._writer = McapWriter(path, [*own, *ros, ros_topic(TF, TRANSFORMS)])
        self._pool = ThreadPoolExecutor(COMPRESSORS, "matchset recording")
        self._waiting: deque[_Waiting] = deque()
        try:
            self._write_setup(setup)
        except BaseException:
            self._pool.shutdown(cancel_futures=True)
            self._writer.close()
            raise
        coded = [to_png(each.image) if jpeg is None else to_jpeg(each.image, jpeg) for each in setup.samples]
        self.rate = setup.fps * sum(len(each) + STEP_BYTES for each in coded)
        minutes = max(self._space.left, 0.0) / self.rate / 60.0
        self.note = f"{path} takes {self.rate / MB:.0f} MB a second: its disk has room for {minutes:.3g} minutes"

    def write(self, chain_step: ChainStep, armed: Sequence[bool]) -> None:
        """Append a step, and which pilots had been told to fly. A full disk is no error here."""
        self._offered += 1
        if self._error is not None:
            return
        pictures = [None if step.frame is None else self._coded(step.frame) for step in chain_step.steps]
        self._waiting.append(_Waiting(chain_step, armed, pictures))
        while self._waiting and (len(self._waiting) > MAX_WAITING or _compressed(self._waiting[0])):
            self._write_first()

    @property
    def failure(self) -> Exception | None:
        """Why nothing more is written; None while all is well."""
        return self._error

    def close(self) -> None:
        """Write what is waiting and finish the file.

        Raises
        ------
        UnfinishedFileError
            If the disk was full: says how many steps the file holds.
        """
        try:
            while self._waiting:
                self._write_first()
        finally:
            self._pool.shutdown(cancel_futures=True)
            self._finish()
        if self._error is not None:
            error, self._error = self._error, None
            raise UnfinishedFileError(error, self._path, f"{self._written} of {self._offered} steps") from error

    def _coded(self, frame: Frame) -> "Future[bytes]":
        """Compress a picture in a thread; one that came coded is written as it came."""
        if not isinstance(frame, CodedFrame):
            return self._pool.submit(to_png, frame.image)
        done: Future[bytes] = Future()
        done.set_result(frame.jpeg)
        return done

    def _write_setup(self, setup: FlightSetup) -> None:
        configuration = Configuration(
            format=FORMAT,
            matchset=_version(),
            parameters=setup.parameters,
            cameras=setup.cameras,
            kind=setup.kind,
            colors=tuple(map(colors_message, setup.colors)),
            countdown=setup.countdown,
            fps=setup.fps,
            devices=setup.devices,
        )
        self._writer.write(RecordedMessage(CONFIGURATION, encode(configuration)), 0.0, 0)
        for number, sample in enumerate(setup.samples, 1):
            message = Picture(sample.index, sample.time, to_png(sample.image))
            self._writer.write(RecordedMessage(sample_topic(number), encode(message)), sample.time, sample.index)
        self._writer.flush()

    def _write_first(self) -> None:
        """Write the step that waits longest; after an error drop all."""
        waiting = self._waiting.popleft()
        try:
            if self._space.left < 0:
                raise self._space.error
            self._write_step(waiting)
            self._writer.flush()
            self._written += 1
        except OSError as error:
            self._waiting.clear()
            self._finish()
            self._error = error

    def _write_step(self, waiting: _Waiting) -> None:
        chain_step, armed, pictures = waiting
        for number, (step, png) in enumerate(zip(chain_step.steps, pictures, strict=True), 1):
            ros = self._ros[number - 1]
            if step.frame is not None and png is not None:
                self._writer.write(ros.picture(step.frame, png.result()), step.frame.time, step.frame.index)
                for each in ros.results(step):
                    self._writer.write(each, step.frame.time, step.frame.index)
            message = step_message(chain_step.index, step, armed[number - 1])
            self._writer.write(RecordedMessage(step_topic(number), encode(message)), step.now, chain_step.index)
        self._writer.write(RecordedMessage(TRUTH, encode(truth_message(chain_step))), chain_step.time, chain_step.index)

    def _finish(self) -> None:
        try:
            self._writer.close()
        except OSError as error:
            self._error = self._error or error


def _compressed(waiting: _Waiting) -> bool:
    return all(picture is None or picture.done() for picture in waiting.pictures)


def _topic(topic: str, struct: type[msgspec.Struct]) -> Topic:
    return Topic(topic, f"{PACKAGE}{struct.__name__}", msgspec.json.encode(msgspec.json.schema(struct)))


def _version() -> str:
    try:
        return version("matchset")
    except PackageNotFoundError:
        return "not installed"
