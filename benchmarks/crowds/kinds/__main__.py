"""How `MultiTracker` and `detect` fare with balls of several kinds after a click on each color.

Run as `python -m benchmarks.crowds.kinds`.
"""

import sys
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

import matchset as ms
from benchmarks.crowds.composed.footage import folder
from benchmarks.crowds.crowd import Seen
from benchmarks.crowds.kinds.table import Kind, Table
from benchmarks.crowds.score import Answer, counted
from benchmarks.options import parse_seeds

CLEAR = 0.97  # share of a ball that must be seen for a click on it
MOST = 40  # balls that are followed or detected
Frames = list[tuple[ms.Frame, list[Seen]]]
Answers = dict[str, list[list[Answer]]]


def main(
    seeds: Annotated[str, typer.Option(help="As '700-705'; below 650 for tuning.")] = "600-605",
    seconds: Annotated[float, typer.Option(min=0.5, help="Length of a crowd, s.")] = 3.0,
    every: Annotated[int, typer.Option(min=1, help="Detect in every so many frames.")] = 10,
    sheets: Annotated[Path | None, typer.Option(help="Write a frame of each crowd there.")] = None,
) -> None:
    """Follow and detect balls of three colors, of which the first is clicked at a large one and has small ones too."""
    if not folder().is_dir():
        print(f"composed crowds are left out: no {folder()}", file=sys.stderr)
        return
    print("| seed | large, small, second, third | precision | renamed | detected: the same | precision |")
    print("| --- | --- | --- | --- | --- | --- |")
    rows = list[list[float]]()
    for seed in parse_seeds(seeds):
        table = Table(seconds, seed)
        frames: Frames = list(table)
        if sheets:
            sheets.mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(sheets / f"table_{seed}.png"), frames[len(frames) // 2][0].image)
        colors = {label: _clicked(table, frames, label) for label in dict.fromkeys(each.label for each in table.kinds)}
        followed = _scored(table, frames, _followed(frames, colors))
        detected = _scored(table, frames[::every], _detected(frames[::every], colors))
        rows.append([*followed, *detected])
        print(_row(str(seed), rows[-1]), flush=True)
    print(_row("mean", np.mean(rows, axis=0).tolist()))


def _row(name: str, values: list[float]) -> str:
    *followed, precision, renamed = values[:6]
    *detected, right, _ = values[6:]
    shares = ["/".join(f"{each:.2f}" for each in group) for group in (followed, detected)]
    return f"| {name} | {shares[0]} | {precision:.3f} | {renamed:.1f} | {shares[1]} | {right:.3f} |"


def _clicked(table: Table, frames: Frames, label: str) -> ms.ColorModel:
    """Learn a color at the largest ball that is whole in the first frame that shows one."""
    for frame, seen in frames:
        clear = [each for each in seen if table.kinds[each.identity].label == label and each.visible > CLEAR]
        if clear:
            circle = max(clear, key=lambda each: each.circle.radius).circle
            return ms.ColorModel.pick(frame.image, circle.x, circle.y)
    raise ValueError(f"no ball {label!r} of seed {table.seed} is ever seen whole")


def _followed(frames: Frames, colors: dict[str, ms.ColorModel]) -> Answers:
    tracker = ms.MultiTracker(ms.Circle, colors, MOST)
    said: Answers = {label: [] for label in colors}
    for frame, _ in frames:
        targets = tracker.update(frame)
        for label, rows in said.items():
            found = [(each.identity, each.track) for each in targets if each.label == label]
            rows.append([Answer(name, track.shape) for name, track in found if isinstance(track, ms.Track)])
    return said


def _detected(frames: Frames, colors: dict[str, ms.ColorModel]) -> Answers:
    return {
        label: [
            [Answer(at, each.shape) for at, each in enumerate(ms.detect(frame, ms.Circle, color, limit=MOST))]
            for frame, _ in frames
        ]
        for label, color in colors.items()
    }


def _scored(table: Table, frames: Frames, answers: Answers) -> list[float]:
    """Recall of each kind, precision, and how often balls were renamed; with a wrong label an answer is false."""
    recalls, right, false, renamed = list[float](), 0.0, 0.0, 0
    kinds: list[Kind] = list(dict.fromkeys(table.kinds))
    for kind in kinds:
        seen = [table.seen_of(there, kind.label, kind.size) for _, there in frames]
        recalls.append(counted(zip(seen, answers[kind.label], strict=True))[1])
    for label, said in answers.items():
        every = [[each for each in there if table.kinds[each.identity].label == label] for _, there in frames]
        mota, recall, changed, _ = counted(zip(every, said, strict=True))
        balls = sum(each.visible >= 0.3 for there in every for each in there)
        right += recall * balls
        false += (recall - mota) * balls - changed
        renamed += changed
    return [*recalls, right / max(right + false, 1.0), float(renamed)]


typer.run(main)
