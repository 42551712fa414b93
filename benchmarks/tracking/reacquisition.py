"""How soon is the ball found again after a board has hidden all of it for one second."""

import math

import msgspec
import numpy as np

import matchset as ms
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.tracking.trial import FPS, as_truth, circle, clicked, sequence
from benchmarks.workers import spread
from matchset.app.track.score import VALID_BELOW_PX, error_px

BEFORE = 30
PATIENCE = 60
SEEDS, QUICK_SEEDS = 20, 6


class Return(msgspec.Struct, frozen=True):
    """What happened on one sequence.

    Parameters
    ----------
    seed : int
    frames : float
        The first visible frame that was answered with an error below 5 px, counted from 1; infinite: none.
    held : bool
        The ball was held in the last frame before it was hidden.
    false_locks : int
        Answers while it was hidden, and wrong ones after it.
    """

    seed: int
    frames: float
    held: bool
    false_locks: int


def run(options: Options) -> Section:
    """Hide the ball in a sequence for each of twenty seeds."""
    count = QUICK_SEEDS if options.quick else SEEDS
    returns = spread(watch, [options.seeds[0] + k for k in range(count)], options.jobs)
    frames = np.array([each.frames for each in returns])
    finding = Finding(
        name="reacquired",
        what=f"`typical`, frames until found after one second of full occlusion, {count} seeds",
        figures=(
            Figure("longest", float(frames.max()), "", 0),
            Figure("median", float(np.median(frames)), "", 1),
            Figure("false locks", sum(each.false_locks for each in returns), "", 0),
        ),
        bar=(Goal("longest", high=3.0),),
        prize=(Goal("longest", high=1.0),),
    )
    rows = [[str(r.seed), f"{r.frames:g}", "yes" if r.held else "no", str(r.false_locks)] for r in returns]
    text = (
        "1: found in the first frame that shows it again. Found: answered with an error below 5 px. While "
        "it is hidden it flies on.\n\n" + table(["seed", "frames", "held before", "false locks"], rows)
    )
    return Section("Re-acquisition", [finding], text)


def watch(seed: int) -> Return:
    """Follow a ball until it is hidden and found again."""
    clip = sequence("typical", seed, BEFORE + FPS + PATIENCE, hidden=((BEFORE, BEFORE + FPS),))
    tracker: ms.Tracker[ms.Circle] | None = None
    held, false_locks = False, 0
    for frame, seen in clip:
        tracker = tracker or clicked(frame, clip.first_click)
        answer = tracker.update(frame)
        truth = as_truth(seen).circle
        error = error_px(circle(answer.shape), truth) if isinstance(answer, ms.Track) and truth else math.nan
        if frame.index < BEFORE:
            held = error < VALID_BELOW_PX
        elif frame.index >= BEFORE + FPS and error < VALID_BELOW_PX:
            return Return(seed, float(frame.index - BEFORE - FPS + 1), held, false_locks)
        elif answer:
            false_locks += 1
    return Return(seed, math.inf, held, false_locks)
