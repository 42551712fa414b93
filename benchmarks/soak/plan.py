"""What happens in a flight of the soak: `make_plan`, a pure function of the seed and the flight's number."""

import math

import msgspec
import numpy as np

from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.links.simulation_parameters import SimulationParameters

PICTURE_FAULTS = ("frozen", "stale", "dropped", "noise")
KINDS = (*PICTURE_FAULTS, "gust", "hidden", "cable", "silent", "full recorder", "clicks", "armed again")
"""All kinds of faults, as the table counts them."""


class PlanParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How flights of the soak are drawn; all chosen by hand.

    Parameters
    ----------
    shortest, longest : float
        Length of a flight, s.
    longest_recorded : float
        The same of one that is recorded, s: a second takes up to 40 MB of the disk.
    recorded_every : int
        One flight in so many is recorded and replayed.
    most_faults : int
        Of pictures and of air, in a flight.
    longest_fault : float
        s; more than the descent and the ages that safety tolerates, so that some end a flight.
    three : float
        Share of the flights with three vehicles; the others have two.
    clicks : float
        Share of the pictures at which somebody clicks.
    strongest_gust : float
        m/s^2.
    """

    shortest: float = 10.0
    longest: float = 60.0
    longest_recorded: float = 16.0
    recorded_every: int = 6
    most_faults: int = 5
    longest_fault: float = 4.0
    three: float = 0.2
    clicks: float = 0.01
    strongest_gust: float = 3.0


class Fault(msgspec.Struct, frozen=True):
    """Something that goes wrong for a while.

    Parameters
    ----------
    kind : str
        Of `PICTURE_FAULTS`, or "gust".
    start, duration : float
        s.
    strength : tuple of float
        Of a gust: acceleration along x, y and z, m/s^2. Of stale pictures: their age, s, first.
    """

    kind: str
    start: float
    duration: float
    strength: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def acts(self, time: float) -> bool:
        """Whether it acts at a time, s."""
        return self.start <= time < self.start + self.duration


class Plan(msgspec.Struct, frozen=True, kw_only=True):
    """A flight of the soak.

    Parameters
    ----------
    seed, number : int
        What it was made from.
    flight : FlightParameters
    faults : tuple of Fault
    recorded : bool
        Whether it is recorded and replayed.
    room : float
        Size at which the recording's disk is full, MB; inf for never.
    armings : int
        How often somebody arms the pilots again after their motors were stopped.
    """

    seed: int
    number: int
    flight: FlightParameters
    faults: tuple[Fault, ...] = ()
    recorded: bool = False
    room: float = math.inf
    armings: int = 0

    def count(self) -> dict[str, int]:
        """How often each kind of fault is planned."""
        world = self.flight.world
        counted = {kind: sum(fault.kind == kind for fault in self.faults) for kind in (*PICTURE_FAULTS, "gust")}
        return counted | {
            "hidden": int(world.hidden > 0.0),
            "cable": int(world.cable < self.flight.duration),
            "silent": int(world.silent < self.flight.duration),
            "full recorder": int(self.room < math.inf),
        }


def make_plan(seed: int, number: int, parameters: PlanParameters | None = None) -> Plan:
    """Draw a flight.

    Parameters
    ----------
    seed : int
        Of the soak.
    number : int
        Of the flight, from 0.
    parameters : PlanParameters, optional
    """
    limits = parameters or PlanParameters()
    rng = np.random.default_rng((seed, number, 0x50AC))
    recorded = number % limits.recorded_every == 0
    longest = limits.longest_recorded if recorded else limits.longest
    duration = round(float(rng.uniform(min(limits.shortest, longest), longest)), 2)
    flight = FlightParameters(duration=duration, world=_world(rng, duration, limits))
    return Plan(
        seed=seed,
        number=number,
        flight=flight,
        faults=tuple(_fault(rng, duration, limits) for _ in range(int(rng.integers(0, limits.most_faults + 1)))),
        recorded=recorded,
        room=float(rng.uniform(5.0, 60.0)) if recorded and number // limits.recorded_every % 2 else math.inf,
        armings=0 if recorded or rng.random() < 0.5 else int(rng.integers(1, 3)),
    )


def _world(rng: np.random.Generator, duration: float, limits: PlanParameters) -> SimulationParameters:
    def when(share: float) -> float:
        at = float(rng.uniform(0.0, duration))
        return at if rng.random() < share else math.inf

    wide = rng.random() < 0.5
    return SimulationParameters(
        vehicles=3 if rng.random() < limits.three else 2,
        seed=int(rng.integers(0, 2**31)),
        pal=("clean", "typical", "bad")[int(rng.integers(0, 3))],
        latency_ms=float(rng.uniform(20.0, 130.0)),
        start_off=float(rng.uniform(0.0, 0.4)),
        hidden=float(rng.uniform(0.1, 2.0)) if rng.random() < 0.3 else 0.0,
        hidden_every=float(rng.uniform(3.0, 10.0)),
        cable=when(0.15),
        silent=when(0.2),
        silent_for=float(rng.uniform(0.05, 1.0)),
        width=640 if wide else 320,
        height=480 if wide else 240,
    )


def _fault(rng: np.random.Generator, duration: float, limits: PlanParameters) -> Fault:
    kind = ("gust", *PICTURE_FAULTS)[int(rng.integers(0, 1 + len(PICTURE_FAULTS)))]
    start = float(rng.uniform(0.0, duration))
    lasting = float(limits.longest_fault * rng.random() ** 2)  # most are short
    strength = rng.uniform(-limits.strongest_gust, limits.strongest_gust, 3).tolist()
    if kind == "stale":
        strength[0] = float(rng.uniform(0.1, 1.0))
    return Fault(kind, start, lasting, (strength[0], strength[1], strength[2]))
