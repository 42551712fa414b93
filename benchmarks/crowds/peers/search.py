"""The best parameters of every peer, on crowds that are not reported: `python -m benchmarks.crowds.peers.search`.

What is searched for is the highest HOTA, the mean over scenes and numbers of balls. The first two parameters of a peer
are varied together, then each in turn is set to the best of the values that `peer.py` lists, in two rounds. What is
found is written to `parameters.toml`.
"""

import itertools
import json
import tomllib
from typing import Annotated, Any

import numpy as np
import typer

from benchmarks.crowds.cases import PAIR, Case, Watched, cases, watched
from benchmarks.crowds.followers import Field
from benchmarks.crowds.peers.peer import PARAMETERS, PEERS, defaults
from benchmarks.crowds.rows import follow_fed
from benchmarks.crowds.scenes import SCENES
from benchmarks.crowds.score import score
from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread

ROUNDS = 2
Known = list[tuple[Case, Watched]]


def main(
    only: Annotated[str, typer.Option(help="Some peers, with commas.")] = "",
    seeds: Annotated[str, typer.Option(help="Of the crowds; 200 and up are reported.")] = "100-101",
    seconds: Annotated[float, typer.Option(min=1.0, help="Length of each crowd, s.")] = 6.0,
) -> None:
    """Search, and keep what is found."""
    one_thread()
    chosen = parse_seeds(seeds)
    crowds = cases(list(SCENES), [5, 10], seconds, chosen) + cases([PAIR], [2], seconds, tuple(range(100, 106)))
    known = [(case, watched(case)) for case in crowds]
    with Field() as field:
        for key in only.split(",") if only else list(PEERS):
            best, hota, tries = search(field, key, known)
            how = f"mean HOTA {hota:.3f}, the best of {tries} tries on seeds {seeds}, {seconds:g} s each"
            print(f"{key}: {how}", best, flush=True)
            write(key, {**best, "how": how})


def search(field: Field, key: str, known: Known) -> tuple[dict[str, Any], float, int]:
    """Change one parameter after the other to the best of its values.

    Returns
    -------
    parameters : dict
    hota : float
    tries : int
    """
    tried: dict[str, float] = {}

    def merit(parameters: dict[str, Any]) -> float:
        name = repr(sorted(parameters.items()))
        if name not in tried:
            tried[name] = mean_hota(field, key, known, parameters)
        return tried[name]

    choices = PEERS[key].choices
    names = list(choices)[:2]
    grid = itertools.product(*(choices[name] for name in names))
    best = max((defaults(PEERS[key]) | dict(zip(names, values, strict=True)) for values in grid), key=merit)
    for _ in range(ROUNDS):
        for name, values in choices.items():
            best = max(({**best, name: value} for value in (best[name], *values)), key=merit)
    return best, merit(best), len(tried)


def mean_hota(field: Field, key: str, known: Known, parameters: dict[str, Any]) -> float:
    """HOTA, the mean over scenes and numbers of balls of its mean over seeds."""
    found: dict[tuple[str, int], list[float]] = {}
    for case, given in known:
        answers, _ = follow_fed(field, key, given, parameters)
        found.setdefault((case.scene, case.balls), []).append(score(*given.judged(answers)).hota)
    return float(np.mean([np.mean(each) for each in found.values()]))


def write(key: str, parameters: dict[str, Any]) -> None:
    """Write what was found for a peer into the file of parameters; what it says of others stays."""
    tables = tomllib.loads(PARAMETERS.read_text(encoding="utf-8")) if PARAMETERS.exists() else {}
    tables[key] = parameters
    lines = ["# Written by `python -m benchmarks.crowds.peers.search`."]
    for name in sorted(tables):
        lines += ["", f"[{name}]", *(f"{each} = {json.dumps(value)}" for each, value in tables[name].items())]
    PARAMETERS.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    typer.run(main)
