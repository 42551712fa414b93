"""What `detect` finds in composed crowds after one click, and their sheets: `python -m benchmarks.crowds.composed`."""

import sys
from pathlib import Path
from typing import Annotated

import cv2
import numpy as np
import typer

import matchset as ms
from benchmarks.crowds.cases import color_of
from benchmarks.crowds.composed.footage import Bytes, folder
from benchmarks.crowds.composed.scenes import COMPOSED, Composed
from benchmarks.crowds.crowd import Seen
from benchmarks.crowds.stills.measure import Disc, judged, matched
from benchmarks.options import parse_seeds

SHOWN = 6  # frames of a sheet
CLEAR = 0.99  # share of a ball that is seen, from which its circle is compared


def main(
    scenes: Annotated[str, typer.Option(help=f"Some of {', '.join(COMPOSED)}.")] = ",".join(COMPOSED),
    balls: Annotated[int, typer.Option(min=1, help="How many equal ones.")] = 8,
    seeds: Annotated[str, typer.Option(help="As '600-602'; below 650 for tuning.")] = "600-602",
    seconds: Annotated[float, typer.Option(min=0.5, help="Length of a crowd, s.")] = 4.0,
    every: Annotated[int, typer.Option(min=1, help="Detect in every so many frames.")] = 10,
    sheets: Annotated[Path | None, typer.Option(help="Write contact sheets there, with the truth drawn.")] = None,
) -> None:
    """Detect in composed crowds, and print recall, precision and the errors of clear balls."""
    if not folder().is_dir():
        print(f"composed crowds are left out: no {folder()}", file=sys.stderr)
        return
    print("| scene | seed | ball | radius | background | recall | precision | x px | y px | r px |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    means = []
    for scene in scenes.split(","):
        for seed in parse_seeds(seeds):
            crowd = COMPOSED[scene](balls, seconds, seed)
            recall, precision, errors = _detected(crowd, every)
            means.append((recall, precision))
            radius = float(crowd.course.places[:, 0, 2].mean())
            words = " | ".join(f"{error:+.2f}" for error in errors)
            about = f"{scene} | {seed} | {crowd.ball} | {radius:.0f} | {crowd.background.file}"
            print(f"| {about} | {recall:.3f} | {precision:.3f} | {words} |")
            if sheets:
                sheets.mkdir(parents=True, exist_ok=True)
                cv2.imwrite(str(sheets / f"{scene}_{balls}_{seed}.png"), _sheet(crowd))
    recall, precision = np.mean(means, axis=0)
    print(f"\nMean of {len(means)} crowds: recall {recall:.3f}, precision {precision:.3f}.")


def _detected(crowd: Composed, every: int) -> tuple[float, float, list[float]]:
    """Recall and precision over some frames, and the median error of clear balls in x, y and r, px."""
    color, right, counted, answers = color_of(crowd), 0, 0, 0
    errors = []
    for frame, seen in crowd:
        if frame.index % every:
            continue
        discs = [Disc(each.circle, crowd.ball, each.visible) for each in seen]
        found = [each.shape for each in ms.detect(frame, ms.Circle, color, limit=3 * crowd.balls)]
        outcome = judged("", crowd.ball, discs, ms.Circle(0.0, 0.0, 1.0), found)
        right, counted, answers = right + outcome.right, counted + outcome.counted, answers + outcome.answers
        for number, other in matched(discs, found).items():
            if discs[other].visible > CLEAR:
                one, truth = found[number], discs[other].circle
                errors.append((one.x - truth.x, one.y - truth.y, one.radius - truth.radius))
    middle = np.median(errors, axis=0).tolist() if errors else [float("nan")] * 3
    return right / max(counted, 1), right / max(answers, 1), middle


def _sheet(crowd: Composed) -> Bytes:
    """Frames at equal steps, half size; the truth is drawn in every second one."""
    steps = {round(float(step)) for step in np.linspace(0, crowd.frames - 1, SHOWN)}
    shown = [_drawn(frame.image, seen, at % 2 == 1) for at, (frame, seen) in _chosen(crowd, steps)]
    return np.vstack([np.hstack(shown[at : at + 3]) for at in range(0, SHOWN, 3)])


def _chosen(crowd: Composed, steps: set[int]) -> list[tuple[int, tuple[ms.Frame, list[Seen]]]]:
    return list(enumerate(each for each in crowd if each[0].index in steps))


def _drawn(image: Bytes, seen: list[Seen], truth: bool) -> Bytes:
    picture = image.copy()
    for ball in seen if truth else ():
        center = round(16 * ball.circle.x), round(16 * ball.circle.y)
        color = (255, 0, 255) if ball.visible > 0.0 else (255, 255, 0)
        cv2.circle(picture, center, round(16 * ball.circle.radius), color, 1, cv2.LINE_AA, 4)
    return np.asarray(cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), np.uint8)


if __name__ == "__main__":
    typer.run(main)
