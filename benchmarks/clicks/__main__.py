"""Click into pictures whose truth is known: `python -m benchmarks.clicks`.

`--photographs FOLDER` adds random videos, `--data FOLDER` the labelled clips. `--write FOLDER` writes what is drawn as
pictures, with `truth.csv` beside them, instead.
"""

import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

from benchmarks.clicks.judging import Outcome, judge
from benchmarks.clicks.pictures import Shown, random_videos, real, rendered
from benchmarks.options import parse_seeds
from benchmarks.results import table
from benchmarks.workers import one_thread

HEAD = ["", "clicks", "right, %", "first or second, %", "spot, %", "refused, %", "says it is sure to, %", "ms, median"]


def main(  # the options of a command
    seeds: Annotated[str, typer.Option(help='Seeds of what is drawn, as "0-9".')] = "0-9",
    photographs: Annotated[Path | None, typer.Option(help="Folder of photographs for random videos.")] = None,
    videos: Annotated[str, typer.Option(help="Seeds of random videos.")] = "1000-1099",
    data: Annotated[Path | None, typer.Option(help="Folder of labelled clips.")] = None,
    every: Annotated[int, typer.Option(help="Click at every so manieth place only.", min=1)] = 1,
    write: Annotated[Path | None, typer.Option(help="Write what is drawn into this folder instead.")] = None,
) -> None:
    """Click, and print what was taken."""
    one_thread()
    try:
        drawn, filmed = parse_seeds(seeds), parse_seeds(videos)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    if write is not None:
        save(write, rendered(drawn))
        return
    shown: list[Iterator[Shown]] = [rendered(drawn)]
    shown += [random_videos(photographs, filmed)] if photographs is not None else []
    shown += [real(data)] if data is not None else []
    outcomes = [outcome for group in shown for each in group for outcome in judge(each, every)]
    sys.stdout.write(summary(outcomes))


def summary(outcomes: Sequence[Outcome]) -> str:
    """Write what came of the clicks of each group, and of all, as a table."""
    groups = defaultdict(list)
    for outcome in outcomes:
        groups[outcome.group].append(outcome)
    return table(HEAD, [_row(name, group) for name, group in (*groups.items(), ("all", list(outcomes)))])


def _row(name: str, group: Sequence[Outcome]) -> list[str]:
    shares = 100.0 * np.mean([(*each[1:5], each.sure) for each in group], axis=0)
    milliseconds = 1000.0 * float(np.median([each.seconds for each in group]))
    return [name, str(len(group)), *(f"{share:.1f}" for share in shares), f"{milliseconds:.0f}"]


def save(folder: Path, shown: Iterator[Shown]) -> None:
    """Write pictures with the truth beside them."""
    folder.mkdir(parents=True, exist_ok=True)
    lines = ["picture,x,y,r"]
    for each in shown:
        name = each.name.replace(" ", "_") + ".png"
        cv2.imwrite(str(folder / name), each.image)
        lines.append(",".join((name, *(f"{value:.2f}" for value in each.circle))))
    (folder / "truth.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    typer.run(main)
