"""Flights that were flown, kept in a file as soon as they are: `Flown`, `KeptFlights`, `fly_missing`.

A line of the file is one flight, keyed by a checksum of the package's sources and one of the flight's parameters, seed
and all. Bars, words and names may change without flying again.
"""

import hashlib
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import msgspec

import matchset
from benchmarks.flight.rows import Listed
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore
from matchset.flight.simulate.flights import fly_each, fly_scored

DECIDING = (".py", ".toml", ".npz")
"""Endings of the package's files that decide a flight: code, settings, weights."""
DIGITS = 16  # format: hexadecimal ones of a checksum


class Flown(msgspec.Struct, frozen=True, kw_only=True):
    """What is kept of a flight.

    Parameters
    ----------
    score : FlightScore
    noticed : float
        When gains were lowered because of swings for the first time, s; inf if they never were.
    """

    score: FlightScore
    noticed: float = math.inf


class KeptFlight(msgspec.Struct, frozen=True, kw_only=True):
    """A line of the file.

    Parameters
    ----------
    sources, flight : str
        Checksums: `sources` and `checksum`.
    machine : str
        Where it was flown.
    flown : Flown
    """

    sources: str
    flight: str
    machine: str
    flown: Flown


Flier = Callable[[Sequence[FlightParameters], Callable[[], bool]], Iterator[tuple[int, Flown]]]
"""Flies many; yields index and what was flown, in the order in which they end."""


def sources() -> str:
    """Checksum of all that decides a flight but the libraries."""
    total = hashlib.sha256()
    folder = Path(matchset.__file__).parent
    for path in sorted(folder.rglob("*")):
        if path.suffix in DECIDING:
            total.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:DIGITS]


def checksum(flight: FlightParameters) -> str:
    """Checksum of everything that is flown."""
    return hashlib.sha256(msgspec.msgpack.encode(flight)).hexdigest()[:DIGITS]


class KeptFlights:
    """Flights of the sources as they are, read from files and added to the first of them.

    Parameters
    ----------
    paths : sequence of Path
        The first one need not exist.
    code : str
        Checksum of the sources.

    Attributes
    ----------
    left_out : int
        Number of flights of other sources, which do not count.
    torn : int
        Number of lines that cannot be read: a program that wrote one was killed.
    """

    def __init__(self, paths: Sequence[Path], code: str) -> None:
        self.path, self.code = paths[0], code
        self.left_out = self.torn = 0
        self._kept: dict[str, KeptFlight] = {}
        for path in paths:
            for line in path.read_bytes().splitlines() if path.exists() else ():
                self._read(line)

    def _read(self, line: bytes) -> None:
        try:
            kept = msgspec.msgpack.decode(bytes.fromhex(line.decode()), type=KeptFlight)
        except (ValueError, msgspec.DecodeError):
            self.torn += bool(line)
            return
        if kept.sources == self.code:
            self._kept[kept.flight] = kept
        else:
            self.left_out += 1

    def get(self, flight: FlightParameters) -> KeptFlight | None:
        """Return what is kept of a flight; None if it was not flown."""
        return self._kept.get(checksum(flight))

    def add(self, flight: FlightParameters, flown: Flown, machine: str) -> None:
        """Keep a flight: at the end of the file, on a line of its own even behind a torn one."""
        kept = KeptFlight(sources=self.code, flight=checksum(flight), machine=machine, flown=flown)
        self._kept[kept.flight] = kept
        line = msgspec.msgpack.encode(kept).hex().encode() + b"\n"
        with self.path.open("a+b") as file:
            if file.tell():
                file.seek(-1, 2)
                line = line if file.read(1) == b"\n" else b"\n" + line
            file.write(line)


def fly_noted(flight: FlightParameters, stopped: Callable[[], bool] | None = None) -> Flown:
    """Fly to the end, or to the first crash, and score the flight; note when swings were noticed.

    Parameters
    ----------
    flight : FlightParameters
    stopped : callable, optional
        Asked at every step; if it answers True the flight ends there.
    """
    noticed: list[float] = []
    scorer = fly_scored(
        Flight(flight), stopped, lambda step: noticed.append(step.time) if swings_noticed(step) else None
    )
    return Flown(score=scorer.score(), noticed=noticed[0] if noticed else math.inf)


def swings_noticed(step: ChainStep) -> bool:
    """Whether a follower has its gains lowered because of swings."""
    return any(each.control is not None and each.control.gains.words.startswith("swings") for each in step.steps)


def flier(jobs: int) -> Flier:
    """Return what flies many, so many at once: in this process if it is one."""
    return lambda flights, stop: fly_each(fly_noted, flights, jobs, stop)


def fly_missing(
    listed: Sequence[Listed], kept: KeptFlights, fly: Flier, stop: Callable[[], bool], machine: str
) -> Iterator[Listed]:
    """Fly what is not kept, and keep it.

    Parameters
    ----------
    listed : sequence of Listed
    kept : KeptFlights
    fly : callable
    stop : callable
        After it answers True no further flight begins, and unfinished ones are dropped.
    machine : str
        Where it is flown.

    Yields
    ------
    Listed
        What was flown and kept, in the order in which they end.

    Raises
    ------
    ValueError
        If the package's sources change meanwhile: a page is of one commit.
    """
    missing = [each for each in listed if kept.get(each.flight) is None]
    for number, flown in fly([each.flight for each in missing], stop):
        if sources() != kept.code:
            raise ValueError("the sources of matchset have changed while it flew: a page is of one commit, begin anew")
        kept.add(missing[number].flight, flown, machine)
        yield missing[number]
