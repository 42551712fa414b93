"""One flight of the soak, checked at every step: `fly`."""

import contextlib
import math
import time
from array import array
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np

from benchmarks.soak.clicked import ClickedTracker
from benchmarks.soak.faults import FaultyCamera, blow, limited_files
from benchmarks.soak.invariants import InvariantParameters, Rules, Seen, violation
from benchmarks.soak.plan import Plan
from benchmarks.soak.replayed import replay
from matchset.app.disk import UnfinishedFileError
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.fly.outputs import FlightOutputs
from matchset.numeric.record import fields
from matchset.sim.quadrotor import STATE
from matchset.sim.world import RATE, World
from matchset.tracking.track import Track


class SoakParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How flights of the soak are flown; all chosen by hand.

    Parameters
    ----------
    clicks : float
        Share of the pictures at which somebody clicks.
    after_end : float
        How long a flight goes on after everyone's motors were stopped, and after how long somebody arms again, s.
    limits : InvariantParameters
    """

    clicks: float = 0.01
    after_end: float = 1.5
    limits: InvariantParameters = InvariantParameters()


class Violation(NamedTuple):
    """The first thing that went wrong in a flight.

    Attributes
    ----------
    seed, flight, step : int
        Where: repeat it by `--seed` and `--flight`.
    what : str
    """

    seed: int
    flight: int
    step: int
    what: str


class Flown(msgspec.Struct):
    """What a flight has shown.

    Parameters
    ----------
    simulated, took : float
        Its length in simulated time and on the clock, s.
    steps : int
        Of all pilots together.
    tracks : int
        Steps with a confirmed ball.
    replayed : int
        Steps of the chain that were recorded and replayed.
    clicks : int
    crashes : int
    ends : Counter of str
        Why motors were stopped.
    elapsed, computed : array of float
        Of each update of the clicked tracker, time on the clock and of the thread, s.
    violation : Violation or None
    """

    simulated: float = 0.0
    took: float = 0.0
    steps: int = 0
    tracks: int = 0
    replayed: int = 0
    clicks: int = 0
    armings: int = 0
    crashes: int = 0
    full: int = 0
    ends: Counter[str] = msgspec.field(default_factory=Counter)
    elapsed: "array[float]" = msgspec.field(default_factory=lambda: array("d"))
    computed: "array[float]" = msgspec.field(default_factory=lambda: array("d"))
    violation: Violation | None = None


class _Watch:
    """Sees the steps of one pilot and what its vehicle does."""

    def __init__(self, pilot: Pilot, who: int, world: World, rules: Rules) -> None:
        assert isinstance(pilot.camera, FaultyCamera)
        self._pilot, self._camera, self._who, self._world, self._rules = pilot, pilot.camera, who, world, rules
        self.armed_again = False
        self.before: Seen | None = None

    def look(self, chain_step: ChainStep) -> str:
        """Say what is wrong with the step; empty if nothing is."""
        before, step = self.before or Seen(chain_step.steps[self._who], False), chain_step.steps[self._who]
        world, who = self._world, self._who
        refuses = self._pilot.armed and bool(self._pilot.link.status().refusal)
        stopped = step.command.throttle == 0.0
        crashed = any(vehicle == who for _, vehicle, _ in world.crashes)
        seen = Seen(
            step=step,
            armed=self._pilot.armed,
            armed_again=self.armed_again,
            refused=min(before.refused, step.now) if refuses else math.inf,
            picture=step.frame.time if step.frame is not None else before.picture,
            confirmed=step.ball.time if isinstance(step.ball, Track) else before.confirmed,
            stopped=min(before.stopped, step.now) if stopped else math.inf,
            throttle=float(world.motion.sticks[who, 3]),
            silent=(world.step - int(world.motion.heard[who])) / RATE,
            thrust=0.0 if crashed or world.motion.held[who] else float(fields(world.states[who], STATE).thrust),
            fault=self._camera.fault,
            frozen=self._frozen(before, step),
            hover=self._pilot._follower.hover_throttle,
        )
        wrong = violation(self.before, seen, self._rules)
        self.before, self.armed_again = seen, False
        return wrong

    def _frozen(self, before: Seen, step: PilotStep) -> float:
        """Since when the camera repeats its last picture, s."""
        if step.frame is None:
            return before.frozen
        return min(before.frozen, step.frame.time) if self._camera.fault == "frozen" else math.inf

    def arm(self) -> None:
        """Arm the pilot again."""
        self._pilot.arm()
        self.armed_again = True


class _Soaked:
    """A flight and all who watch it."""

    def __init__(self, plan: Plan, flight: Flight, parameters: SoakParameters) -> None:
        self._plan, self._flight, self._parameters = plan, flight, parameters
        rules = Rules(plan.flight.pilot.safety, _limits_of(plan, parameters))
        self._limits = rules.limits
        self._watches, self._clicked = [], []
        for who, (pilot, colors) in enumerate(zip(flight.pilots, flight.colors, strict=True)):
            seed = (plan.seed, plan.number, who)
            pilot.camera = FaultyCamera(pilot.camera, plan.faults, (*seed, 1))
            target = plan.flight.pilot.target
            self._watches.append(_Watch(pilot, who, flight.chain.world, rules))
            self._clicked.append(
                ClickedTracker(tuple(colors), pilot.camera.model, target, parameters.clicks, (*seed, 2))  # type: ignore[arg-type]
            )
        self._left, self._down, self._blown = plan.armings, math.inf, 0.0
        self.flown = Flown()

    def look(self, chain_step: ChainStep) -> str:
        """Check a step and let the faults of the next act; says what is wrong, empty if nothing is."""
        flown = self.flown
        flown.simulated = chain_step.time
        for watch, clicked, step in zip(self._watches, self._clicked, chain_step.steps, strict=True):
            flown.steps += 1
            flown.tracks += isinstance(step.ball, Track)
            wrong = watch.look(chain_step)
            if not wrong and step.frame is not None:
                assert watch.before is not None
                wrong = clicked.update(step.frame, watch.before.fault, self._limits)
            if wrong:
                return wrong
        blow(self._flight.chain.world, self._plan.faults, self._blown)
        self._blown = chain_step.time
        return ""

    def is_over(self, chain_step: ChainStep) -> bool:
        """Whether the flight has ended before its time; before that somebody may arm again."""
        self._down = min(self._down, chain_step.time) if chain_step.down else math.inf
        if chain_step.time - self._down < self._parameters.after_end:
            return False
        self._count_ends(chain_step)
        if not self._left:
            return True
        self._left -= 1
        self._down = math.inf
        self.flown.armings += 1
        for watch in self._watches:
            watch.arm()
        return False

    def _count_ends(self, chain_step: ChainStep) -> None:
        self.flown.ends.update(step.safety.reason for step in chain_step.steps)

    def finish(self, chain_step: ChainStep | None) -> None:
        """Add up what was counted."""
        for clicked in self._clicked:
            self.flown.clicks += clicked.clicked
            self.flown.elapsed.extend(clicked.elapsed)
            self.flown.computed.extend(clicked.computed)
        self.flown.crashes = 0 if chain_step is None else len(chain_step.crashes)


def fly(plan: Plan, folder: Path, parameters: SoakParameters | None = None) -> Flown:
    """Fly a plan to its end or to the first violation, and replay it if it is recorded.

    Parameters
    ----------
    plan : Plan
    folder : Path
        For the recording, which is removed afterwards.
    parameters : SoakParameters, optional
    """
    begin = time.monotonic()
    path = folder / f"flight_{plan.number}.mcap" if plan.recorded else None
    try:
        flown, index = _fly(plan, path, parameters or SoakParameters())
        if flown.violation is None and path is not None:
            replayed = replay(path, index, not flown.full)
            flown.replayed = replayed.chain_steps
            if replayed.wrong:
                flown.violation = Violation(plan.seed, plan.number, replayed.step, replayed.wrong)
    finally:
        if path is not None:
            path.unlink(missing_ok=True)
    flown.took = time.monotonic() - begin
    return flown


def _fly(plan: Plan, path: Path | None, parameters: SoakParameters) -> tuple[Flown, int]:
    """Fly; returns what was seen, and the number of steps of the chain."""
    wrong, index, chain_step = "", 0, None
    with Flight(plan.flight) as flight:
        soaked = _Soaked(plan, flight, parameters)
        flown = soaked.flown
        try:
            with (
                contextlib.closing(iter(flight)) as chain_steps,  # type: ignore[type-var]
                limited_files(plan.room),
                FlightOutputs(flight.setup, FlightFiles(record=path), quiet=True) as outputs,
            ):
                for chain_step in chain_steps:
                    index = chain_step.index
                    wrong = soaked.look(chain_step)
                    outputs.add(chain_step, [pilot.armed for pilot in flight.pilots])
                    if wrong or soaked.is_over(chain_step):
                        break
        except UnfinishedFileError as error:
            flown.full = 1
            if plan.room == math.inf:
                wrong = wrong or f"recorder: {error}"
        soaked.finish(chain_step)
    if wrong:
        flown.violation = Violation(plan.seed, plan.number, index, wrong)
    return flown, index


def _limits_of(plan: Plan, parameters: SoakParameters) -> InvariantParameters:
    """Put in what the vehicles of this flight are."""
    vehicle = plan.flight.world.vehicle
    return msgspec.structs.replace(
        parameters.limits,
        quantum=2.0 / vehicle.stick_levels,
        radio_delay=vehicle.radio_delay,
        failsafe=vehicle.failsafe,
    )


def quantiles(seconds: "array[float]") -> tuple[float, float, float]:
    """Median, 99.99 % and longest, s; NaN where there is none."""
    if not seconds:
        return math.nan, math.nan, math.nan
    median, high, longest = np.quantile(np.frombuffer(seconds), (0.5, 0.9999, 1.0)).tolist()
    return median, high, longest
