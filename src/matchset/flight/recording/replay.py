"""A recorded flight through the same `Pilot`s again: `Replay` compares every step with the recorded one."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import msgspec
import numpy as np

from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.flight.recording.devices import RecordedCamera, RecordedLink
from matchset.flight.recording.encoding import outcome_of, vehicle_pose
from matchset.flight.recording.messages import StepMessage
from matchset.flight.recording.reader import RecordedChainStep, RecordingReader
from matchset.image.frame import Frame
from matchset.localization.markers.ball_colors import learn_colors


class StepDifference(NamedTuple):
    """A step of a follower that did not come out as it was recorded.

    Attributes
    ----------
    chain_step : int
    follower : int
        From 1.
    text : str
        The first value that differs: ``pose.position.0 was 0.1, is 0.2``.
    """

    tick: int
    follower: int
    text: str


class Replay:
    """Runs the pilots on a recording: an iterable of `ChainStep`s, with the recorded truth and computing times.

    Parameters
    ----------
    recorded : RecordingReader

    Attributes
    ----------
    steps : int
        Number of steps compared so far: those before the first stretch that cannot be read. What follows it is
        replayed, but must come out otherwise.
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
        colors = setup.colors or [learn_colors(sample) for sample in setup.samples]
        pilot = setup.parameters.loop
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
            truth=tuple(map(vehicle_pose, truth.truth)),
            truth_at_exposure=tuple(map(vehicle_pose, truth.shown)),
            true_positions=np.array(truth.places),
            in_view=truth.inside,
            crashes=truth.crashes,
        )

    def _step(self, number: int, message: StepMessage, frame: Frame | None) -> PilotStep:
        camera, link, pilot = self._cameras[number], self._links[number], self._pilots[number]
        camera.frame, camera.time, link.confirmed = frame, message.now, message.command
        if message.armed and not pilot.armed:
            pilot.arm()
        elif pilot.armed and not message.armed:  # a dry run that begins again
            pilot.armed = False
        if message.landing:
            pilot.land(message.landing)
        if message.stopped:
            pilot.cut(message.stopped)
        step = pilot.step()
        if self._recorded.damaged:
            return msgspec.structs.replace(step, stage_times=message.spent)
        self.steps += 1
        outcome = outcome_of(step, self._recorded.form)
        if outcome != bytes(message.outcome):
            text = first_difference(bytes(message.outcome), outcome)
            self.differences.append(StepDifference(message.tick, number + 1, text))
        return msgspec.structs.replace(step, stage_times=message.spent)


def first_difference(recorded: bytes, replayed: bytes) -> str:
    """Name the first value in which two outcomes differ: ``pose.position.0 was 0.1, is 0.2``.

    Parameters
    ----------
    recorded, replayed : bytes
        Messages `Outcome` in msgpack.
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
    return next((text for text in found if text), "")


def _brief(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
