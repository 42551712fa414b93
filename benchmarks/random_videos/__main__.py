"""Follow random videos beside what people use: `python -m benchmarks.random_videos FOLDER`.

FOLDER has photographs, such as `python -m training.rendering.photographs FOLDER` fetches. Everybody is told the circle
in the first frame, matchset a click on its left half, as in the contest. `--sheet FILE` draws pictures of them instead.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import numpy.typing as npt
import typer

from benchmarks.contest.field import OURS, peer
from benchmarks.options import parse_seeds
from benchmarks.random_videos.following import PEERS, Task, follow, photographs_in
from benchmarks.random_videos.video import frames
from benchmarks.results import table
from benchmarks.workers import one_thread, spread
from matchset.app.track.score import Score

TILE, SHOWN = (320, 240), 4
GREEN = (60, 220, 60)
FINE = 4  # bits of a pixel's fraction when circles are drawn


def main(
    folder: Annotated[Path, typer.Argument(help="Photographs to render before.", exists=True, file_okay=False)],
    seeds: Annotated[str, typer.Option(help='Seeds of the videos, as "100-159,200".')] = "100-159",
    jobs: Annotated[int, typer.Option(help="Processes.")] = 2,
    sheet: Annotated[Path | None, typer.Option(help="Draw pictures of the videos into this file instead.")] = None,
) -> None:
    """Follow random videos and print what everybody reached, and each video that matchset did not hold."""
    one_thread()
    try:
        tasks = [Task(seed, folder) for seed in parse_seeds(seeds)]
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    if sheet is not None:
        cv2.imwrite(str(sheet), np.vstack([strip(task) for task in tasks]))
        return
    every = spread(follow, tasks, jobs)
    sys.stdout.write(f"{summary(every)}\n{lines(tasks, every)}")


def summary(every: Sequence[dict[str, Score]]) -> str:
    """Write what everybody reached on all videos, each counting the same, as a table."""
    rows = []
    for key in every[0]:
        valid = valid_of(every, key)
        others = np.max([valid_of(every, other) for other in every[0] if other != key], axis=0)
        figures = (np.mean(valid), *np.quantile(valid, (0.1, 0.5)), 100.0 * np.mean(valid >= others - 1.0))
        far = sum(scores[key].false_locks for scores in every)
        rows.append([peer(key).name, *(f"{figure:.1f}" for figure in figures), str(far)])
    head = ["", "valid, %", "10 % quantile", "median", "first or within 1 %, % of videos", "false locks"]
    return table(head, rows)


def lines(tasks: Sequence[Task], every: Sequence[dict[str, Score]], held: float = 95.0) -> str:
    """Write the videos of which matchset held less than a percentage of the frames, as a table."""
    rows = [
        [str(task.seed), *(f"{scores[key].valid_percent or 0.0:.0f}" for key in PEERS), str(scores[OURS].lost)]
        for task, scores in zip(tasks, every, strict=True)
        if (scores[OURS].valid_percent or 0.0) < held
    ]
    return table(["seed", *(peer(key).name for key in PEERS), "frames lost by matchset"], rows)


def valid_of(every: Sequence[dict[str, Score]], key: str) -> npt.NDArray[np.float64]:
    """Return the percentage of valid frames of each video."""
    return np.array([scores[key].valid_percent or 0.0 for scores in every])


def strip(task: Task) -> npt.NDArray[np.uint8]:
    """Draw some frames of a video side by side, with the circle of the truth."""
    tiles = []
    chosen = set(np.linspace(0, task.limits.frames - 1, SHOWN).astype(int).tolist())
    for frame, truth in frames(task.seed, photographs_in(task.folder), task.limits):
        if frame.index not in chosen:
            continue
        picture = frame.image.copy()
        if truth.circle is not None:
            x, y, radius = (round(value * (1 << FINE)) for value in truth.circle)
            cv2.circle(picture, (x, y), radius, GREEN, 1, cv2.LINE_AA, FINE)
        tiles.append(cv2.resize(picture, TILE))
    return np.asarray(np.hstack(tiles), np.uint8)


if __name__ == "__main__":
    typer.run(main)
