"""A recording, read step by step: `RecordingReader`."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec

from matchset.control.files.older_keys import with_newer_keys
from matchset.flight.chain.chain_step import FlightSetup
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.recording.encoding import colors_of, decode, encode, frame_of, frame_of_image
from matchset.flight.recording.mcap_file import McapReader, RecordedMessage
from matchset.flight.recording.messages import (
    CONFIGURATION,
    FORMAT,
    OLDER_NAMES,
    TRUTH,
    WITHOUT_GAINS,
    Configuration,
    Picture,
    StepMessage,
    TruthMessage,
    image_topic,
    sample_topic,
    step_topic,
)
from matchset.image.frame import Frame
from matchset.media.bags.mcap_records import DamagedChunk


class _FormatHeader(msgspec.Struct):
    """What the configuration of every format begins with."""

    format: int


class RecordedChainStep(NamedTuple):
    """A step of the chain as it was recorded.

    Attributes
    ----------
    steps : tuple of StepMessage
        One per follower.
    frames : tuple of (Frame or None)
        The picture of each camera; None if none came.
    truth : TruthMessage
    """

    steps: tuple[StepMessage, ...]
    frames: tuple[Frame | None, ...]
    truth: TruthMessage


class RecordingReader:
    """Reads a recorded flight: an iterable of `RecordedChainStep`s, to be iterated over once.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    setup : FlightSetup
    matchset : str
        Version of the package that recorded it.
    form : int
        Format of the recording.

    Raises
    ------
    ValueError
        If the file is no recording, of another format, or damaged; also while iterating.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._reader = McapReader(path)
        self._messages = iter(self._reader)
        first = next(self._messages, None)
        if first is None or first.topic != CONFIGURATION:
            raise ValueError(f"{path} is no recording of a flight: it does not begin with {CONFIGURATION}")
        with _naming(path):
            self.form = self._format(first)
            configuration = _configuration(first.data, self.form)
        self.matchset = configuration.matchset
        parameters = configuration.parameters
        if self.form == WITHOUT_GAINS:
            parameters = _without_gains(parameters)
        followers = parameters.world.vehicles - 1
        if len(configuration.cameras) != followers:
            raise ValueError(f"{path} is damaged: {len(configuration.cameras)} cameras for {followers} followers")
        samples = tuple(self._sample(number) for number in range(1, followers + 1))
        with _naming(path):
            self.setup = FlightSetup(
                parameters,
                configuration.cameras,
                samples,
                kind=configuration.kind,
                colors=tuple(map(colors_of, configuration.colors)),
                countdown=configuration.countdown,
                fps=configuration.fps,
                devices=configuration.devices,
            )
        if len(configuration.colors) not in (0, followers):
            raise ValueError(f"{path} is damaged: {len(configuration.colors)} colors for {followers} followers")

    @property
    def cut_off(self) -> bool:
        """Whether the file ends in the middle; known after the last step."""
        return self._reader.cut_off

    @property
    def damaged(self) -> list[DamagedChunk]:
        """Stretches that are left out so far, since they cannot be read."""
        return self._reader.damaged

    def __iter__(self) -> Iterator[RecordedChainStep]:
        damaged, torn = 0, False
        steps: dict[int, StepMessage] = {}
        pictures: dict[int, bytes] = {}
        numbers = range(1, self.setup.followers + 1)
        of_step = {step_topic(number): number for number in numbers}
        of_picture = {image_topic(number): number for number in numbers}
        for topic, data in self._messages:
            chain_step = None
            # The step in which the damage begins, and that in which it ends, lack something.
            if len(self.damaged) > damaged:
                damaged, torn, steps, pictures = len(self.damaged), True, {}, {}
            with _naming(self.path):
                if topic in of_picture:
                    pictures[of_picture[topic]] = data
                elif topic in of_step:
                    steps[of_step[topic]] = decode(data, StepMessage)
                elif topic == TRUTH:
                    truth = decode(data, TruthMessage)
                    if not torn or self._is_whole(steps, pictures, truth):
                        chain_step = self._chain_step(steps, pictures, truth)
                    torn, steps, pictures = False, {}, {}
            if chain_step is not None:  # outside of the `with` block: an error of the caller is not about the file
                yield chain_step

    def _is_whole(self, steps: dict[int, StepMessage], pictures: dict[int, bytes], truth: TruthMessage) -> bool:
        """Whether a step lacks nothing."""
        numbers = range(1, self.setup.followers + 1)
        there = all(number in steps and steps[number].tick == truth.index for number in numbers)
        return there and all((steps[number].frame is None) == (number not in pictures) for number in numbers)

    def _chain_step(
        self, steps: dict[int, StepMessage], pictures: dict[int, bytes], truth: TruthMessage
    ) -> RecordedChainStep:
        """Put a step together and check that nothing is missing."""
        count = self.setup.followers
        frames: list[Frame | None] = []
        for number in range(1, count + 1):
            step = steps.get(number)
            if step is None or step.tick != truth.index:
                raise ValueError(f"tick {truth.index} lacks the step of follower {number}")
            frames.append(_frame(number, step, pictures.get(number)))
        known = count + 1 if self.setup.has_truth else 0
        if not len(truth.shown) == len(truth.truth) == known or not len(truth.places) == len(truth.inside) == count:
            raise ValueError(f"the truth of tick {truth.index} is of another number of vehicles")
        return RecordedChainStep(tuple(steps[number] for number in range(1, count + 1)), tuple(frames), truth)

    def _format(self, first: RecordedMessage) -> int:
        head = decode(first.data, _FormatHeader)
        if head.format not in (WITHOUT_GAINS, OLDER_NAMES, FORMAT):
            raise ValueError(f"its format is {head.format}, this matchset reads {WITHOUT_GAINS} to {FORMAT}")
        return head.format

    def _sample(self, number: int) -> Frame:
        message = next(self._messages, None)
        if message is None or message.topic != sample_topic(number):
            raise ValueError(f"{self.path} is damaged: {sample_topic(number)} is missing")
        with _naming(self.path):
            return frame_of(decode(message.data, Picture))


def _configuration(data: bytes, form: int) -> Configuration:
    """Decode the first message; up to format 3 parameters have older names."""
    if form > OLDER_NAMES:
        return decode(data, Configuration)
    content = decode(data, dict)
    content["parameters"], _ = with_newer_keys(content["parameters"], FlightParameters)
    return decode(encode(content), Configuration)


def _without_gains(parameters: FlightParameters) -> FlightParameters:
    """Return the parameters of a flight in which no gains were lowered."""
    replace, pilot, follower = msgspec.structs.replace, parameters.pilot, parameters.pilot.follower
    follower = replace(follower, stability=replace(follower.stability, enabled=False))
    return replace(parameters, pilot=replace(pilot, follower=follower))


def _frame(number: int, step: StepMessage, picture: bytes | None) -> Frame | None:
    """Make the frame of a step; ValueError if its picture is missing, or there is one of no step."""
    if picture is None and step.frame is None:
        return None
    if picture is None or step.frame is None or step.taken is None:
        raise ValueError(f"tick {step.tick} lacks the picture of follower {number}")
    return frame_of_image(picture, step.frame, step.taken, step.rows)


@contextlib.contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Put the file's name before an error."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{path} is damaged: {error}") from None
