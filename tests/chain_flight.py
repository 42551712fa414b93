"""A short flight of a chain of three, and steps made of it: for the tests of all that reads `ChainStep`s."""

import math
from typing import NamedTuple

import msgspec
import numpy as np

from matchset.control.command import Command
from matchset.control.safety import SafetyState
from matchset.flight.chain.chain_step import ChainStep, Crash, FlightKind, FlightSetup
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import PilotStep
from matchset.links.simulation_parameters import SimulationParameters
from matchset.tracking.track import Lost

DURATION, CABLE = 0.7, 0.5
"""s; the cables are pulled before the end, so that some steps lack pictures."""
SEED = 11


class Flown(NamedTuple):
    """A flight and what is true for all of it."""

    setup: FlightSetup
    chain_steps: tuple[ChainStep, ...]


def fly() -> Flown:
    """Fly it."""
    world = SimulationParameters(vehicles=3, seed=SEED, cable=CABLE)
    with Flight(FlightParameters(duration=DURATION, together=2, world=world)) as flight:
        return Flown(flight.setup, tuple(flight))


def without_truth(flown: Flown, kind: FlightKind = "flight") -> Flown:
    """Make the same flight one of real vehicles, of which nobody knows where they are."""
    count = flown.setup.followers
    steps = tuple(
        msgspec.structs.replace(
            chain_step,
            truth=(),
            truth_at_exposure=(),
            true_positions=np.full((count, 3), np.nan),
            in_view=tuple(step.frame is not None for step in chain_step.steps),
        )
        for chain_step in flown.chain_steps
    )
    devices = tuple(f"camera {k}, serial:///dev/ttyUSB{k}" for k in range(count))
    return Flown(flown.setup._replace(kind=kind, devices=devices), steps)


def lost(step: PilotStep, reason: str = "covered") -> PilotStep:
    """Make the same step without its ball."""
    ball = Lost(reason, step.now)  # type: ignore[var-annotated]
    safety = SafetyState("holding", "the ball is not seen", step.now, command=step.command)
    return msgspec.structs.replace(step, ball=ball, markers=(), pose=Lost(reason, step.now), safety=safety)


def descending(step: PilotStep) -> PilotStep:
    """Make the same step without control, while the vehicle descends."""
    safety = SafetyState("descending", "no new frame for 0.3 s", step.now, command=Command())
    return msgspec.structs.replace(step, control=None, safety=safety, age=math.inf)


def with_step(chain_step: ChainStep, number: int, step: PilotStep) -> ChainStep:
    """Put another step of a follower, from 0, into a step of the chain."""
    steps = list(chain_step.steps)
    steps[number] = step
    return msgspec.structs.replace(chain_step, steps=tuple(steps))


def with_crash(chain_step: ChainStep) -> ChainStep:
    """Let vehicle 1 have hit the floor."""
    return msgspec.structs.replace(chain_step, crashes=(Crash(chain_step.time, 1, "hit the floor"),))
