"""Flies a fleet in a thread, whatever happens to pages: `FlightLoop`."""

import math
import threading
import time
from collections.abc import Callable

import msgspec

from matchset.control.safety import AIRBORNE
from matchset.flight.chain.score import FollowerCounters
from matchset.flight.real_time.memory import steady_memory
from matchset.image.errors import LinkError
from matchset.live.feed import News
from matchset.live.piloting.commander import FLYING, IN_FLIGHT, Commander, SilenceParameters
from matchset.live.piloting.fleet import Fleet, FleetStep
from matchset.live.piloting.follower_stream import FollowerStream
from matchset.live.piloting.shared_commander import SharedCommander
from matchset.live.piloting.state import FlightState, follower_states, map_state
from matchset.media.closing import Closing
from matchset.numeric.compiling import WATCHERS

KEPT = 64  # format: pictures whose time is remembered, two seconds: what a page painted before that is old


class Stopping(msgspec.Struct):
    """How long it took to stop the motors, on the clock of the pictures.

    Parameters
    ----------
    ordered : float
        When it was ordered, s; NaN if it was not.
    delay : float or None
        Until the commands that did, s.
    """

    ordered: float = math.nan
    delay: float | None = None

    def note(self, step: FleetStep) -> None:
        """Look whether a step was the first in which all motors were off."""
        if self.delay is None and all(not each.command.throttle for each in step.steps):
            self.delay = step.time - self.ordered if math.isfinite(self.ordered) else None


class FlightLoop(Closing):
    """Opens a fleet and takes its steps; arms, lands and stops its pilots as the `Commander` says.

    A page changes the commander only. Stopping the motors does not wait for the loop: the links are told in the thread
    of the server, and again before the next command.

    Parameters
    ----------
    followers : int
        How many the fleet has.
    open_fleet : callable
        Returns a fleet with everybody at the start; called again for another flight.
    news : callable, optional
        Told of each picture.
    silence : SilenceParameters, optional
    clock : callable
        s, never backward.

    Attributes
    ----------
    commander : SharedCommander
    streams : tuple of FollowerStream
    """

    def __init__(
        self,
        followers: int,
        open_fleet: Callable[[], Fleet],
        news: News | None = None,
        silence: SilenceParameters | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.commander, self._open, self._news = SharedCommander(silence, clock), open_fleet, news or (lambda _: None)
        self._clock = clock
        self.streams = tuple(FollowerStream(number) for number in range(followers))
        self._fleet: Fleet | None = None
        self._sequence, self._times = 0, [math.nan] * KEPT
        self._step, self._begun = FleetStep(0.0, ()), math.nan
        self._stopping, self._state = Stopping(), FlightState()
        self._kernels, self._preparing = 0, self._clock()
        self._stop, self._again = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="matchset flight", daemon=True)
        self._thread.start()

    def alive(self, page: str, sequence: int) -> None:
        """Hear a page that has painted a picture."""
        kept = 0 <= self._sequence - sequence < KEPT
        painted = self._times[sequence % KEPT] if kept else math.nan
        self.commander.change(lambda commander, now: commander.alive(page, now, painted))

    def arm(self, page: str) -> None:
        """Let a page take off and command.

        Raises
        ------
        ValueError
            If it cannot: nothing is ready, or somebody flies already.
        """
        here = self.commander.look()
        if not page:
            raise ValueError("arm: who arms must stay: a page, or a program over /ws that says it is alive")
        if here.duty in IN_FLIGHT:
            raise ValueError(f"arm: {here.page} commands")
        if here.duty == "stopped":
            raise ValueError(f"arm: the motors were stopped ({here.reason}): put everybody back first")
        if not self._state.ready:
            raise ValueError("arm: not ready yet")
        self._stopping = Stopping()
        self.commander.change(lambda commander, now: commander.arm(page, now))

    def land(self, page: str) -> None:
        """Begin the descent.

        Raises
        ------
        ValueError
            If another page commands, or nobody flies.
        """
        here = self.commander.look()
        if here.duty in FLYING and page != here.page:
            raise ValueError(f"land: {here.page} commands; any page may stop the motors")
        if here.duty not in IN_FLIGHT:
            raise ValueError("land: nobody flies")
        self.commander.change(lambda commander, _: commander.land(page))

    def kill(self, who: str) -> None:
        """Stop all motors with the next packet; never waits."""
        reason = f"{who} stopped the motors"
        if self.commander.look().duty != "stopped":
            self._stopping = Stopping(self._step.time)
        self.commander.change(lambda commander, _: commander.kill(reason))
        if self._fleet is not None:
            self._fleet.cut(reason)

    def again(self) -> None:
        """Put everybody back at the start, for another flight; arms nobody.

        Raises
        ------
        ValueError
            If somebody flies, or everybody is there.
        """
        here, state = self.commander.look(), self._state
        if here.duty in IN_FLIGHT:
            raise ValueError(f"again: {here.page} commands a flight: land first")
        if here.duty == "idle" or not (state.ready or state.fault):
            raise ValueError("again: everybody is at the start, or soon will be")
        self._again.set()

    def state(self) -> FlightState:
        """Return what there is to say, of now."""
        here, state = self.commander.look(), self._state
        silent = self._clock() - here.heard if here.duty in FLYING else 0.0
        preparing = 0.0 if state.ready or state.fault else self._clock() - self._preparing
        return msgspec.structs.replace(
            state,
            duty=here.duty,
            page=here.page,
            silent=round(silent, 1),
            reason=here.reason,
            stop_delay=self._stopping.delay,
            kernels=0 if state.ready else self._kernels,
            preparing=float(int(preparing)),
        )

    def close(self) -> None:
        """Land everybody, and end the thread."""
        self._stop.set()
        self._again.set()
        self._thread.join()

    def _run(self) -> None:
        try:
            self._fly_all()
        finally:  # also where the program itself is wrong: everybody has landed, and pages say so
            self._fault("the flight has ended")

    def _fly_all(self) -> None:
        while not self._stop.is_set():
            self._again.clear()
            self._state = FlightState()
            self._kernels, self._preparing = 0, self._clock()
            self._news_of("getting ready ...")
            try:
                with self._opened() as fleet, steady_memory():
                    self.commander.change(lambda commander, _: commander.again())
                    self._fly(fleet)
            except (LinkError, ValueError) as error:
                self._fault(str(error))
                if not self._stop.is_set():
                    self._again.wait()
            finally:
                self._fleet = None

    def _opened(self) -> Fleet:
        """Return the fleet; counts what is compiled for it meanwhile."""
        WATCHERS.append(self._count_kernel)
        try:
            return self._open()
        finally:
            WATCHERS.remove(self._count_kernel)

    def _count_kernel(self) -> None:
        self._kernels += 1

    def _fault(self, words: str) -> None:
        """Say why nothing can be flown any more; the fleet has landed as far as it can."""
        self._fleet = None
        self.commander.change(lambda commander, _: commander.kill(words))
        self._state = FlightState(fault=words)
        self._news_of(words)

    def _news_of(self, fault: str) -> None:
        """Show the last pictures, and what is wrong with them."""
        self._sequence += 1
        for number, stream in enumerate(self.streams):
            stream.fail(fault, self._sequence)
            self._news(number)

    def _fly(self, fleet: Fleet) -> None:
        counters = [FollowerCounters() for _ in fleet.pilots]
        self._fleet, self._begun, self._step = fleet, math.nan, FleetStep(0.0, ())
        while not (self._stop.is_set() or self._again.is_set()):
            self._command(fleet)
            step = fleet.step()
            self._judge(step)
            self._show(fleet, step, counters)

    def _command(self, fleet: Fleet) -> None:
        """Do what the commander says, before the next commands leave."""
        here = self.commander.look()
        if here.duty == "flying":
            self._begun = self._step.time if math.isnan(self._begun) else self._begun
            fleet.arm(fleet.due(self._step.time - self._begun))
            here = self.commander.look()
        if here.duty == "descending":
            for pilot in fleet.pilots:
                pilot.land(here.reason)
        elif here.duty == "stopped":  # once more, for one that was just being armed
            for pilot in fleet.pilots:
                if not pilot.killed:
                    pilot.cut(here.reason)

    def _judge(self, step: FleetStep) -> None:
        """Let a crash end the flight, and note when nobody flies any more."""
        self._step = step
        self._stopping.note(step)
        phases = [each.safety.phase for each in step.steps]
        if step.crashes:
            self.commander.change(lambda commander, _: commander.end(step.crashes[0]))
        here: Commander = self.commander.look()
        if any(phase in AIRBORNE for phase in phases) or math.isnan(self._begun):
            return
        reasons = [each.safety.reason for each in step.steps if each.safety.phase == "cut"]
        if reasons or here.duty == "descending":
            self.commander.change(lambda commander, _: commander.down(next(iter(reasons), "")))

    def _show(self, fleet: Fleet, step: FleetStep, counters: list[FollowerCounters]) -> None:
        self._sequence += 1
        self._times[self._sequence % KEPT] = self._clock()
        place = fleet.pilots[0].parameters.place
        for each, counter in zip(step.steps, counters, strict=True):
            counter.add(each)
        self._state = FlightState(
            ready=True,
            time=0.0 if math.isnan(self._begun) else round(step.time - self._begun, 1),
            followers=follower_states(step.steps, counters, place),
            map=map_state(step, place),
        )
        for stream, each, counter, pilot in zip(self.streams, step.steps, counters, fleet.pilots, strict=True):
            stream.show(each, self._sequence, counter.rate, pilot)
            self._news(stream.number)
