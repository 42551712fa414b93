"""Weights of hypotheses and of first sight, fitted again: `make hypotheses`, or `python -m benchmarks.hypotheses`.

Each weight is varied alone around its default, on sequences that are not scored (seeds 0 to 9), and the loss is
compared with that of the defaults. The loss has three parts, px:

- tracking: mean of min(error, 5 px) over the frames with the ball well visible, after one click; not answered counts 5;
- first sight: the same for trackers that begin to search in single frames, with the color of the first one;
- absence: 50 px times the share of answered frames in rooms without the ball, with a color learned elsewhere.

A value replaces a default only if it is better by `MARGIN` on these sequences and not worse on those of the seeds from
100 on: the run says so, a person changes the default.
"""

import time
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple

import msgspec
import typer
from rich.console import Console
from rich.table import Column, Table

import matchset as ms
from benchmarks.tracking.false_locks import foreign_color
from benchmarks.tracking.trial import WHAT, circle, sequence
from benchmarks.workers import one_thread
from matchset.app.track.score import error_px
from matchset.sim.clips.truth import ClipTruth
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.parameters import TrackerParameters

WEIGHTS = (
    "hypotheses.larger",
    "hypotheses.smaller",
    "hypotheses.better",
    "hypotheses.mode_gain",
    "hypotheses.mode_score",
    "hypotheses.interior_weight",
    "hypotheses.change_weight",
    "hypotheses.prediction_px",
    "validation.ambiguous_msac_score",
    "validation.color_score",
    "validation.small_color_score",
    "validation.tiny_color_score",
    "validation.expected_factor",
    "validation.detection_interior",
    "validation.detection_core",
    "validation.detection_rim",
    "validation.round_harmonic",
    "validation.harmonic_penalty",
    "validation.hidden_penalty",
    "validation.hint_leeway",
    "confidence.faint_score",
)
"""Paths in `TrackerConstants`. Those of sides that move alone do not touch a ball: `--only shapes_accuracy`."""

FACTORS = (0.5, 0.75, 1.33, 2.0)
MOST_PX = 5.0
FALSE_PX = 50.0
MARGIN = 0.01  # share of the loss by which a value must be better than the default
EMPTY = 4  # sequences without a ball for one of each other kind: false locks are rare
FRAMES, FRESH = 40, 8  # of a sequence; every so many frames a tracker begins to search


class Rendered(NamedTuple):
    """A sequence, kept: its frames with their truths, where its ball was clicked at, and the color of that click."""

    name: str
    frames: list[tuple[ms.Frame, ClipTruth]]
    click: tuple[float, float] | None
    color: ms.ColorModel


class Loss(NamedTuple):
    """The parts of the loss, px."""

    tracking: float
    first_sight: float
    absence: float

    @property
    def total(self) -> float:
        """Sum of the parts, px."""
        return self.tracking + self.first_sight + self.absence


def main(
    only: Annotated[str, typer.Option(help="Some weights, by their paths, with commas between.")] = "",
    seeds: Annotated[int, typer.Option(help="Seeds of each kind of sequence.")] = 2,
) -> None:
    """Vary each weight alone and print what the loss becomes."""
    one_thread()
    console = Console(highlight=False)
    chosen = only.split(",") if only else list(WEIGHTS)
    unknown = [path for path in chosen if path not in WEIGHTS]
    if unknown:
        raise typer.BadParameter(f"{', '.join(unknown)}: choose from {', '.join(WEIGHTS)}")
    begin = time.perf_counter()
    tuning, unseen = (list(render(first, seeds)) for first in (0, 100))
    console.print(f"{len(tuning) + len(unseen)} sequences rendered, {time.perf_counter() - begin:.0f} s")
    defaults = TrackerConstants()
    base, base_unseen = loss(tuning, defaults), loss(unseen, defaults)
    console.print(f"defaults: {_words(base)}; seeds from 100 on: {_words(base_unseen)}")
    table = Table(
        Column("weight", no_wrap=True), "default", "loss of other values, less that of the default, px", "verdict"
    )
    for path in chosen:
        table.add_row(*row_of(path, defaults, (tuning, base), (unseen, base_unseen)))
    console.print(table)
    console.print(f"{time.perf_counter() - begin:.0f} s")


def row_of(
    path: str,
    defaults: TrackerConstants,
    tuning: tuple[list[Rendered], Loss],
    unseen: tuple[list[Rendered], Loss],
) -> tuple[str, str, str, str]:
    """Vary one weight: its path, its default, how the loss changes, and whether another value is better."""
    default = value_at(defaults, path)
    changes = {}
    for factor in FACTORS:
        changed = replaced(defaults, path, default * factor)
        changes[default * factor] = loss(tuning[0], changed).total - tuning[1].total
    best = min(changes, key=lambda value: changes[value])
    verdict = "default stays"
    if changes[best] < -MARGIN * tuning[1].total:
        gain = loss(unseen[0], replaced(defaults, path, best)).total - unseen[1].total
        verdict = f"{best:g} is better here; from seed 100 on by {-gain:+.3f} px"
    return path, f"{default:g}", ", ".join(f"{value:g}: {change:+.3f}" for value, change in changes.items()), verdict


def render(first: int, count: int) -> Iterator[Rendered]:
    """Render sequences of every kind, each with seeds of its own from a first one on; more of them without a ball."""
    for number, name in enumerate(WHAT):
        for k in range(count if name != "empty" else EMPTY * count):
            seed = first + (number + k * len(WHAT)) % 10
            clip = sequence(name, seed, FRAMES, **({"hidden": ((8, 14),)} if name == "hidden" else {}))
            frames = list(clip)
            if not clip.ball:
                yield Rendered(name, frames, None, foreign_color(seed))
                continue
            click = clip.first_click
            yield Rendered(name, frames, click, ms.ColorModel.pick(frames[0][0].image, *click))


def loss(rendered: list[Rendered], constants: TrackerConstants) -> Loss:
    """Follow all sequences with some constants, px."""
    parameters = TrackerParameters(constants=constants)
    tracking: list[float] = []
    first_sight: list[float] = []
    answered, absent = 0, 0
    for each in rendered:
        if each.click is None:
            tracker = ms.Tracker(ms.Circle, each.color, parameters=parameters)
            answered += sum(bool(tracker.update(frame)) for frame, _ in each.frames)
            absent += len(each.frames)
            continue
        tracker = ms.Tracker(ms.Circle, each.color, start=each.click, parameters=parameters)
        tracking += errors(tracker, each.frames)
        for pair in each.frames[FRESH::FRESH]:
            first_sight += errors(ms.Tracker(ms.Circle, each.color, parameters=parameters), [pair])
    return Loss(_mean(tracking), _mean(first_sight), FALSE_PX * answered / max(absent, 1))


def errors(tracker: ms.Tracker[ms.Circle], frames: list[tuple[ms.Frame, ClipTruth]]) -> list[float]:
    """Errors of a tracker, at most `MOST_PX`, in the frames that show at least half of the ball, px."""
    found = []
    for frame, truth in frames:
        answer = tracker.update(frame)
        if truth.circle is None or truth.share < 0.5:
            continue
        error = error_px(circle(answer.shape), circle(truth.circle)) if isinstance(answer, ms.Track) else MOST_PX
        found.append(min(error, MOST_PX))
    return found


def value_at(parameters: Any, path: str) -> float:
    """Return the parameter at a path such as "validation.core"."""
    for name in path.split("."):
        parameters = getattr(parameters, name)
    return float(parameters)


def replaced(parameters: Any, path: str, value: float) -> Any:
    """Parameters with another value at a path."""
    name, _, rest = path.partition(".")
    inner = replaced(getattr(parameters, name), rest, value) if rest else value
    return msgspec.structs.replace(parameters, **{name: inner})


def _mean(values: list[float]) -> float:
    return sum(values) / max(len(values), 1)


def _words(found: Loss) -> str:
    parts = ", ".join(f"{name} {value:.3f}" for name, value in found._asdict().items())
    return f"{found.total:.3f} px ({parts})"


if __name__ == "__main__":
    typer.run(main)
