"""Everybody on real footage: the clips of `--data DIR`, scored by their truth files."""

from collections.abc import Mapping, Sequence

import msgspec

from benchmarks.contest.field import OURS, PEERS, missing, peer
from benchmarks.contest.run import follow_real_clip
from benchmarks.options import Options
from benchmarks.real.clips import Clip, find_clips
from benchmarks.results import Figure, Finding, Section, table
from benchmarks.tracking.accuracy import figures
from benchmarks.workers import spread
from matchset.app.track.score import Score, score

QUICK_PEERS = ("matchset", "region_bgr", "contour_moments")
TITLE = "Real footage, beside what people use"


class Heat(msgspec.Struct, frozen=True):
    """A clip to be followed by several peers, and their keys."""

    clip: Clip
    peers: tuple[str, ...]


def run(options: Options) -> Section:
    """Follow every clip that has a truth."""
    clips, skipped = find_clips(options.data)
    if not clips:
        nothing = Finding(name="contest_real", what="; ".join(skipped), figures=())
        return Section(TITLE, [nothing], "Skipped: the real clips are not here.")
    keys = tuple(key for key in (QUICK_PEERS if options.quick else PEERS) if not missing(key))
    every = spread(scored, [Heat(clip, keys) for clip in clips], options.jobs)
    findings, tables = [], [pooled_table(every)] if len(clips) > 1 else []
    for clip, scores in zip(clips, every, strict=True):
        findings.append(_finding(clip.name, scores))
        rows = [[peer(key).name, *(figure.text for figure in figures(each))] for key, each in scores.items()]
        head = ["", *(figure.name for figure in figures(scores[OURS]))]
        tables.append(f"\n**{clip.name}**, {scores[OURS].tight} rows with the ball well known\n\n{table(head, rows)}")
    text = (
        "Everybody is told the circle of the first row with the ball well known, matchset a click on its left half; "
        "that row itself does not count. The peers' parameters are those of the rendered sequences, their color is "
        "learned from the disc of that row. The truth is good to 0.5 px where sharp, to 1-2 px where blurred.\n"
    )
    notes = "".join(f"- {each}\n" for each in skipped)
    return Section(TITLE, findings, text + "\n".join(tables) + (f"\n{notes}" if notes else ""))


def scored(heat: Heat) -> dict[str, Score]:
    """Follow a clip with some peers and score them."""
    clip = heat.clip
    answers = follow_real_clip(clip, [peer(key) for key in heat.peers])
    return {key: score(each, clip.truths, start=clip.tight[0].frame + 1) for key, each in answers.items()}


def pooled_table(every: Sequence[Mapping[str, Score]]) -> str:
    """Write what everybody reached on all clips together, each clip counting the same.

    *Mean* and *median* are means over the clips in which a peer answered at all, so they mean little where it is
    valid in few.
    """
    rows = []
    for key in every[0]:
        own = [scores[key] for scores in every]
        valid = [each.valid_percent or 0.0 for each in own]
        cells = (
            Figure("mean", _mean([each.mean_error_px for each in own]), "px", 3),
            Figure("median", _mean([each.median_error_px for each in own]), "px", 3),
            Figure("valid", _mean(valid), "%", 2),
            Figure("least valid", min(valid), "%", 2),
            Figure("lost", _mean([each.lost_percent for each in own]), "%", 2),
            Figure("false locks", sum(each.false_locks for each in own), "", 0),
        )
        rows.append([peer(key).name, *(figure.text for figure in cells)])
    tight = sum(scores[OURS].tight for scores in every)
    head = ["", *(figure.name for figure in cells)]
    return f"\n**{len(every)} clips**, {tight} rows with the ball well known, each clip alike\n\n{table(head, rows)}"


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return sum(known) / len(known) if known else None


def _finding(name: str, scores: dict[str, Score]) -> Finding:
    others = {key: s.valid_percent or 0.0 for key, s in scores.items() if key != OURS}
    best = max(others, key=lambda key: others[key])
    return Finding(
        name=f"contest_{name}",
        what=f"`{name}`, everybody from the same first row; most valid of the others: {peer(best).name}",
        figures=(
            Figure("mean", scores[OURS].mean_error_px, "px", 2),
            Figure("valid", scores[OURS].valid_percent, "%", 1),
            Figure("its mean", scores[best].mean_error_px, "px", 2),
            Figure("its valid", others[best], "%", 1),
        ),
    )
