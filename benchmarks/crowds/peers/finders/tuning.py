"""The best parameters of every finder, on crowds that are not reported.

Run `python -m benchmarks.crowds.peers.finders.tuning`. What is searched for is the highest mean over the crowds of
2 TP / (2 TP + FP + FN), by centers as a user counts, in some frames of each. One parameter after the other is set to
the best of the values that `finder.py` lists, in two rounds.
"""

from typing import Annotated, Any

import numpy as np
import typer

import matchset as ms
from benchmarks.crowds.cases import Case, click_of
from benchmarks.crowds.crowd import MIN_VISIBLE, Seen
from benchmarks.crowds.peers.finders.color_range import Bytes
from benchmarks.crowds.peers.finders.finder import FINDERS, taught
from benchmarks.crowds.peers.search import TUNED, climbed, tuning_crowds, write
from benchmarks.crowds.score import Answer, met
from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread

Shown = tuple[Bytes, ms.Circle, list[tuple[Bytes, list[Seen]]]]
"""What was clicked, and frames with their truth."""


def main(
    only: Annotated[str, typer.Option(help="Some finders, with commas.")] = "",
    seeds: Annotated[str, typer.Option(help="Of composed crowds; 650 and up are reported.")] = TUNED,
    every: Annotated[int, typer.Option(min=1, help="Look at every so many frames.")] = 12,
) -> None:
    """Tune, and keep what is found."""
    one_thread()
    crowds = [shown(case, every) for case in tuning_crowds(parse_seeds(seeds))]
    for name in only.split(",") if only else list(FINDERS):
        best, merit, tries = climbed(FINDERS[name], lambda each, name=name: mean_f1(name, each, crowds))  # type: ignore[misc]
        how = f"mean F1 {merit:.3f}, the best of {tries} tries on composed crowds of seeds {seeds}"
        print(f"{name}: {how}", best, flush=True)
        write(f"finder_{name}", {**best, "how": how})


def shown(case: Case, every: int) -> Shown:
    """Keep some frames of a crowd."""
    crowd = case.crowd()
    frame, circle = click_of(crowd)
    kept = [(each.image.copy(), seen or []) for each, seen in crowd if each.index % every == 0]
    return frame.image.copy(), circle, kept


def mean_f1(name: str, parameters: dict[str, Any], crowds: list[Shown]) -> float:
    """Mean over crowds of 2 TP / (2 TP + FP + FN)."""
    return float(np.mean([_f1(name, parameters, each) for each in crowds]))


def _f1(name: str, parameters: dict[str, Any], crowd: Shown) -> float:
    image, circle, frames = crowd
    find = taught(name, image, circle, parameters)
    right = balls = answers = 0
    for picture, seen in frames:
        said = [Answer(number, ms.Circle(*each[:3])) for number, each in enumerate(find(picture))]
        given = met(seen, said, {})
        counted = sum(ball.visible >= MIN_VISIBLE for ball, _ in given)
        right += counted
        balls += sum(ball.visible >= MIN_VISIBLE for ball in seen)
        answers += len(said) - (len(given) - counted)
    return 2.0 * right / max(balls + answers, 1)


if __name__ == "__main__":
    typer.run(main)
