"""What is varied in many flights, from the command line to the parameters of each: `Axis`, `FlightCase`, `changed`."""

import math
import zlib
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np

from matchset.flight.chain.config import with_conditions, with_world
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.links.simulation_parameters import SimulationParameters
from matchset.sim.conditions.conditions import Conditions, Quantity, quantities
from matchset.sim.vehicle import VehicleParameters

NOMINAL = SimulationParameters()
OF_VEHICLE = "vehicle."
LATENCY = "latency_ms"
# format: settings of a flight that no follower is told, but for the latency, whose time stamps say it
SETTINGS = (
    Quantity(LATENCY, NOMINAL.latency_ms, 0.0, 700.0, "ms", "latency as it is, time stamps and all else saying 67"),
    Quantity("swing", NOMINAL.swing, 0.0, 1.0, "m", "amplitude of the rope's swing"),
    Quantity("yaw_deg", NOMINAL.yaw_deg, 0.0, 180.0, "degree", "amplitude of the yaw of what hangs on the rope"),
    Quantity("bias_deg", NOMINAL.bias_deg, 0.0, 30.0, "degree", "how far each level is off, where to by the seed"),
    Quantity("start_off", NOMINAL.start_off, 0.0, 2.0, "m", "how far each begins off its place, along each axis"),
    Quantity("hidden", NOMINAL.hidden, 0.0, 60.0, "s", "how long the ball is hidden at a time"),
    Quantity("hidden_every", NOMINAL.hidden_every, 0.1, 1e6, "s", "time from one hiding to the next"),
)


class Axis(msgspec.Struct, frozen=True):
    """One constant and what it may be.

    Parameters
    ----------
    name : str
    low, high : float
        Ends of its range.
    values : tuple of float
        The values to fly, where they are listed; empty: any of the range.
    told : bool
        Whether the followers are told, where they can know.
    """

    name: str
    low: float
    high: float
    values: tuple[float, ...] = ()
    told: bool = False

    def grid(self, count: int) -> tuple[float, ...]:
        """Return the listed values, or so many from end to end."""
        return self.values or tuple(np.linspace(self.low, self.high, count if self.low < self.high else 1).tolist())

    def drawn(self, seed: int) -> float:
        """Draw a value, uniform in the range: by the seed and the name alone, whatever else is varied."""
        rng = np.random.default_rng((seed, zlib.crc32(self.name.encode())))
        return float(rng.choice(self.values)) if self.values else float(rng.uniform(self.low, self.high))


class FlightCase(NamedTuple):
    """One flight.

    Attributes
    ----------
    alone : str
        The constant that is varied alone; empty: all at once.
    values : dict
        Of the constants that differ, by name.
    seed : int
    """

    alone: str
    values: Mapping[str, float]
    seed: int


def variable() -> dict[str, Quantity]:
    """Everything that `--vary` can vary, by name, but for the constants of ``vehicle.toml``."""
    return {each.name: each for each in (*quantities(), *SETTINGS)}


def quantity(name: str) -> Quantity:
    """Say what a name means, also one of ``vehicle.toml`` or of the world that only `--sweep` takes."""
    known = variable()
    if name in known:
        return known[name]
    source: VehicleParameters | SimulationParameters = NOMINAL.vehicle if name.startswith(OF_VEHICLE) else NOMINAL
    nominal = float(getattr(source, name.removeprefix(OF_VEHICLE)))
    unit = next((unit for ending, unit in (("_deg", "degree"), ("_ms", "ms")) if name.endswith(ending)), "")
    return Quantity(name, nominal, -math.inf, math.inf, unit, "see flight.toml and vehicle.toml")


def names_table() -> str:
    """All names with unit, default, range and meaning, as a Markdown table."""
    lines = ["| name | unit | nominal | range | meaning |", "| --- | --- | ---: | --- | --- |"]
    for each in variable().values():
        nominal = "as told" if each.default is None else f"{each.default:g}"
        unit = {"x": "factor", "": "-"}.get(each.unit, each.unit)
        lines.append(f"| `{each.name}` | {unit} | {nominal} | {each.low:g} ... {each.high:g} | {each.meaning} |")
    lines.append("| `vehicle.KEY` | | | | any number of `vehicle.toml`, of the simulated vehicle alone |")
    return "\n".join(lines)


def parse_vary(text: str) -> list[Axis]:
    """Read NAME=LOW..HIGH,NAME=VALUE,...

    Raises
    ------
    ValueError
        If it is something else, a name is unknown or comes twice, or a range is none.
    """
    axes: list[Axis] = []
    known = [*variable(), *(OF_VEHICLE + key for key in VehicleParameters.__struct_fields__)]
    for part in text.split(","):
        name, mark, ends = (each.strip() for each in part.partition("="))
        if not mark:
            raise ValueError(f"--vary is NAME=LOW..HIGH,NAME=LOW..HIGH,..., got {part!r}")
        if name not in known:
            raise ValueError(f"--vary: there is no {name!r}; there are {', '.join(known)}")
        if name in [axis.name for axis in axes]:
            raise ValueError(f"--vary: {name} comes twice")
        low, dots, high = ends.partition("..")
        axes.append(Axis(name, _number(name, low), _number(name, high if dots else low)))
        if not axes[-1].low <= axes[-1].high:
            raise ValueError(f"--vary: the range of {name} must go up, got {ends}")
    return axes


def parse_sweep(sweep: str) -> Axis:
    """Read NAME=VALUE,VALUE,...

    Raises
    ------
    ValueError
        If the name is neither a number of `SimulationParameters` nor one of `variable`, or a value is no number.
    """
    name, mark, values = sweep.partition("=")
    settings = [
        each for each in NOMINAL.__struct_fields__ if isinstance(getattr(NOMINAL, each), float) or each == "vehicles"
    ]
    known = [*settings, *(each for each in variable() if each not in settings)]
    if not mark or name not in known:
        raise ValueError(f"--sweep is NAME=VALUE,VALUE,... with one of {', '.join(known)}, got {sweep!r}")
    try:
        read = tuple(float(value) for value in values.split(","))
    except ValueError:
        raise ValueError(f"--sweep {name} needs numbers with commas between, got {values!r}") from None
    return Axis(name, min(read), max(read), read, told=True)


def plan(axes: Sequence[Axis], grid: int, seeds: Sequence[int]) -> list[FlightCase]:
    """List the flights: each constant alone at each of its values, then all at once at random.

    Parameters
    ----------
    axes : sequence of Axis
        One with listed values is only flown alone.
    grid : int
        Values of each from end to end; 0: all at once only.
    seeds : sequence of int
        Of the flights of each row.
    """
    listed = len(axes) == 1 and bool(axes[0].values)
    alone = [(axis.name, value) for axis in axes for value in axis.grid(grid)] if grid or listed else []
    cases = [FlightCase(name, {name: value}, seed) for name, value in alone for seed in seeds]
    if not listed:
        cases += [FlightCase("", {axis.name: axis.drawn(seed) for axis in axes}, seed) for seed in seeds]
    return cases


def changed(flight: FlightParameters, values: Mapping[str, float], told: bool = False) -> FlightParameters:
    """Return a flight with other values of some constants.

    Parameters
    ----------
    flight : FlightParameters
    values : mapping from str to float
    told : bool
        Whether time stamps tell of another latency.

    Raises
    ------
    ValueError
        If a value is out of range; the text begins with its name.
    """
    conditions = {name: value for name, value in values.items() if name in Conditions.__struct_fields__}
    vehicle = {name.removeprefix(OF_VEHICLE): value for name, value in values.items() if name.startswith(OF_VEHICLE)}
    world: dict[str, Any] = {
        name: int(value) if isinstance(getattr(flight.world, name), int) else value
        for name, value in values.items()
        if name not in conditions and not name.startswith(OF_VEHICLE)
    }
    if LATENCY in world and not told and flight.world.conditions.told_latency_ms is None:
        conditions.setdefault("told_latency_ms", flight.world.latency_ms)
    if vehicle:
        world["vehicle"] = msgspec.structs.replace(flight.world.vehicle, **vehicle)
    return with_conditions(with_world(flight, **world), **conditions)


def _number(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"--vary: {name} needs numbers, as {name}=0.8..1.2, got {text.strip()!r}")
    return value
