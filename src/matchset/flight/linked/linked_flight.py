"""A flight of real vehicles as an iterable of `ChainStep`s: `LinkedFlight`."""

import time
from collections.abc import Iterator

import numpy as np

from matchset.control.safety import AIRBORNE, Phase
from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.chain.flight import ChainFlight
from matchset.flight.chain.score import FlightScorer
from matchset.flight.linked.briefing import before, taken_off
from matchset.flight.linked.followers import LinkedFollowers
from matchset.flight.real_time.memory import steady_memory
from matchset.image.errors import LinkError


class LinkedFlight(ChainFlight):
    """Real vehicles behind each other, each flown by its own camera and its own link; the order is that of the chain.

    For `LinkedParameters.countdown` nobody is armed. Then everybody flies for the duration, and lands; when one comes
    down before, the others land too. Nothing of the truth is known. In a dry run a pilot that would have come down
    begins again.

    Parameters
    ----------
    followers : LinkedFollowers
    setup : FlightSetup
        Of kind "flight" or "dry run".

    Attributes
    ----------
    longest : float
        The longest time from one step's commands to the next, s: no link heard nothing for longer.
    flown : set of int
        Followers, from 0, whose phase was "flying" at least once.
    in_time : bool
        Whether it landed since its time was over.
    """

    def __init__(self, followers: LinkedFollowers, setup: FlightSetup) -> None:
        self.parameters, self.pilots = setup.parameters, followers.pilots
        self.setup = setup
        self.longest, self.flown, self.in_time = 0.0, set[int](), False
        self._followers, self._index, self._last = followers, 0, 0.0
        self._phases: tuple[Phase, ...] = ()

    def __iter__(self) -> Iterator[ChainStep]:
        """Count down, arm and fly; ends when the time is over, everybody is down, or a device is gone: `fault`."""
        with steady_memory():
            self._followers.begin(time.monotonic())
            try:
                while True:
                    step = self._step()
                    yield step
                    if self._ends(step):
                        return
                    self._command(step)
            except LinkError as error:
                self.fault = str(error)

    def briefing(self, keys: bool) -> Iterator[str]:
        """Say what will be flown with what, what is assumed, and how to stop it."""
        return before(self.setup, self._followers, keys)

    def debriefing(self) -> Iterator[str]:
        """Say how long a link heard nothing, and what a dry run showed."""
        yield f"longest time between two commands: {1e3 * self.longest:.0f} ms"
        if self.setup.kind == "dry run":
            yield f"dry run: no throttle was sent; {taken_off(len(self.pilots), self.flown)}"

    def succeeded(self, scorer: FlightScorer) -> bool:  # noqa: ARG002 - it counts landings as failures
        """Whether everybody took off, and flew to the end; in a dry run, whether everybody would have taken off."""
        return len(self.flown) == len(self.pilots) and (self.setup.kind == "dry run" or self.in_time)

    def land(self, reason: str) -> bool:
        """Bring everybody down by the safety filter's descent; False when nobody is in the air."""
        if self.setup.kind == "dry run":
            return False
        for pilot in self.pilots:
            if not pilot.landing:
                pilot.land(reason)
        return any(phase in AIRBORNE for phase in self._phases)

    def close(self) -> None:
        """Land everybody at once, close links and cameras."""
        self._followers.close()

    def _step(self) -> ChainStep:
        self._index += 1
        steps = self._followers.step()
        now = max(step.now for step in steps)
        if self._index > 1:
            self.longest = max(self.longest, now - self._last)
        self._last = now
        self._phases = tuple(step.safety.phase for step in steps)
        self.flown |= {number for number, step in enumerate(steps) if step.safety.phase == "flying"}
        count = len(steps)
        return ChainStep(
            index=self._index,
            time=now,
            steps=steps,
            truth=(),
            truth_at_exposure=(),
            true_positions=np.full((count, 3), np.nan),
            in_view=tuple(step.frame is not None for step in steps),
            crashes=(),
        )

    def _ends(self, step: ChainStep) -> bool:
        """Whether the flight is over after a step."""
        over = step.down and self.setup.kind == "flight"
        self.fault = self._followers.fault_on_ground(step.steps, patient=not over)
        if self.fault or over:
            return True
        if step.time < self.setup.countdown + self.parameters.duration:
            return False
        self.in_time |= not any(pilot.landing or pilot.killed for pilot in self.pilots)
        return not self.land("its time is over")

    def _command(self, step: ChainStep) -> None:
        """Arm who is due, and bring everybody down when one has come down."""
        past = step.time - self.setup.countdown
        if past < 0.0:
            return
        self._followers.arm(self.parameters.due(self.pilots, past))
        if self.setup.kind == "flight":
            self._followers.land_with(step.steps)
            return
        for pilot, each in zip(self.pilots, step.steps, strict=True):
            if each.safety.phase == "cut" and not pilot.killed:
                pilot.armed, pilot.landing = False, ""  # and armed again after a step, so that a replay knows of it
