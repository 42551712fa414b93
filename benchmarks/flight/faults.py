"""Flights by pictures that are not those of now, and flights without fault: `python -m benchmarks.flight.faults`.

Measures how long it takes from the time stamp of the first bad picture to the first command of a descent, whether the
flights end whole, and how often flights without fault are landed. Tuned on seeds 0 to 9; report on 100 and up.

Whole: nobody touches a wall, the ceiling or another vehicle, and the floor only in or after a descent.
"""

import math
import random
from collections.abc import Callable
from typing import Annotated, Any

import msgspec
import numpy as np
import numpy.typing as npt
import typer
from rich.console import Console

from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread
from matchset.control.repeated_picture import RepeatedPictureParameters
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import PilotParameters
from matchset.flight.chain.score import LANDING_PHASES
from matchset.image.frame import Frame
from matchset.links.simulation_parameters import FPS, SimulationParameters
from matchset.numeric.record import fields
from matchset.sim.quadrotor import STATE
from matchset.sim.world import World

AGE = 0.5  # s, of stale pictures
DROPPED = 0.3  # share of the pictures
WIND = 0.5  # m/s, standard deviation of the gusts
GUST = 1.0  # s, how long one lasts
LANDED = 4.5  # s after a fault; a descent takes 2 s and the fall after it less than 1 s
UNSEEN = PilotParameters(repeated=RepeatedPictureParameters(lines=0))

Floats = npt.NDArray[np.float64]
Change = Callable[[Flight, float], Callable[[], None]]


class Case(msgspec.Struct, frozen=True, kw_only=True):
    """A kind of flight.

    Parameters
    ----------
    words : str
    world : dict
        Fields of `SimulationParameters`.
    fault : str
        Which of its fields is the time of the fault; empty: it is flown without one.
    begin : callable, optional
        Changes a flight; the second argument is the time of the fault, s. What it returns is called before every step.
    pilot : PilotParameters
    """

    words: str
    world: dict[str, Any] = {}
    fault: str = ""
    begin: Change | None = None
    pilot: PilotParameters = PilotParameters()


class Outcome(msgspec.Struct, frozen=True):
    """How a flight ended.

    Parameters
    ----------
    seed : int
    delays : tuple of float
        Of each follower, from the first bad picture to the first command of the descent, s; inf without one.
    broken : str
        What happened to somebody who did not end whole; empty if all did.
    """

    seed: int
    delays: tuple[float, ...]
    broken: str


def late(flight: Flight, when: float) -> Callable[[], None]:
    """Let all cameras stand still for `AGE` and then go on as much too late: a queue before a program that paused."""
    first = math.ceil(when * FPS)

    for camera in flight.chain.cameras:
        pictures: list[Frame] = []

        def read(read: Callable[[], Frame | None] = camera.read, pictures: list[Frame] = pictures) -> Frame | None:
            frame = read()
            if frame is None:
                return None
            pictures.append(frame)
            del pictures[: -2 - round(AGE * FPS)]
            shown = frame.index if frame.index < first else max(first - 1, frame.index - round(AGE * FPS))
            return Frame(pictures[shown - frame.index - 1].image, frame.time, frame.index)

        camera.read = read  # type: ignore[method-assign]
    return lambda: None


def drop(flight: Flight, when: float) -> Callable[[], None]:  # noqa: ARG001
    """Let a share of the pictures not come."""
    chance = random.Random(flight.parameters.world.seed)
    for camera in flight.chain.cameras:

        def read(read: Callable[[], Frame | None] = camera.read) -> Frame | None:
            frame = read()
            return None if chance.random() < DROPPED else frame

        camera.read = read  # type: ignore[method-assign]
    return lambda: None


def blow(flight: Flight, when: float) -> Callable[[], None]:  # noqa: ARG001
    """Let the air move: a first-order Gauss-Markov process at each vehicle."""
    world = flight.chain.world
    rng, wind = np.random.default_rng((flight.parameters.world.seed, 77)), np.zeros((world.parameters.vehicles, 3))
    keep = math.exp(-1.0 / (FPS * GUST))

    def step() -> None:
        wind[:] = keep * wind + WIND * math.sqrt(1.0 - keep * keep) * rng.standard_normal(wind.shape)
        push(world, wind)

    return step


def push(world: World, wind: Floats) -> None:
    """Add what the wind does to the velocities in the time of a picture."""
    vehicle = world.parameters.vehicle
    for who in range(world.parameters.vehicles - 1):
        if not world.motion.held[who] and not world.motion.crashed[who]:
            force = (vehicle.frame_drag + vehicle.ball_area_drag * float(np.linalg.norm(wind[who]))) * wind[who]
            fields(world.states[who], STATE).velocity[:] += force / vehicle.mass / FPS


CASES = {
    "freeze": Case(words="the picture stands still", fault="freeze"),
    "stale": Case(words="pictures 0.5 s old, delivered before", fault="stale"),
    "unseen": Case(words="pictures 0.5 s old, compared by their motion alone", fault="stale", pilot=UNSEEN),
    "late": Case(words="0.5 s still, then 0.5 s late", begin=late, fault="when"),
    "normal": Case(words="no fault"),
    "latency": Case(words="latency of 200 ms, told", world={"latency_ms": 200.0}),
    "gusts": Case(words="gusts of 0.5 m/s", begin=blow),
    "dropped": Case(words="30 % of the pictures do not come", begin=drop),
    "swing": Case(words="rope swings 0.3 m, turns 40 degrees", world={"swing": 0.3, "yaw_deg": 40.0}),
    "hidden": Case(words="ball hidden 0.5 s of every 2 s", world={"hidden": 0.5, "hidden_every": 2.0}),
    "start": Case(words="starts 0.5 m off", world={"start_off": 0.5}),
}


def fly(case: Case, seed: int, duration: float) -> Outcome:
    """Fly one flight; a fault comes at a time between 2 and 8 s that follows from the seed."""
    when = random.Random(seed).uniform(2.0, 8.0)
    world = case.world | ({case.fault: when} if case.fault in SimulationParameters.__struct_fields__ else {})
    parameters = FlightParameters(
        duration=when + LANDED if case.fault else duration,
        world=SimulationParameters(seed=seed, **world),
        pilot=case.pilot,
    )
    first = math.ceil(when * FPS) / FPS if case.fault else 0.0
    delays, broken = [math.inf] * (parameters.world.vehicles - 1), ""
    with Flight(parameters) as flight:
        before = case.begin(flight, when) if case.begin else lambda: None
        steps = iter(flight)
        while True:
            before()
            chain_step = next(steps, None)
            if chain_step is None:
                return Outcome(seed, tuple(delays), broken)
            for who, step in enumerate(chain_step.steps):
                if step.safety.phase == "descending":
                    delays[who] = min(delays[who], step.now - first)
            for crash in chain_step.crashes:
                down = chain_step.steps[crash.vehicle - 1].safety.phase in LANDING_PHASES
                if not (down and crash.what == "hit the floor"):
                    broken = broken or crash.description


def in_words(case: Case, outcomes: list[Outcome]) -> str:
    """Return the row of the table."""
    whole = sum(not each.broken for each in outcomes)
    if not case.fault:
        landed = [each.seed for each in outcomes if min(each.delays) < math.inf]
        alarms = f"{len(landed)} false alarms" + (f" (seeds {', '.join(map(str, landed))})" if landed else "")
        return f"| {case.words} | {whole} of {len(outcomes)} | {alarms} |"
    delays = np.array([delay for each in outcomes for delay in each.delays])
    bad = "; ".join(f"seed {each.seed}: {each.broken}" for each in outcomes if each.broken)
    late = int((delays > 0.3).sum())
    words = f"{np.median(delays):.3f} s (median), {delays.max():.3f} s at worst, {late} of {len(delays)} above 0.3 s"
    return f"| {case.words} | {whole} of {len(outcomes)} | {words}{'; ' + bad if bad else ''} |"


def main(
    seeds: Annotated[str, typer.Option(help="As '100-119' or '0,5'.")] = "100-119",
    only: Annotated[str, typer.Option(help=f"Some of {', '.join(CASES)}.")] = "",
    duration: Annotated[float, typer.Option(help="Of a flight without fault, s.")] = 20.0,
) -> None:
    """Fly every case with every seed and print a table."""
    one_thread()
    print("| what | whole | first bad picture to descent |\n| --- | ---: | --- |", flush=True)
    for name in only.split(",") if only else CASES:
        outcomes = [fly(CASES[name], seed, duration) for seed in parse_seeds(seeds)]
        Console(width=400).print(in_words(CASES[name], outcomes), highlight=False)


if __name__ == "__main__":
    typer.run(main)
