"""Accuracy on the real clips: `measure_standard` with one click, `measure_nine` clicks, `measure_searches` without."""

from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.options import Options
from benchmarks.real.clips import Clip
from benchmarks.real.detection import Detected, Seeker
from benchmarks.real.following import Recorder, Run, follow
from benchmarks.real.foreign import Tally, count_false_locks
from benchmarks.real.scores import answers_on_absent
from benchmarks.real.starts import start_at, starts_of
from benchmarks.regression.figures import (
    COUNT,
    ERROR,
    LEAST,
    MEAN_SHARE,
    NEVER,
    NOTHING,
    ROW,
    SOME,
    Figure,
)
from matchset.app.track.score import Score, score

QUICKEST = ("green_bounce", "green_throw", "tennis_throw", "yellow_occlusion")
FOLLOWED = 100  # pictures after one of the nine clicks; the standard one is followed to the end
SEARCHES = 1000  # for colors of other clips
STANDARD, NINE, SEARCH, FOREIGN, ALL = "standard click", "nine clicks", "detect", "foreign colors", "all"


class Near(msgspec.Struct, frozen=True):
    """What became of a clip's nine clicks over `FOLLOWED` pictures.

    Parameters
    ----------
    clip : Clip
    scores : list of Score
    nothing : list of bool
        Whether each of them never gave a track.
    """

    clip: Clip
    scores: list[Score]
    nothing: list[bool]


def follow_standard(clip: Clip) -> Run:
    """Follow the ball of a clip from the standard click to the end."""
    recorder = Recorder(clip, [start_at(clip.tight[0], click=0)])
    for frame, answers in follow(clip, recorder.followers):
        recorder.take(frame.index, answers)
    return recorder.runs()[0]


def follow_nine(clip: Clip) -> Near:
    """Follow the ball of a clip from nine clicks in its first tight row, not to the end."""
    first = clip.tight[0]
    last = first.frame + FOLLOWED
    starts = [start for start in starts_of(clip) if start.beginning == 0]
    recorder = Recorder(clip, starts)
    for frame, answers in follow(clip, recorder.followers):
        recorder.take(frame.index, answers)
        if frame.index >= last:
            break
    runs, rows = recorder.runs(), [row for row in clip.truths if row.frame <= last]
    return Near(clip, [score(run.answers, rows, start=first.frame) for run in runs], [run.nothing for run in runs])


def seek(clip: Clip) -> Seeker:
    """Search the labelled rows of a clip."""
    seeker = Seeker(clip)
    for frame, _ in follow(clip, []):
        seeker.take(frame)
    return seeker


def measure_standard(clips: Sequence[Clip], quick: bool = False) -> list[Figure]:
    """Measure the standard click of all clips, or with `quick` of the quickest."""
    if quick:
        return [
            each for clip in clips if clip.name in QUICKEST for each in standard_figures(clip, follow_standard(clip))
        ]
    runs = [follow_standard(clip) for clip in clips]
    by_clip = [each for clip, run in zip(clips, runs, strict=True) for each in standard_figures(clip, run)]
    scores = [run.score(clip) for clip, run in zip(clips, runs, strict=True)]
    absent = sum(answers_on_absent(run, clip) for clip, run in zip(clips, runs, strict=True))
    valid = [each.valid_percent or 0.0 for each in scores]
    errors = [each.mean_error_px for each in scores if each.mean_error_px is not None]
    where = STANDARD, ALL
    return [
        *by_clip,
        Figure.of(where, "mean valid, %", float(np.mean(valid)), MEAN_SHARE),
        Figure.of(where, "least valid, %", min(valid), LEAST),
        Figure.of(where, "mean of means, px", float(np.mean(errors)) if errors else None, ERROR),
        Figure.of(where, "answers on absent rows", absent, COUNT),
        Figure.of(where, "far answers", sum(each.false_locks for each in scores) - absent, SOME),
    ]


def standard_figures(clip: Clip, run: Run) -> list[Figure]:
    """Name the numbers of the standard click of a clip."""
    result, where = run.score(clip), (STANDARD, clip.name)
    absent = answers_on_absent(run, clip)
    return [
        Figure.of(where, "valid, %", result.valid_percent or 0.0, ROW, noise=100.0 / max(result.tight, 1)),
        Figure.of(where, "mean error, px", result.mean_error_px, ERROR),
        Figure.of(where, "lost", result.lost, COUNT),
        Figure.of(where, "answers on absent rows", absent, COUNT),
        Figure.of(where, "far answers", result.false_locks - absent, COUNT),
    ]


def measure_nine(clips: Sequence[Clip]) -> list[Figure]:
    """Measure nine clicks into each clip; each clip counts the same, half a row of each click is noise."""
    figures, means, clicks = [], list[float](), list[bool]()
    for clip in clips:
        near = follow_nine(clip)
        rows = sum(each.tight for each in near.scores)
        means.append(float(np.mean([each.valid_percent or 0.0 for each in near.scores])))
        clicks += near.nothing
        noise = max(50.0 * len(near.scores) / max(rows, 1), 1.0)
        figures.append(Figure.of((NINE, clip.name), "mean valid, %", means[-1], ROW, noise=noise))
        figures.append(Figure.of((NINE, clip.name), "give nothing", sum(near.nothing), NEVER))
    return [
        *figures,
        Figure.of((NINE, ALL), "mean valid, %", float(np.mean(means)), MEAN_SHARE),
        Figure.of((NINE, ALL), "give nothing, %", 100.0 * float(np.mean(clicks)), NOTHING),
    ]


def measure_searches(clips: Sequence[Clip], data: Path) -> list[Figure]:
    """Search the labelled rows of each clip, and frames of the others for its color."""
    seekers = {clip.name: seek(clip) for clip in clips}
    found = {name: seeker.detected() for name, seeker in seekers.items()}
    balls = {name: seeker.ball for name, seeker in seekers.items() if seeker.ball is not None}
    tallies = count_false_locks(clips, balls, data, Options(data=data, jobs=1), SEARCHES)
    by_clip = [figure for name, each in found.items() for figure in search_figures(name, each)]
    right = [100.0 * each.right / each.shown for each in found.values() if each.shown]
    return [
        *by_clip,
        Figure.of((SEARCH, ALL), "mean right, %", float(np.mean(right)) if right else None, MEAN_SHARE),
        Figure.of((SEARCH, ALL), "false", sum(each.false for each in found.values()), NEVER),
        *foreign_figures(tallies),
    ]


def search_figures(name: str, found: Detected) -> list[Figure]:
    """Name the numbers of the searches of a clip's labelled frames."""
    where, right = (SEARCH, name), 100.0 * found.right / found.shown if found.shown else None
    return [
        Figure.of(where, "right, %", right, ROW, noise=100.0 / max(found.shown, 1)),
        Figure.of(where, "wrong", found.wrong, COUNT),
        Figure.of(where, "false", found.false, NEVER),
    ]


def foreign_figures(tallies: Sequence[Tally]) -> list[Figure]:
    """Count the answers to searches for colors that are not there, by color."""
    figures = []
    for color in sorted({tally.color for tally in tallies}):
        false = sum(len(tally.false) for tally in tallies if tally.color == color)
        figures.append(Figure.of((FOREIGN, color), "false locks", false, COUNT))
    every = sum(len(tally.false) for tally in tallies)
    return [*figures, Figure.of((FOREIGN, ALL), "false locks", every, COUNT)]
