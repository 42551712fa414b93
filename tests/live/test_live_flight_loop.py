"""A flight under pages: who arms, whose silence lands it, what stops the motors; the simulated chain, step by step."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator

import pytest
from fakes import Clock

from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.image.errors import LinkError
from matchset.links.simulation_parameters import FPS, SimulationParameters
from matchset.live.known_messages import READER
from matchset.live.piloting.fleet import Fleet, FleetStep
from matchset.live.piloting.flight_feed import FlightFeed, simulated_flight
from matchset.live.piloting.messages import Alive, Arm, BackToStart, Kill, Land
from matchset.live.piloting.simulated_fleet import SimulatedFleet
from matchset.live.session import Session
from matchset.live.sources.messages import Show
from matchset.numeric.compiling import compiling

WAIT = 60.0  # s, a first flight is compiled
PARAMETERS = FlightParameters(world=SimulationParameters(vehicles=2, seed=5, width=320, height=240))


class Stepped(SimulatedFleet):
    """A fleet whose steps are the time of its clock."""

    def __init__(self, parameters: FlightParameters, clock: Clock) -> None:
        super().__init__(parameters, real_time=False)
        self._clock = clock

    def step(self) -> FleetStep:
        """Take a step."""
        self._clock.sleep(1.0 / FPS)
        return super().step()


class Broken(Stepped):
    """A fleet whose link breaks when it is told."""

    breaks = False

    def step(self) -> FleetStep:
        """Fail, or not."""
        if self.breaks:
            raise LinkError("the cable was pulled")
        return super().step()


class Crashing(Stepped):
    """A fleet that crashes when it is told."""

    crashed: tuple[str, ...] = ()

    def step(self) -> FleetStep:
        """Take a step, with a crash or without."""
        return super().step()._replace(crashes=self.crashed)


class Slow(Stepped):
    """A fleet that compiles three kernels, which takes a second, and waits until it is told."""

    goes_on = threading.Event()

    def __init__(self, parameters: FlightParameters, clock: Clock) -> None:
        for _ in range(3):
            compiling()
        clock.sleep(1.0)
        assert self.goes_on.wait(WAIT)
        super().__init__(parameters, clock)


class Flown:
    """A flight of one follower, and a page that sees all pictures.

    Where a test has waited for something the flight stands still until it waits again: nothing depends on how busy the
    computer is.
    """

    def __init__(self, fleet: type[Stepped] = Stepped) -> None:
        self.fleets, self.clock = list[Fleet](), Clock()
        self._beat: Callable[[], object] = lambda: None
        self._what: Callable[[], object] = lambda: False
        self._reached, self._goes_on, self._lock = threading.Event(), threading.Event(), threading.Lock()

        def open_fleet() -> Fleet:
            self.fleets.append(fleet(PARAMETERS, self.clock))
            return self.fleets[-1]

        self.session = Session()
        self.feed = FlightFeed("sim://chain", 1, open_fleet, self._picture, self.clock)
        self.session.show(self.feed)

    def _picture(self, _: int) -> None:
        """What a page does at each picture, in the thread of the flight."""
        self._beat()
        with self._lock:
            if not self._what():
                return
            self._goes_on.clear()
            self._what = lambda: False
            self._reached.set()
        self._goes_on.wait()

    @property
    def duty(self) -> str:
        return self.feed.loop.state().duty

    @property
    def phase(self) -> str:
        rows = self.feed.loop.state().followers
        return rows[0].phase if rows else ""

    @property
    def shown(self) -> int:
        """The number of the newest picture."""
        return self.feed.streams[0].seen.state.sequence

    def wait(self, what: Callable[[], object], beats: str = "", painted: int | None = None) -> None:
        """Go on until something holds, while a page says that it has painted the newest picture, or one."""

        def beat() -> None:
            self.session.take(Alive(self.shown if painted is None else painted), beats)

        with self._lock:
            self._beat, self._what = beat if beats else lambda: None, what
            self._reached.clear()
            self._goes_on.set()
        assert self._reached.wait(WAIT), (self.duty, self.phase, self.feed.loop.state().reason)

    def fly(self, page: str = "page 1") -> None:
        """Take off."""
        self.wait(lambda: self.feed.loop.state().ready)
        self.session.take(Arm(), page)
        self.wait(lambda: self.phase == "flying" and self.feed.loop.state().time > 0.5, page)

    def close(self) -> None:
        """Close what is shown."""
        with self._lock:
            self._beat, self._what = lambda: None, lambda: False
            self._goes_on.set()
        self.session.close()


@pytest.fixture
def flown() -> Iterator[Flown]:
    with contextlib.closing(Flown()) as flight:
        yield flight


def test_silence_holds_then_descends_and_nobody_flies_again_by_itself(flown: Flown) -> None:
    flown.fly()
    heard = flown.clock.now
    flown.wait(lambda: flown.duty == "holding")
    assert flown.clock.now - heard == pytest.approx(0.3, abs=1.1 / FPS)
    assert flown.phase == "flying"
    flown.wait(lambda: flown.duty == "descending")
    assert flown.clock.now - heard == pytest.approx(1.0, abs=1.1 / FPS)
    flown.wait(lambda: flown.phase == "descending", "page 1")
    flown.wait(lambda: flown.duty == "stopped", "page 1")
    assert flown.feed.loop.state().reason == "page 1 was silent for 1 s"
    with pytest.raises(ValueError, match="put everybody back first"):
        flown.session.take(Arm(), "page 1")
    flown.session.take(BackToStart(), "page 2")
    flown.wait(lambda: flown.duty == "idle" and flown.feed.loop.state().ready)
    assert flown.phase == "locked"
    assert len(flown.fleets) == 2


def test_any_page_stops_the_motors_with_the_next_packet(flown: Flown) -> None:
    flown.fly()
    flown.session.take(Kill(), "page 7")
    flown.wait(lambda: flown.feed.loop.state().stop_delay is not None)
    state = flown.feed.loop.state()
    assert state.stop_delay is not None
    assert state.stop_delay + PARAMETERS.world.vehicle.radio_delay < 0.1
    assert (state.duty, state.page, state.reason) == ("stopped", "", "page 7 stopped the motors")
    assert (state.followers[0].phase, state.followers[0].throttle) == ("cut", 0.0)
    with pytest.raises(ValueError, match="page 7 stopped the motors"):
        flown.session.take(Arm(), "page 1")


def test_one_page_commands_and_others_may_only_stop(flown: Flown) -> None:
    flown.fly()
    state = flown.feed.loop.state()
    assert (state.page, flown.feed.busy) == ("page 1", "page 1 commands a flight: land first")
    for message in (Arm(), Land(), BackToStart(), Show("source-1")):
        with pytest.raises(ValueError, match="page 1 commands"):
            flown.session.take(message, "page 2")
    flown.wait(lambda: flown.duty == "holding", "page 2")
    flown.wait(lambda: flown.duty == "flying", "page 1")
    flown.session.take(Land(), "page 1")
    assert flown.duty == "descending"
    flown.wait(lambda: flown.duty == "stopped", "page 1")
    assert flown.feed.loop.state().reason == "page 1 ended the flight"
    assert flown.feed.loop.state().stop_delay is None


def test_who_cannot_be_heard_cannot_arm(flown: Flown) -> None:
    flown.wait(lambda: flown.feed.loop.state().ready)
    with pytest.raises(ValueError, match="who arms must stay"):
        flown.session.take(Arm(), "")
    with pytest.raises(ValueError, match="nobody flies"):
        flown.session.take(Land(), "page 1")
    with pytest.raises(ValueError, match="everybody is at the start"):
        flown.session.take(BackToStart(), "page 1")
    flown.session.take(READER.read('{"type": "kill"}'), "")
    assert flown.feed.loop.state().reason == "a program stopped the motors"


def test_a_page_that_shows_old_pictures_is_silent(flown: Flown) -> None:
    flown.fly()
    painted, begin = flown.shown, flown.clock.now
    flown.wait(lambda: flown.duty == "descending", "page 1", painted)
    assert flown.clock.now - begin == pytest.approx(0.5 + 1.0, abs=2.1 / FPS)


def test_a_crash_brings_everybody_down() -> None:
    with contextlib.closing(Flown(Crashing)) as flown:
        flown.fly()
        flown.fleets[0].crashed = ("vehicle 1 hit the wall",)  # type: ignore[attr-defined]
        flown.wait(lambda: flown.duty == "descending", "page 1")
        flown.wait(lambda: flown.duty == "stopped", "page 1")
        assert flown.feed.loop.state().reason == "vehicle 1 hit the wall"


def test_a_link_that_breaks_ends_the_flight_and_says_why() -> None:
    with contextlib.closing(Flown(Broken)) as flown:
        flown.fly()
        flown.fleets[0].breaks = True  # type: ignore[attr-defined]
        flown.wait(lambda: flown.feed.loop.state().fault)
        state = flown.feed.loop.state()
        assert (state.duty, state.fault, state.ready) == ("stopped", "the cable was pulled", False)
        assert flown.feed.streams[0].seen.state.fault == "the cable was pulled"
        flown.session.take(BackToStart(), "page 1")
        flown.wait(lambda: flown.duty == "idle" and flown.feed.loop.state().ready)


def test_closing_lands_and_ends_the_thread(flown: Flown) -> None:
    flown.fly()
    flown.close()
    assert not any(thread.name == "matchset flight" for thread in threading.enumerate())
    with pytest.raises(LinkError, match="is closed"):
        flown.fleets[0].pilots[0].link.arm()


def test_a_flight_is_named_by_a_uri() -> None:
    with pytest.raises(ValueError, match="vehicles must be within"):
        simulated_flight("sim://chain?vehicles=99", lambda _: None)


def test_pages_are_told_how_far_it_is_with_getting_ready() -> None:
    with contextlib.closing(Flown(Slow)) as flown:
        until = time.monotonic() + WAIT
        while (state := flown.feed.loop.state()).preparing < 1.0:
            assert time.monotonic() < until
            time.sleep(0.001)
        assert (state.ready, state.kernels) == (False, 3)
        Slow.goes_on.set()
        flown.wait(lambda: flown.feed.loop.state().ready)
        assert (flown.feed.loop.state().kernels, flown.feed.loop.state().preparing) == (0, 0.0)
