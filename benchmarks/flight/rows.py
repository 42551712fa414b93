"""The rows of ``flights.toml`` and the list of their flights: `Row`, `rows`, `chosen`, `flight_list`."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import msgspec

from matchset.control.follower import FollowerParameters
from matchset.flight.chain.config import with_world
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.simulate.variation import changed, parse_vary

LIST = Path(__file__).with_name("flights.toml")
WHOLE = 60.0  # format: s, the length of a flight where a row says nothing

Order = Literal["rows", "seeds"]


class Row(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A row of the page: what is flown, and its bar.

    Parameters
    ----------
    name : str
        A word by which it is chosen.
    words : str
        What is flown.
    vary : str
        As for `matchset simulate --vary`; empty for nothing.
    world : dict
        Fields of `SimulationParameters`; what followers are told of them they are told rightly.
    told : dict
        Fields of `FollowerParameters` that are told wrong.
    mount : dict
        Fields of `MountParameters` that were measured before, as `matchset calibrate --mount` does.
    level_gains : float
        Factor on the gains of the level loop, high and low ones.
    duration : float
        s.
    pictures : bool
        Whether only pictures show it: without them it is a nominal flight.
    kind : str
        What the bar is about: "spread" of the places held, no "crash", how soon all "settle", and how soon after the
        pulled cable the "descent" begins.
    survive : int
        How many of 20 flights survive; for "spread".
    rms : float
        Largest rms off the set place of any follower in any axis of a flight that survives, cm; for "spread".
    in_view : float
        Least share of the pictures with the ball, of any follower of any flight; for "spread".
    limit : float
        s; for "settle" and "descent".
    """

    name: str
    words: str
    vary: str = ""
    world: dict[str, Any] = {}
    told: dict[str, float] = {}
    mount: dict[str, float] = {}
    level_gains: float = 1.0
    duration: float = WHOLE
    pictures: bool = False
    kind: Literal["spread", "crash", "settle", "descent"] = "spread"
    survive: int = 19
    rms: float = 10.0
    in_view: float = 0.0
    limit: float = 0.0

    def flight(self, seed: int, duration: float = math.inf, quick: bool = False) -> FlightParameters:
        """Make the flight of a seed.

        Parameters
        ----------
        seed : int
        duration : float
            Makes longer ones so short, s.
        quick : bool
            Without pictures.

        Raises
        ------
        ValueError
            If something is unknown or out of range.
        """
        flight = FlightParameters(duration=min(duration, self.duration))
        flight = with_world(flight, seed=seed, quick=quick, **self.world)
        replace = msgspec.structs.replace
        follower = with_level_gains(replace(flight.pilot.follower, **self.told), self.level_gains)
        follower = replace(follower, mount=replace(follower.mount, **self.mount))
        flight = replace(flight, pilot=replace(flight.pilot, follower=follower))
        return changed(flight, {axis.name: axis.drawn(seed) for axis in parse_vary(self.vary)} if self.vary else {})

    @property
    def bar(self) -> str:
        """The bar in words."""
        if self.kind == "crash":
            return "no crash"
        if self.kind == "settle":
            return f"settled within {self.limit:g} s"
        if self.kind == "descent":
            return f"descent within {self.limit:g} s"
        parts = [f"{self.survive} of 20"]
        parts += [f"{self.rms:g} cm"] if math.isfinite(self.rms) else []
        return ", ".join(parts + ([f"in view {100.0 * self.in_view:g} %"] if self.in_view else []))


class FlightList(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What ``flights.toml`` holds."""

    row: list[Row]


class Listed(NamedTuple):
    """One flight of the list."""

    row: Row
    seed: int
    flight: FlightParameters


def with_level_gains(follower: FollowerParameters, factor: float) -> FollowerParameters:
    """Multiply proportional and derivative of the level loop, high and low ones, by a factor."""
    level, schedule, replace = follower.horizontal, follower.gain_schedule, msgspec.structs.replace
    return replace(
        follower,
        horizontal=replace(level, proportional=factor * level.proportional, derivative=factor * level.derivative),
        gain_schedule=replace(
            schedule, proportional=factor * schedule.proportional, derivative=factor * schedule.derivative
        ),
    )


def rows() -> list[Row]:
    """Read the list."""
    return msgspec.toml.decode(LIST.read_bytes(), type=FlightList).row


def chosen(every: Sequence[Row], only: str) -> list[Row]:
    """Choose rows, in the order of the list.

    Parameters
    ----------
    every : sequence of Row
    only : str
        Names, or else parts of their words, with commas between; empty: all.

    Raises
    ------
    ValueError
        If one fits no row.
    """
    wanted: set[str] = set()
    for word in filter(None, (each.strip() for each in only.split(","))):
        fitting = {row.name for row in every if row.name == word} or {row.name for row in every if word in row.words}
        if not fitting:
            raise ValueError(f"there is no row {word!r}; there are {', '.join(row.name for row in every)}")
        wanted |= fitting
    return [row for row in every if row.name in wanted or not only]


def flight_list(
    of: Sequence[Row], seeds: Sequence[int], duration: float = math.inf, quick: bool = False, order: Order = "seeds"
) -> list[Listed]:
    """List the flights of rows.

    Parameters
    ----------
    of : sequence of Row
    seeds : sequence of int
    duration : float
        Makes longer flights so short, s.
    quick : bool
        Without pictures; rows that only pictures show are left out.
    order : str
        "seeds": the first seed of all rows, then the next one; "rows": row by row.
    """
    flown = [row for row in of if not (quick and row.pictures)]
    pairs = [(row, seed) for seed in seeds for row in flown]
    if order == "rows":
        pairs = [(row, seed) for row in flown for seed in seeds]
    return [Listed(row, seed, row.flight(seed, duration, quick)) for row, seed in pairs]


def parse_share(text: str) -> tuple[int, int]:
    """Read ``2/3``: the second of three shares.

    Raises
    ------
    ValueError
        If it is something else.
    """
    first, slash, last = text.partition("/")
    if not (slash and first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last)):
        raise ValueError(f"a share is I/N with I from 1 to N, such as 2/3, got {text!r}")
    return int(first), int(last)


def share_of(flights: Sequence[Listed], share: tuple[int, int]) -> list[Listed]:
    """Every N-th flight of a list, from the I-th on: what is kept of it changes nothing in who flies what."""
    first, count = share
    return list(flights[first - 1 :: count])
