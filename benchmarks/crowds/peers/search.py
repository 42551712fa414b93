"""The best parameters of every peer, on crowds that are not reported: `python -m benchmarks.crowds.peers.search`.

What is searched for is the highest HOTA, the mean over scenes and numbers of balls. Each parameter in turn is set to
the best of the values that `peer.py` lists, in two rounds; what is found is written to `parameters.toml`.
"""

from typing import Annotated, Any

import msgspec
import numpy as np
import typer

from benchmarks.crowds.cases import PAIR, Case, Watched, cases, watched
from benchmarks.crowds.followers import Field
from benchmarks.crowds.peers.peer import PARAMETERS, PEERS, defaults, stored
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
    found = {key: stored(key) for key in PEERS}
    notes: list[str] = []
    with Field() as field:
        for key in only.split(",") if only else list(PEERS):
            found[key], best, tries = search(field, key, known)
            notes.append(f"{key}: mean HOTA {best:.3f} after {tries} tries on seeds {seeds}, {seconds:g} s each")
            print(notes[-1], found[key], flush=True)
            write(found, notes)


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

    best = defaults(PEERS[key])
    for _ in range(ROUNDS):
        for name, values in PEERS[key].choices.items():
            best = max(({**best, name: value} for value in (best[name], *values)), key=merit)
    return best, merit(best), len(tried)


def mean_hota(field: Field, key: str, known: Known, parameters: dict[str, Any]) -> float:
    """HOTA, the mean over scenes and numbers of balls of its mean over seeds."""
    found: dict[tuple[str, int], list[float]] = {}
    for case, given in known:
        answers, _ = follow_fed(field, key, given, parameters)
        found.setdefault((case.scene, case.balls), []).append(score(given.seen(), answers).hota)
    return float(np.mean([np.mean(each) for each in found.values()]))


def write(found: dict[str, dict[str, Any]], notes: list[str]) -> None:
    """Write the file of parameters."""
    head = "".join(f"# {note}\n" for note in ["Written by `python -m benchmarks.crowds.peers.search`.", *notes])
    PARAMETERS.write_bytes(head.encode() + msgspec.toml.encode(found))


if __name__ == "__main__":
    typer.run(main)
