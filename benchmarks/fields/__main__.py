"""Half-frames against whole frames: `python -m benchmarks.fields`, on seeds that nothing was tuned on."""

import sys
from typing import Annotated

import numpy as np
import typer

from benchmarks.fields.flying import fly, ratio
from benchmarks.fields.following import Floats, Followed, pooled
from benchmarks.options import parse_seeds
from benchmarks.results import table
from benchmarks.workers import one_thread

HEAD = ["", "pictures", "own time: median, 95 %, px", "against time: median, 95 %, px", "newest: 95 %, px", "missed"]


def main(
    sequences: Annotated[str, typer.Option(help="Sequences, with commas between them; empty: none.")] = "fast,typical",
    seeds: Annotated[str, typer.Option(help='Their seeds, as "100-107".')] = "100-107",
    frames: Annotated[int, typer.Option(help="Frames of each.")] = 300,
    flights: Annotated[str, typer.Option(help="Seeds of flights; empty: none.")] = "2000-2019",
    duration: Annotated[float, typer.Option(help="Of a flight, s.")] = 60.0,
    latency_ms: Annotated[float, typer.Option(help="From capture to command.")] = 133.0,
) -> None:
    """Follow and fly both ways, and print what came of it."""
    one_thread()
    for name in sequences.split(",") if sequences else []:
        whole = pooled(name, parse_seeds(seeds), frames, "frames")
        half = pooled(name, parse_seeds(seeds), frames, "half-frames")
        sys.stdout.write(table(HEAD, [_row(f"{name}, frames", whole), _row(f"{name}, half-frames", half)]) + "\n")
    found = [fly(seed, duration, latency_ms) for seed in (parse_seeds(flights) if flights else [])]
    if found:
        rows = [[str(each.seed), *(f"{100.0 * value:.2f}" for value in (*each.worst, *each.mean))] for each in found]
        ratios = [f"{ratio(pairs):.3f}" for pairs in ([each.worst for each in found], [each.mean for each in found])]
        ends = [["median ratio", "", ratios[0], "", ratios[1]]]
        head = ["seed", "worst axis, frames, cm", "half-frames", "mean axis, frames, cm", "half-frames"]
        sys.stdout.write(table(head, rows + ends))


def _row(name: str, run: Followed) -> list[str]:
    newest = f"{np.percentile(run.newest, 95):.2f}"
    return [name, str(len(run.own) + run.missed), _two(run.own), _two(run.over_time), newest, str(run.missed)]


def _two(values: Floats) -> str:
    return ", ".join(f"{each:.3f}" for each in np.percentile(values, (50, 95)).tolist())


if __name__ == "__main__":
    typer.run(main)
