"""A short flight of a chain of three, and ticks made of it: what the tests of everything that reads ticks look at."""

import math
from typing import NamedTuple

import msgspec

from matchset.app.flight.flight import Crash, Flight, FlightParameters, Setting, Tick, setting_of
from matchset.app.flight.pilot import Step
from matchset.control.command import Command
from matchset.control.safety import Memory
from matchset.links.simulated import SimulationParameters
from matchset.tracking.track import Lost

DURATION, CABLE = 0.7, 0.5
"""s; the cables are pulled before the end, so that some ticks lack pictures."""
SEED = 11


class Flown(NamedTuple):
    """A flight and what is true for all of it."""

    setting: Setting
    ticks: tuple[Tick, ...]


def fly() -> Flown:
    """Fly it."""
    world = SimulationParameters(vehicles=3, seed=SEED, cable=CABLE)
    with Flight(FlightParameters(duration=DURATION, world=world)) as flight:
        return Flown(setting_of(flight), tuple(flight))


def lost(step: Step, reason: str = "covered") -> Step:
    """Make the same step without its ball."""
    ball = Lost(reason, step.now)  # type: ignore[var-annotated]
    memory = Memory("holding", "the ball is not seen", step.now, command=step.command)
    return msgspec.structs.replace(step, ball=ball, markers=(), pose=Lost(reason, step.now), memory=memory)


def descending(step: Step) -> Step:
    """Make the same step with no answer and on the way down."""
    memory = Memory("descending", "no new frame for 0.3 s", step.now, command=Command())
    return msgspec.structs.replace(step, answer=None, memory=memory, age=math.inf)


def with_step(tick: Tick, number: int, step: Step) -> Tick:
    """Put another step into a tick, for a follower from 0."""
    steps = list(tick.steps)
    steps[number] = step
    return msgspec.structs.replace(tick, steps=tuple(steps))


def with_crash(tick: Tick) -> Tick:
    """Let vehicle 1 have hit the floor."""
    return msgspec.structs.replace(tick, crashes=(Crash(tick.time, 1, "hit the floor"),))
