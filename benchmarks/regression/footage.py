"""Accuracy on the real clips: the standard click, nine clicks, searches, and colors of other clips: `measure`."""

from collections.abc import Sequence

import msgspec
import numpy as np

from benchmarks.options import Options
from benchmarks.real.clips import Clip
from benchmarks.real.detection import Detected, Seeker
from benchmarks.real.following import Recorder, Run
from benchmarks.real.following import follow as follow_clip
from benchmarks.real.foreign import Ball, Tally, count_false_locks
from benchmarks.real.scores import answers_on_absent
from benchmarks.real.starts import CLICKS, start_at
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


class Seen(msgspec.Struct, frozen=True):
    """What one decoding of a clip gave.

    Parameters
    ----------
    clip : Clip
    standard : Run
        To the end.
    nine : list of Score
        Of all places of the click, over `FOLLOWED` pictures.
    nothing : list of bool
        Whether each of them never gave a track.
    detected : Detected or None
    ball : Ball or None
    """

    clip: Clip
    standard: Run
    nine: list[Score]
    nothing: list[bool]
    detected: Detected | None
    ball: Ball | None


def look(clip: Clip, standard_only: bool = False) -> Seen:
    """Follow the ball of a clip from nine clicks in its first tight row, and search its labelled frames."""
    first = clip.tight[0]
    starts = [start_at(first, place) for place in range(1 if standard_only else len(CLICKS))]
    starts = [s for s in starts if s.standard or (0.0 <= s.x <= clip.width - 1 and 0.0 <= s.y <= clip.height - 1)]
    recorder, last = Recorder(clip, starts), first.frame + FOLLOWED
    seeker = None if standard_only else Seeker(clip)
    standard = recorder.followers[0]
    for frame, _ in follow_clip(clip, []):
        answers = [
            each.update(frame) if each is standard or frame.index <= last else None for each in recorder.followers
        ]
        recorder.take(frame.index, answers)
        if seeker is not None:
            seeker.take(frame)
    runs = recorder.runs()
    rows = [row for row in clip.truths if row.frame <= last]
    near = [score(run.answers, rows, start=first.frame) for run in runs]
    found, ball = (None, None) if seeker is None else (seeker.detected(), seeker.ball)
    return Seen(clip, runs[0], near, [_silent(run, last) for run in runs], found, ball)


def _silent(run: Run, last: int) -> bool:
    return not any(answer for frame, answer in run.answers.items() if frame <= last)


def measure(clips: Sequence[Clip], options: Options) -> list[Figure]:
    """Measure all clips, or with `quick` the standard click of the quickest."""
    if options.quick:
        seen = [look(clip, standard_only=True) for clip in clips if clip.name in QUICKEST]
        return [figure for each in seen for figure in standard_figures(each)]
    seen = [look(clip) for clip in clips]
    balls = {each.clip.name: each.ball for each in seen if each.ball is not None}
    tallies = count_false_locks(clips, balls, options.data, options, SEARCHES)
    by_clip = [f for each in seen for f in (*standard_figures(each), *nine_figures(each), *search_figures(each))]
    return [*by_clip, *together(seen), *foreign_figures(tallies)]


def standard_figures(seen: Seen) -> list[Figure]:
    """Name the numbers of the standard click of a clip."""
    result, where = seen.standard.score(seen.clip), (STANDARD, seen.clip.name)
    absent = answers_on_absent(seen.standard, seen.clip)
    return [
        Figure.of(where, "valid, %", result.valid_percent or 0.0, ROW, noise=100.0 / max(result.tight, 1)),
        Figure.of(where, "mean error, px", result.mean_error_px, ERROR),
        Figure.of(where, "lost", result.lost, COUNT),
        Figure.of(where, "answers on absent rows", absent, COUNT),
        Figure.of(where, "far answers", result.false_locks - absent, COUNT),
    ]


def nine_figures(seen: Seen) -> list[Figure]:
    """Name the numbers of nine clicks into a clip: each row of one of them counts."""
    where, rows = (NINE, seen.clip.name), sum(each.tight for each in seen.nine)
    valid = float(np.mean([each.valid_percent or 0.0 for each in seen.nine]))
    return [
        Figure.of(where, "mean valid, %", valid, ROW, noise=max(100.0 * len(seen.nine) / max(rows, 1) / 2.0, 1.0)),
        Figure.of(where, "give nothing", sum(seen.nothing), NEVER),
    ]


def search_figures(seen: Seen) -> list[Figure]:
    """Name the numbers of the searches of a clip's labelled frames."""
    found, where = seen.detected, (SEARCH, seen.clip.name)
    if found is None:
        return []
    right = 100.0 * found.right / found.shown if found.shown else None
    return [
        Figure.of(where, "right, %", right, ROW, noise=100.0 / max(found.shown, 1)),
        Figure.of(where, "wrong", found.wrong, COUNT),
        Figure.of(where, "false", found.false, NEVER),
    ]


def together(seen: Sequence[Seen]) -> list[Figure]:
    """Name the numbers of all clips, each counting the same."""
    standard = [each.standard.score(each.clip) for each in seen]
    valid = [each.valid_percent or 0.0 for each in standard]
    errors = [each.mean_error_px for each in standard if each.mean_error_px is not None]
    absent = sum(answers_on_absent(each.standard, each.clip) for each in seen)
    nine = [np.mean([one.valid_percent or 0.0 for one in each.nine]) for each in seen]
    clicks = [nothing for each in seen for nothing in each.nothing]
    found = [each.detected for each in seen if each.detected is not None]
    right = [100.0 * each.right / each.shown for each in found if each.shown]
    return [
        Figure.of((STANDARD, ALL), "mean valid, %", float(np.mean(valid)), MEAN_SHARE),
        Figure.of((STANDARD, ALL), "least valid, %", min(valid), LEAST),
        Figure.of((STANDARD, ALL), "mean of means, px", float(np.mean(errors)) if errors else None, ERROR),
        Figure.of((STANDARD, ALL), "answers on absent rows", absent, COUNT),
        Figure.of((STANDARD, ALL), "far answers", sum(each.false_locks for each in standard) - absent, SOME),
        Figure.of((NINE, ALL), "mean valid, %", float(np.mean(nine)), MEAN_SHARE),
        Figure.of((NINE, ALL), "give nothing, %", 100.0 * float(np.mean(clicks)), NOTHING),
        Figure.of((SEARCH, ALL), "mean right, %", float(np.mean(right)) if right else None, MEAN_SHARE),
        Figure.of((SEARCH, ALL), "false", sum(each.false for each in found), NEVER),
    ]


def foreign_figures(tallies: Sequence[Tally]) -> list[Figure]:
    """Count the answers to searches for colors that are not there, by color."""
    figures = []
    for color in sorted({tally.color for tally in tallies}):
        false = sum(len(tally.false) for tally in tallies if tally.color == color)
        figures.append(Figure.of((FOREIGN, color), "false locks", false, COUNT))
    every = sum(len(tally.false) for tally in tallies)
    return [*figures, Figure.of((FOREIGN, ALL), "false locks", every, COUNT)]
