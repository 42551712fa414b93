"""Flights whose simulated side is not what the followers are told: `python -m benchmarks.flight.mismatch`.

The rows are those of ``mismatch.toml``, flown without pictures, as by `matchset simulate --quick`, unless `--rendered`;
docs/flight.md has the table. Controllers are tuned on seeds below 100; these rows are flown on 110 and up.
"""

from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.console import Console

from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread
from matchset.app.flight.config import with_world
from matchset.app.flight.flight import FlightParameters
from matchset.app.flight.score import FlightScore
from matchset.app.simulate.flights import fly_all
from matchset.app.simulate.table import SweepRow, cells
from matchset.app.simulate.variation import changed, parse_vary

LIST = Path(__file__).with_suffix(".toml")
HEADINGS = ("what differs", "survive", "side", "height", "heading", "worst axis", "bar")
HEADING = "\n".join(f"| {' | '.join(each)} |" for each in (HEADINGS, ["---", *["---:"] * 5, "---"]))


class Row(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A row of the table.

    Parameters
    ----------
    words : str
    vary : str
        As for `matchset simulate --vary`; empty for nothing.
    told : dict
        Fields of `FollowerParameters` that are told wrong.
    mount : dict
        Fields of `MountParameters` that were measured before, as `matchset calibrate --mount` does.
    pictures : bool
        Whether it is flown with pictures even without `--rendered`: without them it is a nominal flight.
    survive : int
        The bar: how many of 20 flights survive.
    rms : float
        The bar: largest rms off the set place of any follower in any axis, cm.
    """

    words: str
    vary: str = ""
    told: dict[str, float] = {}
    mount: dict[str, float] = {}
    pictures: bool = False
    survive: int = 19
    rms: float = 10.0

    def flight(self, seed: int, duration: float, rendered: bool) -> FlightParameters:
        """Make the flight of a seed."""
        flight = with_world(FlightParameters(duration=duration), seed=seed, quick=not (rendered or self.pictures))
        follower = msgspec.structs.replace(flight.pilot.follower, **self.told)
        follower = msgspec.structs.replace(follower, mount=msgspec.structs.replace(follower.mount, **self.mount))
        flight = msgspec.structs.replace(flight, pilot=msgspec.structs.replace(flight.pilot, follower=follower))
        return changed(flight, {axis.name: axis.drawn(seed) for axis in parse_vary(self.vary)} if self.vary else {})

    def in_words(self, scores: list[FlightScore]) -> str:
        """Write the row of the table; in bold what does not reach the bar."""
        row = SweepRow(scores=tuple(scores))
        survived, *axes = [cells(row)[k] for k in (2, 5, 6, 7, 8)]
        whole = SweepRow(scores=tuple(score for score in scores if score.survived))
        if 20 * row.survived < self.survive * len(scores):
            survived = f"**{survived}**"
        if not 100.0 * whole.spread <= self.rms:
            axes[-1] = f"**{axes[-1]}**"
        return f"| {self.words} | {survived} | {' | '.join(axes)} | {self.survive} of 20, {self.rms:g} cm |"


class MismatchList(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What ``mismatch.toml`` holds."""

    row: list[Row]


def rows() -> list[Row]:
    """Read the list."""
    return msgspec.toml.decode(LIST.read_bytes(), type=MismatchList).row


def main(
    seeds: Annotated[str, typer.Option(help="As '110-129' or '110,115'.")] = "110-129",
    only: Annotated[str, typer.Option(help="Rows whose words contain this.")] = "",
    duration: Annotated[float, typer.Option(help="Of each flight, s.")] = 60.0,
    rendered: Annotated[bool, typer.Option(help="With pictures; many times as slow.")] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Flights at once.")] = 1,
) -> None:
    """Fly every row with every seed and print the table."""
    one_thread()
    console = Console(width=400)
    console.print(HEADING, highlight=False)
    for row in rows():
        if only in row.words:
            flights = [row.flight(seed, duration, rendered) for seed in parse_seeds(seeds)]
            scores = dict(fly_all(flights, jobs))
            console.print(row.in_words([scores[k] for k in sorted(scores)]), highlight=False, markup=False)


if __name__ == "__main__":
    typer.run(main)
