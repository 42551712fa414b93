"""A recorded flight, flown again by the same `Pilot`s: `Replay` compares every step with the recorded one."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import msgspec
import numpy as np

from matchset.app.flight.flight import ChainStep
from matchset.app.flight.pilot import Pilot, PilotStep, learn_colors
from matchset.app.recording.devices import RecordedCamera, RecordedLink
from matchset.app.recording.encoding import outcome_of, sight_of
from matchset.app.recording.messages import StepMessage
from matchset.app.recording.reader import RecordedChainStep, RecordingReader
from matchset.image.frame import Frame


class StepDifference(NamedTuple):
    """A step that did not come out as it was recorded.

    Attributes
    ----------
    chain_step : int
    follower : int
        From 1.
    words : str
        The first value that differs: ``pose.position.0 was 0.1, is 0.2``.
    """

    tick: int
    follower: int
    words: str


class Replay:
    """Flies a recording again: an iterable of `ChainStep`s, with the recorded truth and computing times.

    Parameters
    ----------
    recorded : RecordingReader

    Attributes
    ----------
    steps : int
        Compared so far.
    differences : list of StepDifference
        The steps that did not come out bit for bit.
    """

    def __init__(self, recorded: RecordingReader) -> None:
        self._recorded = recorded
        self.steps = 0
        self.differences: list[StepDifference] = []
        setup = recorded.setup
        self._cameras = [RecordedCamera(model) for model in setup.cameras]
        self._links = [RecordedLink(number) for number in range(1, setup.followers + 1)]
        colors = [learn_colors(sample) for sample in setup.samples]
        pilot = setup.parameters.pilot
        self._pilots = [
            Pilot(camera, link, color, pilot)
            for camera, link, color in zip(self._cameras, self._links, colors, strict=True)
        ]

    def __iter__(self) -> Iterator[ChainStep]:
        for recorded in self._recorded:
            yield self._chain_step(recorded)

    def _chain_step(self, recorded: RecordedChainStep) -> ChainStep:
        steps = tuple(
            self._step(number, message, frame)
            for number, (message, frame) in enumerate(zip(recorded.steps, recorded.frames, strict=True))
        )
        truth = recorded.truth
        return ChainStep(
            index=truth.index,
            time=truth.time,
            steps=steps,
            truth=tuple(map(sight_of, truth.truth)),
            truth_at_exposure=tuple(map(sight_of, truth.shown)),
            true_positions=np.array(truth.places),
            in_view=truth.inside,
            crashes=truth.crashes,
        )

    def _step(self, number: int, message: StepMessage, frame: Frame | None) -> PilotStep:
        camera, link, pilot = self._cameras[number], self._links[number], self._pilots[number]
        camera.frame, camera.time, link.confirmed = frame, message.now, message.command
        if message.armed and not pilot.armed:
            pilot.arm()
        step = pilot.step()
        self.steps += 1
        if outcome_of(step) != bytes(message.outcome):
            words = first_difference(bytes(message.outcome), outcome_of(step))
            self.differences.append(StepDifference(message.tick, number + 1, words))
        return msgspec.structs.replace(step, stage_times=message.spent)


def first_difference(recorded: bytes, replayed: bytes) -> str:
    """Name the first value in which two outcomes differ: ``pose.position.0 was 0.1, is 0.2``.

    Parameters
    ----------
    recorded, replayed : bytes
        msgpack.
    """
    try:
        before: Any = msgspec.msgpack.decode(recorded)
    except msgspec.DecodeError:
        return "what was recorded is no message"
    return _differing(before, msgspec.msgpack.decode(replayed), "") or "the bytes differ"


def _differing(before: Any, after: Any, path: str) -> str:
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        pairs = [(str(key), before[key], after[key]) for key in before]
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        pairs = [(str(k), a, b) for k, (a, b) in enumerate(zip(before, after, strict=True))]
    elif msgspec.msgpack.encode(before) == msgspec.msgpack.encode(after):
        return ""
    else:
        return f"{path} was {_brief(before)}, is {_brief(after)}"
    found = (_differing(a, b, f"{path}.{name}" if path else name) for name, a, b in pairs)
    return next((words for words in found if words), "")


def _brief(value: Any) -> str:
    words = repr(value)
    return words if len(words) <= 60 else words[:57] + "..."
