"""Vehicles that nobody measured, identified, then flown: `python -m benchmarks.flight.identify`.

Each seed draws a vehicle and a latency that nobody is told. It is flown carefully before a ball that hangs still,
without pictures unless `--rendered`, and identified from the log. Then a chain of three of such vehicles is flown
behind the swinging rope, once told nothing and once by the file of settings that came out. docs/flight.md has the
table; tuned was on seeds below 100, these are 110 and up.
"""

import datetime
import math
import tempfile
from pathlib import Path
from typing import Annotated, NamedTuple

import msgspec
import numpy as np
import typer

from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread
from matchset.flight.chain.config import read_flight, with_world
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore
from matchset.flight.identify.estimate import VehicleEstimate, estimate
from matchset.flight.identify.flight_log import LoggedStep, StickLog
from matchset.flight.identify.parameters import IdentifyParameters, careful
from matchset.flight.identify.vehicle_file import vehicle_toml
from matchset.flight.identify.verdict import findings
from matchset.flight.simulate.flights import fly_once
from matchset.flight.simulate.variation import changed, parse_vary
from matchset.sim.world import RATE

DRAWN = (
    "thrust=0.8..1.2,mass=0.8..1.2,full_tilt=0.8..1.2,full_yaw_rate=0.8..1.2,motor_lag=0.8..1.2,attitude_lag=0.8..1.2,"
    "yaw_lag=0.8..1.2,roll_trim_deg=-3..3,pitch_trim_deg=-3..3,yaw_trim_deg_s=-8..8,battery_loss_per_min=0..0.2,"
    "latency_ms=33..200"
)


class Flown(NamedTuple):
    """A flight to identify a vehicle by.

    Attributes
    ----------
    log : StickLog
    truth : dict
        Of the vehicle, by the names of `VehicleValues`.
    ended : str
        Why before its time; empty if it did not.
    """

    log: StickLog
    truth: dict[str, float]
    ended: str


def drawn_flight(seed: int, vary: str = DRAWN, duration: float = 10.0, **world: float) -> FlightParameters:
    """Return a flight of a drawn vehicle before a ball that hangs still, without pictures."""
    flight = with_world(FlightParameters(duration=duration), vehicles=2, quick=True, seed=seed, swing=0.0, yaw_deg=0.0)
    values = {axis.name: axis.drawn(seed) for axis in parse_vary(vary)} if vary else {}
    return changed(flight, values | world)


def flown(flight: FlightParameters, parameters: IdentifyParameters | None = None) -> Flown:
    """Fly carefully, and keep the log."""
    parameters = parameters or IdentifyParameters()
    steps, ended = [], ""
    with Flight(careful(flight, parameters)) as flying:
        for step in flying:
            steps.append(LoggedStep.of(step.steps[0]))
            if step.crashes or step.down:
                ended = step.crashes[0].description if step.crashes else step.steps[0].safety.reason
                break
        log = StickLog.of(steps, parameters.airborne)
        return Flown(log, truth(flying, flying.chain.now()), ended)


def truth(flight: Flight, now: float) -> dict[str, float]:
    """Return what is true of the first vehicle; the step before a command arrives is flown by it."""
    world, parameters = flight.chain.world, flight.parameters.world
    motion, vehicle, conditions = world.motion, world.vehicle, parameters.conditions
    electronics, told = motion.electronics, parameters.vehicle
    used = float(motion.battery_age[0]) + now
    left = 1.0 - electronics.battery_sag * min(used / electronics.flight_time, 1.0) - electronics.battery_loss * now
    untold = 0.0 if conditions.told_latency_ms is None else parameters.latency_ms - conditions.told_latency_ms
    return {
        "delay": (round(vehicle.radio_delay * RATE) - 1) / RATE + 1e-3 * untold,
        "hover_throttle": vehicle.mass / (conditions.full_thrust(told) * left),
        "full_tilt": float(electronics.full_tilt),
        "full_yaw_rate": float(electronics.full_yaw_rate),
        "yaw_lag": 1.0 / float(motion.vehicle.yaw_gain),
        "yaw_trim": float(electronics.yaw_trim),
        "effective_mass_ratio": vehicle.moved_mass / vehicle.mass,
        "sag": (electronics.battery_sag / electronics.flight_time + electronics.battery_loss) / left,
        "roll_trim": float(motion.level_bias[0, 0]),
        "pitch_trim": float(motion.level_bias[0, 1]),
    }


RELATIVE = ("hover_throttle", "full_yaw_rate", "full_tilt", "yaw_lag", "effective_mass_ratio")
SHOWN = (*RELATIVE, "delay", "yaw_trim", "roll_trim", "pitch_trim", "sag")


def error(name: str, found: VehicleEstimate, true: dict[str, float]) -> float:
    """Error of a number: a share of the truth, or in its unit."""
    off = float(getattr(found.values, name)) - true[name]
    return off / true[name] if name in RELATIVE else off


def flown_by(
    flight: FlightParameters, found: VehicleEstimate, log: StickLog, duration: float
) -> tuple[FlightScore, FlightScore]:
    """Fly a chain of three of such vehicles, told nothing, and by what was identified."""
    parameters = IdentifyParameters()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "vehicle.toml"
        words = vehicle_toml(findings(found, log, parameters), "a benchmark", datetime.date(2026, 11, 23), parameters)
        path.write_text(words, encoding="utf-8")
        told = read_flight(path).pilot
    chain = with_world(flight, vehicles=3, quick=True, swing=0.1, yaw_deg=20.0)
    chain = msgspec.structs.replace(chain, duration=duration)
    return fly_once(chain), fly_once(msgspec.structs.replace(chain, pilot=told))


def scored(score: FlightScore) -> str:
    """Write what became of a flight: whole, and its worst axis, or when it ended."""
    return f"{100.0 * max(map(max, score.spread)):.1f} cm" if score.survived else f"falls after {score.end:.0f} s"


def table(errors: list[VehicleEstimate], truths: list[dict[str, float]]) -> str:
    """Write errors and how they compare with their standard deviations, as Markdown."""
    lines = [
        "| number | rms error | largest | in standard deviations, rms | largest |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for name in SHOWN:
        off = np.array([error(name, found, true) for found, true in zip(errors, truths, strict=True)])
        pairs = zip(errors, truths, strict=True)
        normalized = np.array([(getattr(f.values, name) - t[name]) / getattr(f.sigmas, name) for f, t in pairs])
        scale, unit = (100.0, "%") if name in RELATIVE else (1e3, "ms") if name == "delay" else (100.0, "%/s")
        if name.endswith("trim"):
            scale, unit = math.degrees(1.0), "degrees/s" if name == "yaw_trim" else "degrees"
        cells = (f"{scale * math.sqrt((off**2).mean()):.2f} {unit}", f"{scale * np.abs(off).max():.2f} {unit}")
        sigmas = f"{math.sqrt((normalized**2).mean()):.2f}", f"{np.abs(normalized).max():.1f}"
        lines.append(f"| `{name}` | {' | '.join((*cells, *sigmas))} |")
    return "\n".join(lines)


def main(
    seeds: Annotated[str, typer.Option(help="Seeds: 110-129 or 110,115.")] = "110-129",
    duration: Annotated[float, typer.Option(help="Length of the flight that identifies, s.")] = 10.0,
    fly: Annotated[float, typer.Option(help="Length of the flights after, s; 0: none.")] = 0.0,
    rendered: Annotated[bool, typer.Option("--rendered", help="Identify by rendered pictures.")] = False,
) -> None:
    """Identify drawn vehicles, and fly them."""
    one_thread()
    found: list[VehicleEstimate] = []
    truths: list[dict[str, float]] = []
    for seed in parse_seeds(seeds):
        parameters = drawn_flight(seed, duration=duration)
        flight = flown(with_world(parameters, quick=not rendered))
        if flight.ended:
            print(f"seed {seed}: hover {flight.truth['hover_throttle']:.2f}, came down: {flight.ended}", flush=True)
            continue
        result = estimate(flight.log)
        found.append(result)
        truths.append(flight.truth)
        words = f"seed {seed}: latency {parameters.world.latency_ms:.0f} ms, hover {flight.truth['hover_throttle']:.2f}"
        off = ", ".join(f"{name} {100.0 * error(name, result, flight.truth):+.2f} %" for name in RELATIVE[:3])
        words += f": {off}, delay {1e3 * error('delay', result, flight.truth):+.1f} ms"
        if fly > 0.0:
            words += "; told nothing {}, identified {}".format(
                *map(scored, flown_by(parameters, result, flight.log, fly))
            )
        print(words, flush=True)
    print(table(found, truths))


if __name__ == "__main__":
    typer.run(main)
