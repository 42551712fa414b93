"""The best parameters of every peer, on sequences that are not scored: `python -m benchmarks.contest.search`.

What is searched for is the least mean of min(error, 5 px) over all frames in which the ball is well visible: an
answer that is not valid is as bad as none, which counts as 5 px too. The first two parameters of a file are varied
together, then all one by one, each to the best of the values that the file lists, in two rounds; heavy peers only one
by one. Sequences: one of every kind whose ball stays in the picture, with the seeds 0 to 9 in turn; tag systems:
`clean`, `typical` and `bad`.
"""

import itertools
import time
from collections.abc import Iterable
from typing import Annotated, Any

import msgspec
import typer
from rich.console import Console

import matchset as ms
from benchmarks.contest.field import PEERS, TAGS, Peer, missing, peer
from benchmarks.contest.run import follow_with_all
from benchmarks.contest.tags import TagClip
from benchmarks.machine import Machine
from benchmarks.peers import PARAMETERS, stored
from benchmarks.peers.tags import CARDS
from benchmarks.tracking.trial import WHAT, Trial, sequence
from benchmarks.workers import one_thread
from matchset.app.track.score import error_px

MOST_PX = 5.0
ROUNDS = 2
FRAMES = 24  # of each sequence
PACE = {"csrt": 6, "paper": 6, "kcf": 8, "hough_alt": 8, "skimage_ransac": 10, "hough_gradient": 5, "edge_drawing": 12}
CHANGES: dict[str, dict[str, Any]] = {"hidden": {"hidden": ((8, 14),)}}
Frames = list[tuple[ms.Frame, Any]]


def main(only: Annotated[str, typer.Option(help="Some peers, by the names of their files.")] = "") -> None:
    """Search parameters and write them to benchmarks/peers/parameters.toml."""
    one_thread()
    console = Console(highlight=False)
    keys = only.split(",") if only else [*PEERS, *TAGS]
    balls: list[Frames] = []
    for key in keys:
        if reason := missing(key):
            console.print(f"{key}: left out, {reason}")
            continue
        one = peer(key)
        if not one.choices:
            continue
        if key not in TAGS and not balls:
            balls = ball_sequences()
        sequences = tag_sequences(key) if key in TAGS else balls
        begin = time.perf_counter()
        frames = [each[: PACE.get(key, FRAMES)] for each in sequences]
        best, loss, tries = search(one, frames, together=0 if key in PACE else 2)
        console.print(f"{key}: {loss:.3f} px after {tries} tries, {time.perf_counter() - begin:.0f} s: {best}")
        keep(key, best, loss)


def ball_sequences() -> list[Frames]:
    """Render one sequence of every kind with a ball."""
    names = [name for name in WHAT if name not in ("empty", "return")]
    return [list(sequence(name, k % 10, FRAMES, **CHANGES.get(name, {}))) for k, name in enumerate(names)]


def tag_sequences(key: str) -> list[Frames]:
    """Render the sequences of a tag system."""
    return [
        list(TagClip(sequence(name, seed, FRAMES), CARDS[key])) for seed, name in enumerate(("clean", "typical", "bad"))
    ]


def search(one: Peer, sequences: list[Frames], together: int = 0) -> tuple[dict[str, Any], float, int]:
    """Change one parameter after the other to the best of its values.

    Parameters
    ----------
    one : Peer
        It begins with the defaults of its file.
    sequences : list of list of (Frame, truth)
    together : int
        How many of them are first varied together.

    Returns
    -------
    parameters : dict
    loss : float
        Mean of min(error, 5 px).
    tries : int
    """
    best = msgspec.to_builtins(type(one.parameters)())
    tried: dict[str, float] = {}

    def measure(parameters: dict[str, Any]) -> float:
        name = repr(sorted(parameters.items()))
        if name not in tried:
            changed = msgspec.structs.replace(one, parameters=type(one.parameters)(**parameters))
            tried[name] = loss_px(follow_with_all(iter(frames), None, [changed], 0)[one.key] for frames in sequences)
        return tried[name]

    names = list(one.choices)[:together]
    grid = itertools.product(*(one.choices[name] for name in names))
    best = min((best | dict(zip(names, values, strict=True)) for values in grid), key=measure)
    for _ in range(ROUNDS):
        for name, values in one.choices.items():
            best = min(({**best, name: value} for value in (best[name], *values)), key=measure)
    return best, measure(best), len(tried)


def loss_px(trials: Iterable[Trial]) -> float:
    """Mean of min(error, 5 px) over the tight frames of some trials; what is not answered counts as 5 px."""
    losses = [
        min(error_px(answer, truth.circle), MOST_PX) if answer and truth.circle else MOST_PX
        for trial in trials
        for truth, answer in zip(trial.truths, trial.answers, strict=True)
        if truth.tight
    ]
    return sum(losses) / len(losses)


def keep(key: str, best: dict[str, Any], loss: float) -> None:
    """Write what was found for a peer into the file; the others stay."""
    peers = stored() | {key: best | {}}
    machine = Machine.here()
    lines = [
        "# Best parameters of the peers on sequences that are not scored (seeds 0-9).",
        "# Generated by `make bench-search` (python -m benchmarks.contest.search); the method is in that file.",
        f"# {machine.date}, commit {machine.commit}; last: {key}, {loss:.3f} px.",
    ]
    for name in (each for each in (*PEERS, *TAGS) if each in peers):
        lines += ["", f"[peers.{name}]", *(f"{k} = {_toml(value)}" for k, value in peers[name].items())]
    PARAMETERS.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _toml(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


if __name__ == "__main__":
    typer.run(main)
