"""Recall and precision of `detect` in labelled stills: `main`."""

import csv
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import cv2
import numpy as np
import typer

import matchset as ms
from benchmarks.crowds.composed.footage import Bytes, folder
from matchset.app.target.target_options import color_at

LABELS = Path(__file__).parent
CLICKS = 6  # most discs of a kind that are clicked, one after the other
LIMIT = 50  # answers
NEAR, ALIKE = 0.3, 0.25  # of the radius: an answer is right that is nearer, and has a radius as like
COUNTED = 0.6  # share of a disc that must be visible for it to be missed


class Disc(NamedTuple):
    """A labelled disc.

    Parameters
    ----------
    circle : Circle
        px.
    kind : str
        Discs of one picture and kind have one color.
    visible : float
        Share of it that is in the picture and can be told from others.
    """

    circle: ms.Circle
    kind: str
    visible: float


class Outcome(NamedTuple):
    """What came of one click.

    Parameters
    ----------
    picture, kind : str
    clicked : Circle
    missed : list of Circle
        Discs of which enough is visible, without an answer.
    false : list of Circle
        Answers that are no disc of this kind, or the second one on a disc.
    right, counted, answers : int
        Discs found of those that count, those, and answers but for those on discs that do not count.
    refused : str
        Why no color was learned; empty if one was.
    """

    picture: str
    kind: str
    clicked: ms.Circle
    missed: list[ms.Circle]
    false: list[ms.Circle]
    right: int
    counted: int
    answers: int
    refused: str = ""

    @property
    def recall(self) -> float:
        """Share of the discs that was found."""
        return self.right / self.counted

    @property
    def precision(self) -> float:
        """Share of the answers that is right; 1 without answers."""
        return self.right / self.answers if self.answers else 1.0


def labelled() -> dict[str, list[Disc]]:
    """Read all labels: discs by picture, its name as a path in the folder with real clips."""
    found: dict[str, list[Disc]] = {}
    for path in sorted(LABELS.glob("*.csv")):
        with path.open(encoding="utf-8") as file:
            for row in csv.DictReader(file):
                circle = ms.Circle(float(row["x"]), float(row["y"]), float(row["r"]))
                found.setdefault(row["name"], []).append(Disc(circle, row["kind"], float(row["visible"])))
    return found


def clicked_discs(discs: Sequence[Disc], most: int) -> list[ms.Circle]:
    """Choose which discs of a kind are clicked: of those that count, at equal steps in the order of the labels."""
    whole = [disc.circle for disc in discs if disc.visible >= COUNTED]
    steps = np.linspace(0, len(whole) - 1, min(most, len(whole)))
    return [whole[round(float(step))] for step in steps]


def matched(discs: Sequence[Disc], answers: Sequence[ms.Circle]) -> dict[int, int]:
    """Pair answers with discs, the nearest first: from an answer's number to a disc's."""
    pairs = []
    for number, answer in enumerate(answers):
        for other, disc in enumerate(discs):
            far = math.hypot(answer.x - disc.circle.x, answer.y - disc.circle.y) / disc.circle.radius
            if far < NEAR and abs(answer.radius / disc.circle.radius - 1.0) < ALIKE:
                pairs.append((far, number, other))
    taken: dict[int, int] = {}
    for _, number, other in sorted(pairs):
        if number not in taken and other not in taken.values():
            taken[number] = other
    return taken


def judged(picture: str, kind: str, discs: Sequence[Disc], clicked: ms.Circle, answers: Sequence[ms.Circle]) -> Outcome:
    """Say which answers are right; those on discs that are mostly hidden count neither for nor against."""
    pairs = matched(discs, answers)
    count = [number for number, disc in enumerate(discs) if disc.visible >= COUNTED]
    right = [other for other in pairs.values() if other in count]
    neutral = len(pairs) - len(right)
    false = [answer for number, answer in enumerate(answers) if number not in pairs]
    missed = [discs[number].circle for number in count if number not in right]
    return Outcome(picture, kind, clicked, missed, false, len(right), len(count), len(answers) - neutral)


def measured(name: str, image: Bytes, discs: Sequence[Disc], most: int = CLICKS) -> list[Outcome]:
    """Click several discs of each kind of a picture, and detect all of that color.

    Parameters
    ----------
    name : str
        Of the picture.
    image : array of uint8
    discs : sequence of Disc
        All its labels.
    most : int, optional
        Clicks on discs of a kind.

    Returns
    -------
    list of Outcome
        One for each click.
    """
    outcomes = []
    for kind in sorted({disc.kind for disc in discs}):
        alike = [disc for disc in discs if disc.kind == kind]
        for circle in clicked_discs(alike, most):
            try:
                color = color_at(ms.Frame(image), round(circle.x), round(circle.y))
            except ValueError as error:
                outcome = judged(name, kind, alike, circle, [])
                outcomes.append(outcome._replace(refused=str(error)))
                continue
            found = ms.detect(image, ms.Circle, color, limit=LIMIT)
            outcomes.append(judged(name, kind, alike, circle, [each.shape for each in found]))
    return outcomes


def main(
    only: Annotated[str, typer.Option(help="Part of the names of the pictures that are measured.")] = "",
    clicks: Annotated[int, typer.Option(min=1, help="Most clicks on discs of a kind.")] = CLICKS,
) -> None:
    """Click discs in labelled stills, detect, and print what is right, missed and false."""
    rows: list[tuple[str, str, list[Outcome]]] = []
    for name, discs in labelled().items():
        if only not in name:
            continue
        image = cv2.imread(str(folder() / name))
        if image is None:
            print(f"{name} is left out: it is not in {folder()}", file=sys.stderr)
            continue
        outcomes = measured(name, image.astype(np.uint8), discs, clicks)
        kinds = sorted({each.kind for each in outcomes})
        rows += [(name, kind, [each for each in outcomes if each.kind == kind]) for kind in kinds]
    print("| picture | kind | discs | clicks | recall | precision | worst recall |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, kind, outcomes in rows:
        recall, precision = _means(outcomes)
        worst = min(each.recall for each in outcomes)
        counts = f"{outcomes[0].counted} | {len(outcomes)}"
        print(f"| {name} | {kind} | {counts} | {recall:.3f} | {precision:.3f} | {worst:.3f} |")
    pictures = sorted({name for name, _, _ in rows})
    by_picture = [_means([each for at, _, of in rows if at == name for each in of]) for name in pictures]
    if by_picture:
        recall, precision = np.mean(by_picture, axis=0)
        print(f"\nMean of {len(pictures)} pictures: recall {recall:.3f}, precision {precision:.3f}.\n")
    for _, _, outcomes in rows:
        for each in outcomes:
            _print_wrong(each)


def _means(outcomes: Sequence[Outcome]) -> tuple[float, float]:
    return (
        float(np.mean([each.recall for each in outcomes])),
        float(np.mean([each.precision for each in outcomes])),
    )


def _print_wrong(outcome: Outcome) -> None:
    """Print what is missed and false after a click, if anything is."""
    parts = [f"refused ({outcome.refused})"] if outcome.refused else []
    parts += [f"missed {_words(outcome.missed)}"] if outcome.missed else []
    parts += [f"false {_words(outcome.false)}"] if outcome.false else []
    if parts:
        print(f"{outcome.picture}, {outcome.kind}, click {_words([outcome.clicked])}: {'; '.join(parts)}")


def _words(circles: Sequence[ms.Circle]) -> str:
    return " ".join(f"({each.x:.0f} {each.y:.0f} r{each.radius:.0f})" for each in circles)
