"""The best parameters of every peer, on crowds that are not reported: `python -m benchmarks.crowds.peers.search`.

What is searched for is the highest mean over composed crowds of HOTA and of MOTA as a user counts it, which is taken
for 0 where it is less. The first two parameters of a peer are varied together, then each in turn is set to the best
of the values that `peer.py` lists, in two rounds. What is found is written to `parameters.toml`. Finders come first:
`finders/tuning.py`.
"""

import itertools
import json
import tomllib
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import typer

from benchmarks.crowds.cases import Case, Watched
from benchmarks.crowds.composed.scenes import COMPOSED
from benchmarks.crowds.followers import Field
from benchmarks.crowds.peers.peer import PARAMETERS, PEERS, first_of
from benchmarks.crowds.rows import fed_with, follow_fed
from benchmarks.crowds.score import score
from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread

ROUNDS = 2
TUNED = "600-603"  # seeds
BALLS, SECONDS = 8, 2.0  # of a crowd for tuning
Choices = dict[str, tuple[Any, ...]]


def main(
    only: Annotated[str, typer.Option(help="Some peers, with commas.")] = "",
    seeds: Annotated[str, typer.Option(help="Of composed crowds; 650 and up are reported.")] = TUNED,
) -> None:
    """Search, and keep what is found."""
    one_thread()
    crowds = tuning_crowds(parse_seeds(seeds))
    with Field() as field:
        for key in only.split(",") if only else list(PEERS):
            known = [fed_with(key, case) for case in crowds]
            best, merit, tries = climbed(PEERS[key].choices, lambda each: merit_of(field, key, known, each), together=2)  # noqa: B023
            how = f"mean of HOTA and MOTA {merit:.3f}, the best of {tries} tries on composed crowds of seeds {seeds}"
            print(f"{key}: {how}", best, flush=True)
            write(key, {**best, "how": how})


def tuning_crowds(seeds: tuple[int, ...]) -> list[Case]:
    """List the crowds for tuning: every composed scene."""
    return [Case(scene, BALLS, SECONDS, seed) for scene in COMPOSED for seed in seeds]


def climbed(
    choices: Choices, measure: Callable[[dict[str, Any]], float], together: int = 0
) -> tuple[dict[str, Any], float, int]:
    """Change one parameter after the other to the best of its values.

    Parameters
    ----------
    choices : dict
        Values of each; the first is what it begins with.
    measure : callable
        From parameters to what shall be high.
    together : int
        How many, the first ones, are varied together at the beginning.

    Returns
    -------
    parameters : dict
    merit : float
    tries : int
    """
    tried: dict[str, float] = {}

    def merit(parameters: dict[str, Any]) -> float:
        name = repr(sorted(parameters.items()))
        if name not in tried:
            tried[name] = measure(parameters)
        return tried[name]

    names = list(choices)[:together]
    grid = itertools.product(*(choices[name] for name in names))
    best = max((first_of(choices) | dict(zip(names, values, strict=True)) for values in grid), key=merit)
    for _ in range(ROUNDS):
        for name, values in choices.items():
            best = max(({**best, name: value} for value in (best[name], *values)), key=merit)
    return best, merit(best), len(tried)


def merit_of(field: Field, key: str, known: list[Watched], parameters: dict[str, Any]) -> float:
    """Mean over crowds of HOTA and of MOTA as a user counts it, at least 0."""
    merits = []
    for given in known:
        answers, _ = follow_fed(field, key, given, parameters)
        found = score(*given.judged(answers))
        merits += [found.hota, max(found.mota, 0.0)]
    return float(np.mean(merits))


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
