"""The page of flights as text: `table_of`, of the rows that were flown, `judge`, `remarks`."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from benchmarks.flight.flown import Flown
from benchmarks.flight.rows import WHOLE, Row
from matchset.flight.chain.score import FlightScore
from matchset.flight.simulate.table import SweepRow, centimeters

HEADINGS = ("what", "bar", "flown", "survive", "side", "height", "heading", "worst flight", "median flight")
HEADING = "\n".join(
    f"| {' | '.join(each)} |"
    for each in ((*HEADINGS, "reached", "besides"), ("---", "---", *["---:"] * (len(HEADINGS) - 2), "---", "---"))
)
EXPLAINED = (
    "Side, height, heading: rms off the set place, medians over followers and flights. Worst and median flight: its "
    "worst axis of any follower. All of the flights that survive. A row of which flights are missing is judged by "
    'those that were flown, "so far".'
)


def whole_of(flown: Sequence[Flown]) -> SweepRow:
    """Return those that survived, whose spread counts."""
    return SweepRow(scores=tuple(each.score for each in flown if each.score.survived))


def judge(row: Row, flown: Sequence[Flown]) -> bool:
    """Whether flights of a row reach its bar."""
    every, whole = SweepRow(scores=tuple(each.score for each in flown)), whole_of(flown)
    count = len(every.scores)
    if row.kind == "crash":
        return not any(score.crash for score in every.scores)
    if row.kind == "settle":
        return every.survived == count and all(score.settling_time <= row.limit for score in every.scores)
    if row.kind == "descent":
        return all(delay <= row.limit for delay in descents(row, every.scores))
    return (
        20 * every.survived >= row.survive * count and 100.0 * whole.spread <= row.rms and every.in_view >= row.in_view
    )


def descents(row: Row, scores: Sequence[FlightScore]) -> list[float]:
    """Return the times from the pulled cable to the first command of a descent, s."""
    return [score.descent_time - row.world["cable"] for score in scores]


def remarks(row: Row, flown: Sequence[Flown]) -> list[str]:
    """Say what else there is to say of a row."""
    scores, parts = [each.score for each in flown], []
    if row.in_view:
        parts.append(f"in view {100.0 * SweepRow(scores=tuple(scores)).in_view:.1f} % at least")
    if row.kind == "settle":
        times = [score.settling_time for score in scores]
        worst = f"{max(times):.1f} s at worst" if math.isfinite(max(times)) else "one never did"
        parts.append(f"settled after {float(np.median(times)):.1f} s (median), {worst}")
    if row.kind == "descent":
        parts.append(f"descent begins {max(descents(row, scores)):.2f} s after the cable at the latest")
    noticed = [each.noticed for each in flown if math.isfinite(each.noticed)]
    if noticed or row.level_gains != 1.0:
        when = f", after {float(np.median(noticed)):.0f} s (median)" if noticed else ""
        parts.append(f"swings noticed in {len(noticed)} of {len(flown)}{when}")
    crashed = [score.seed for score in scores if score.crash]
    landed = [score.seed for score in scores if score.landing_reason and not score.crash]
    parts += [f"crashed: {_numbers(crashed)}"] if crashed else []
    return parts + ([f"landed: {_numbers(landed)}"] if landed and row.kind != "descent" else [])


def line_of(row: Row, flown: Sequence[Flown], planned: int, duration: float) -> str:
    """Write a row of the table.

    Parameters
    ----------
    row : Row
    flown : sequence of Flown
    planned : int
        How many flights it is to have.
    duration : float
        Longest length of a flight, s.
    """
    length = min(duration, row.duration)
    what = row.words + (f", {length:g} s" if length != WHOLE else "")
    start = [what, row.bar, f"{len(flown)} of {planned}"]
    if not flown:
        return f"| {' | '.join([*start, *['-'] * 6, 'not flown', ''])} |"
    whole = whole_of(flown)
    worst = [score.worst_spread for score in whole.scores]
    spread = [*(whole.median_spread(axis) for axis in range(3)), whole.spread]
    spread.append(float(np.median(worst)) if worst else math.inf)
    reached = "yes" if judge(row, flown) else "**no**"
    reached += " so far" if len(flown) < planned else ""
    if row.kind == "spread" and math.isfinite(row.rms) and worst and not math.isfinite(max(worst)):
        reached = "too short"
    cells = [*start, f"{len(whole.scores)} of {len(flown)}", *map(centimeters, spread), reached]
    return f"| {' | '.join([*cells, '; '.join(remarks(row, flown))])} |"


def table_of(
    every: Sequence[Row], flown: Mapping[str, Sequence[Flown]], asked: Sequence[Row], planned: int, duration: float
) -> str:
    """Write the table: rows that were asked for, and others of which there are flights; the rest by name below.

    Parameters
    ----------
    every : sequence of Row
    flown : mapping from str to sequence of Flown
        By the row's name.
    asked : sequence of Row
    planned : int
        Flights of a row.
    duration : float
        Longest length of a flight, s.
    """
    shown = [row for row in every if row in asked or flown.get(row.name)]
    lines = [HEADING, *(line_of(row, flown.get(row.name, ()), planned, duration) for row in shown), "", EXPLAINED]
    rest = [row.name for row in every if row not in shown]
    return "\n".join([*lines, *(["", f"Not flown: {', '.join(rest)}."] if rest else [])])


def seeds_text(seeds: Sequence[int]) -> str:
    """Write 1000, 1001, 1002 as ``1000-1002``, and what has gaps with commas."""
    if len(seeds) > 1 and list(seeds) == list(range(seeds[0], seeds[-1] + 1)):
        return f"{seeds[0]}-{seeds[-1]}"
    return ", ".join(map(str, seeds))


def _numbers(seeds: Sequence[int]) -> str:
    return ", ".join(map(str, sorted(seeds)))
