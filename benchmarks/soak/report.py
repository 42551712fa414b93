"""The soak's figures as a table: `Totals`, `print_table`."""

from collections import Counter

import msgspec
from rich.console import Console
from rich.table import Table

from benchmarks.soak.fly import Flown, Violation, quantiles
from benchmarks.soak.plan import Plan
from benchmarks.soak.resources import Resources


class Totals(msgspec.Struct):
    """What all flights have shown.

    Parameters
    ----------
    flights, recorded : int
    flown : Flown
        All together.
    faults : Counter of str
        As planned; a flight that ends early has fewer.
    normal, most : Resources or None
        The most at the end of flights of the warm-up, and of those after it.
    violation : Violation or None
        The first.
    """

    flights: int = 0
    recorded: int = 0
    flown: Flown = msgspec.field(default_factory=Flown)
    faults: Counter[str] = msgspec.field(default_factory=Counter)
    normal: Resources | None = None
    most: Resources | None = None
    violation: Violation | None = None

    def add(self, plan: Plan, flown: Flown) -> None:
        """Add a flight."""
        self.flights += 1
        self.recorded += plan.recorded
        self.faults.update(plan.count() | {"clicks": flown.clicks, "armed again": flown.armings})
        every = self.flown
        for name in ("simulated", "took", "steps", "tracks", "replayed", "crashes", "full"):
            setattr(every, name, getattr(every, name) + getattr(flown, name))
        every.ends.update(flown.ends)
        every.elapsed.extend(flown.elapsed)
        every.computed.extend(flown.computed)


def table(totals: Totals) -> Table:
    """Make the table."""
    made = Table("what", "figure", title="soak", title_justify="left")
    flown = totals.flown
    for name, text in (
        ("simulated", f"{flown.simulated / 60.0:.1f} min in {flown.took / 60.0:.1f} min, {totals.flights} flights"),
        ("steps checked", f"{flown.steps}, {flown.tracks} with the ball confirmed"),
        ("recorded and replayed", f"{totals.recorded} flights, {flown.replayed} steps; recorder full {flown.full}"),
        ("faults", _counts(totals.faults)),
        ("crashes", str(flown.crashes)),
        ("why motors were stopped", _counts(flown.ends)),
        ("update of a tracker, ms on the clock", _latency(flown, "elapsed")),
        ("the same, ms of computing", _latency(flown, "computed")),
        ("after the warm-up", _resources(totals.normal)),
        ("most since then", _resources(totals.most)),
    ):
        made.add_row(name, text)
    return made


def print_table(totals: Totals) -> None:
    """Print the table, and the verdict as the last line."""
    console = Console(width=120)
    console.print(table(totals))
    found = totals.violation
    if found is None:
        console.print(f"{totals.flown.simulated:.0f} s simulated: 0 violations")
        return
    console.print(
        f"seed {found.seed}, flight {found.flight}, step {found.step}: {found.what}", markup=False, soft_wrap=True
    )
    console.print(f"again: python -m benchmarks.soak --seed {found.seed} --flight {found.flight}", soft_wrap=True)


def _counts(counter: Counter[str]) -> str:
    return "\n".join(f"{count} {name}" for name, count in counter.most_common() if count) or "none"


def _latency(flown: Flown, name: str) -> str:
    median, high, longest = (1e3 * each for each in quantiles(getattr(flown, name)))
    return f"median {median:.2f}, 99.99 % {high:.2f}, longest {longest:.2f}"


def _resources(held: Resources | None) -> str:
    return "-" if held is None else f"{held.memory:.0f} MB, {held.handles} open files, {held.threads} threads"
