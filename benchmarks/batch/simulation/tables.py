"""What the simulation says, as a part of the page: `simulation_part`."""

import math
from collections.abc import Sequence

import numpy as np

from benchmarks.batch.simulation.basis import Basis
from benchmarks.batch.simulation.many import (
    HELD,
    LENGTHS,
    STORES,
    WORKERS,
    Point,
    Tail,
    growth,
    knee,
    tails,
)
from benchmarks.batch.simulation.predicted import Predicted
from benchmarks.results import table

SHOWN = 1, 10, 100, 1000
STRETCH = 600.0  # s
PREDICTED_BAR, PREDICTED_PRIZE = 10.0, 5.0  # %


def predicted_words(predicted: Predicted) -> str:
    """Write two workers, simulated and real."""
    rows = [
        [str(number), f"{real:.2f}", f"{guess:.2f}", f"{error:+.1f} %"]
        for number, (real, guess, error) in enumerate(
            zip(predicted.real, predicted.simulated, predicted.errors, strict=True), 1
        )
    ]
    medians = float(np.median(predicted.real)), float(np.median(predicted.simulated))
    rows.append(["median", *(f"{value:.2f}" for value in medians), f"**{predicted.error:+.1f} %**"])
    words = (
        f"With tasks drawn from all measured ones 95 % of the runs take {predicted.low:.2f} to {predicted.high:.2f} s."
    )
    return f"{table(['round', 'real, s', 'simulated, s', 'error'], rows)}\n\n{words}"


def basis_words(basis: Basis) -> str:
    """Write what the simulation of many machines takes for granted."""
    costs = ", ".join(f"{1e3 * seconds:.2f} ms with {count}" for count, seconds in basis.costs.items())
    slope = 1e6 * (basis.cost(1000) - basis.cost(0)) / 1000.0
    return (
        f"Measured ({basis.where}): {1e3 * basis.seconds_a_second:.0f} ms of computing and "
        f"{basis.bytes_a_second / 1e6:.2f} MB for a second of video, so that a worker reads "
        f"{basis.bytes_a_second / basis.seconds_a_second / 1e6:.0f} MB/s; a task of Dask {costs} workers, which a line "
        f"continues by {slope:.1f} us for each worker more. Assumed: {WORKERS} workers on each machine, as fast as "
        "these, 10 Gbit/s to each machine, videos of one length with the measured distribution of speed and size, "
        "everything read once over the network."
    )


def growth_tables(basis: Basis) -> str:
    """Write days for 10 PB, and the knees."""
    parts, knees = [], []
    for store, bandwidth in STORES.items():
        rows = []
        for name, length in LENGTHS.items():
            points = growth(basis, length, bandwidth)
            shown = [point for point in points if point.machines in SHOWN]
            rows.append([name, *(_cell(point) for point in shown)])
            knees.append([store, name, number(knee(points)), points[-1].limit])
        head = ["videos of", *(f"{count} machine{'s' * (count > 1)}" for count in SHOWN)]
        words = f"**{store}** ({bandwidth / 1e9:g} GB/s): days for 10 PB, and share of the rate of as many alone"
        parts.append(f"{words}\n\n{table(head, rows)}")
    head = ["store", "videos of", f"machines that keep {100 * HELD:.0f} % of that", "limit with 1,000"]
    return "\n\n".join([*parts, table(head, knees)])


def scheduler_table(basis: Basis) -> str:
    """Write what the cost of a task does alone, with a store that is never the limit."""
    rows = []
    for words, cost in (("measured, by a line", None), ("that of two workers", basis.cost(2))):
        for name, length in LENGTHS.items():
            points = growth(basis, length, math.inf, cost)
            rows.append([words, name, number(knee(points)), f"{100.0 * points[-1].share:.0f} %"])
    head = ["cost of a task", "videos of", f"machines that keep {100 * HELD:.0f} %", "share with 1,000"]
    return table(head, rows)


def tails_table(found: Sequence[Tail]) -> str:
    """Write what `--split` does to the end of a batch."""
    rows = []
    for each in found:
        times = f"{each.ideal:.0f}", f"{each.whole:.0f}", f"{each.split:.0f}"
        rows.append([str(each.machines), *times, f"{each.whole / each.split:.2f}", f"{100.0 * each.extra:.2f} %"])
    return table(["machines", "ideal, s", "whole, s", "`--split 600`, s", "times as fast", "computed twice"], rows)


def simulation_part(basis: Basis, predicted: Predicted | None) -> str:
    """Write all of it."""
    parts = [
        "## Simulated",
        "A model of our own (`benchmarks/batch/simulation/simulate.py`, events in `heapq`, no SimPy): workers "
        "ask one scheduler for tasks, read from one store in equal parts, compute, write.",
    ]
    if predicted is not None:
        parts += ["### Two workers, simulated and real", predicted_words(predicted)]
    parts += ["### 10 PB on many machines", basis_words(basis), "![The rate by machines](../docs/pictures/batch.svg)"]
    parts += [growth_tables(basis), "### The scheduler alone", scheduler_table(basis)]
    parts += ["### One hour among a thousand minutes", tails_table(tails(basis, STRETCH))]
    return "\n\n".join(parts)


def number(value: float) -> str:
    """Write a number of machines."""
    return (
        "1,000 or more"
        if math.isinf(value)
        else "less than 1"
        if not value
        else f"{value:.2g}"
        if value < 10
        else f"{value:.0f}"
    )


def _cell(point: Point) -> str:
    return f"{point.days:.3g} d, {100.0 * point.share:.0f} %"
