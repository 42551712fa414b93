"""Scores of many flights in rows, one row for each value of a constant; the rows as a table; the verdict."""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore
from matchset.flight.simulate.variation import Axis, FlightCase, quantity
from matchset.numeric.arguments import require, require_share

HEADER = (
    "seed,end,survived,reason,in_view,found,losses,worst_spread,settled,processing_us,"
    "side_rms,height_rms,heading_rms,varied"
)
"""Columns of ``flights.csv`` after the constants: of the worst follower, s, m; what was varied alone, or all."""
HEADINGS = [
    *("constant", "value", "survived", "in view, least", "losses"),
    *("side", "height", "heading", "worst axis", "settled, worst"),
]
"""Columns of the table."""
TERMINAL_HEADINGS = ["constant", "value", "survived", "side", "height", "heading", "worst, cm"]
ALL = "all at once"
THIRDS = 3  # format: parts of a range that have a row each


class RowLimits(msgspec.Struct, frozen=True, kw_only=True):
    """What every row of the table must reach.

    Parameters
    ----------
    survival : float
        Smallest share of flights that fly to the end.
    in_view : float
        Smallest share of pictures with the ball in view, of any follower of any flight.
    spread : float
        Largest root mean square of position minus set place, of any axis of any follower of any flight, m.
    """

    survival: float = 1.0
    in_view: float = 0.99
    spread: float = 0.10

    def __post_init__(self) -> None:
        require_share(self, ("survival", "in_view"))
        require(self, ("spread",), lambda value: value > 0.0, "positive")


class Flown(NamedTuple):
    """One flight: what was varied, and its score."""

    case: FlightCase
    score: FlightScore


class SweepRow(msgspec.Struct, frozen=True, kw_only=True):
    """All flights at one value of a constant, or with all constants drawn at random.

    Parameters
    ----------
    scores : tuple of FlightScore
    name : str
        The constant, or what else they have in common.
    value : str
        Its value in words.
    judged : bool
        Whether limits count: not for a part of another row's flights.
    """

    scores: tuple[FlightScore, ...]
    name: str = ""
    value: str = ""
    judged: bool = True

    @property
    def survived(self) -> int:
        """Number of flights that flew to the end."""
        return sum(score.survived for score in self.scores)

    @property
    def in_view(self) -> float:
        """Smallest share of pictures with the ball in view, of any follower of any flight."""
        return min((share for score in self.scores for share in score.in_view), default=0.0)

    @property
    def spread(self) -> float:
        """Largest spread of any axis, m; inf if there is none."""
        return max((score.worst_spread for score in self.scores), default=math.inf)

    @property
    def losses(self) -> int:
        """Number of losses of the ball, in all flights together."""
        return sum(sum(score.losses) for score in self.scores)

    def median_spread(self, axis: int) -> float:
        """Median over flights and followers of the spread of an axis, m; inf if there is none."""
        values = [each[axis] for score in self.scores for each in score.spread]
        return float(np.median(values)) if values else math.inf

    def violation(self, limits: RowLimits) -> str:
        """Name the first limit that does not hold; empty if all hold."""
        count = len(self.scores)
        if not count or self.survived < limits.survival * count:
            return f"only {self.survived} of {count} flights survive"
        if self.in_view < limits.in_view:
            return f"the ball is in view for only {100.0 * self.in_view:.1f} % of a flight"
        if self.spread > limits.spread:
            return f"the place is held to {100.0 * self.spread:.1f} cm rms only"
        return ""


def rows_of(flown: Sequence[Flown], axes: Sequence[Axis] = ()) -> list[SweepRow]:
    """Group flights: a row for each value of each constant alone, one for those with all of them drawn at random.

    Parameters
    ----------
    flown : sequence of Flown
    axes : sequence of Axis
        What was drawn: of each, the flights in each third of its range are a row too, if none was flown alone.
    """
    alone = sorted({(each.case.alone, each.case.values[each.case.alone]) for each in flown if each.case.alone})
    rows = [
        SweepRow(
            name=name,
            value=f"{value:.4g}",
            scores=tuple(score for case, score in flown if case.alone == name and case.values[name] == value),
        )
        for name, value in alone
    ]
    drawn = [each for each in flown if not each.case.alone]
    if not drawn:
        return rows
    for axis in [] if alone else axes:
        ends = np.linspace(axis.low, axis.high, 1 + THIRDS) if axis.low < axis.high else np.array([])
        places = [int(np.searchsorted(ends[1:-1], each.case.values[axis.name])) for each in drawn]
        for k, (low, high) in enumerate(itertools.pairwise(ends)):
            part = tuple(each.score for each, place in zip(drawn, places, strict=True) if place == k)
            if part:
                rows.append(SweepRow(name=axis.name, value=f"{low:.3g} to {high:.3g}", scores=part, judged=False))
    return [*rows, SweepRow(name=ALL, value="drawn", scores=tuple(each.score for each in drawn))]


def csv_header(axes: Sequence[Axis]) -> str:
    """Write the columns of ``flights.csv``."""
    return ",".join([*(axis.name for axis in axes), HEADER])


def csv_line(axes: Sequence[Axis], flown: Flown) -> str:
    """Write one flight as a line of CSV, with the columns of `csv_header`; a constant left alone is nominal."""
    score, values = flown.score, flown.case.values
    reason = (score.crash or score.landing_reason).replace(",", ";")
    spread = f"{score.worst_spread:.4f}" if math.isfinite(score.worst_spread) else ""
    settled = f"{score.settling_time:.2f}" if math.isfinite(score.settling_time) else ""
    rms = [f"{max(each[axis] for each in score.spread):.4f}" if score.spread else "" for axis in range(3)]
    varied = [f"{values[axis.name]:.6g}" if axis.name in values else _nominal(axis.name) for axis in axes]
    return ",".join(
        [
            *varied,
            f"{score.seed},{score.end:.2f},{int(score.survived)},{reason},{min(score.in_view):.4f},{min(score.found):.4f}",
            f"{sum(score.losses)},{spread},{settled},{1e6 * score.processing:.0f}",
            *rms,
            flown.case.alone or "all",
        ]
    )


def _nominal(name: str) -> str:
    """Write what a constant is when it is not varied; empty if it is what it is told to be."""
    default = quantity(name).default
    return "" if default is None else f"{default:.6g}"


def cells(row: SweepRow) -> list[str]:
    """Write a row, one text for each of `HEADINGS`; accuracy and settling are those of the flights that survived."""
    whole = SweepRow(scores=tuple(score for score in row.scores if score.survived))
    slowest = max((score.settling_time for score in whole.scores), default=math.inf)
    return [
        row.name,
        row.value,
        f"{row.survived} of {len(row.scores)}",
        f"{100.0 * row.in_view:.1f} %",
        f"{row.losses}",
        *(centimeters(whole.median_spread(axis)) for axis in range(3)),
        centimeters(whole.spread),
        f"{slowest:.1f} s" if math.isfinite(slowest) else "never",
    ]


def terminal_cells(row: SweepRow) -> list[str]:
    """Write the part of a row that fits a terminal, one text for each of `TERMINAL_HEADINGS`."""
    every = cells(row)
    return [*every[:3], *(each.removesuffix(" cm") for each in every[5:9])]


def markdown_table(rows: Sequence[SweepRow]) -> str:
    """Write rows as a Markdown table."""
    lines = [" | ".join(each) for each in (HEADINGS, ["---", *["---:"] * (len(HEADINGS) - 1)], *map(cells, rows))]
    return "\n".join(f"| {line} |" for line in lines)


def centimeters(value: float) -> str:
    """Write a length, m, in cm; ``-`` if it is not finite."""
    return f"{100.0 * value:.1f} cm" if math.isfinite(value) else "-"


def sweep_verdict(rows: Sequence[SweepRow], flight: FlightParameters, limits: RowLimits) -> tuple[bool, str]:
    """Compare all rows that are judged with the limits.

    Parameters
    ----------
    rows : sequence of SweepRow
    flight : FlightParameters
        Of all flights, but for seed and what is varied.
    limits : RowLimits

    Returns
    -------
    bool
        Whether every row holds every limit.
    str
        One sentence.
    """
    judged = [row for row in rows if row.judged]
    if not judged:
        return False, "No flight was flown, so there is no verdict."
    flown, world = sum(len(row.scores) for row in judged), flight.world
    seen = "without pictures" if world.quick else f"with {world.pal} PAL"
    what = f"{flown} flights of {flight.duration:g} s, a chain of {world.vehicles} {seen}"
    violations = [(row, row.violation(limits)) for row in judged if row.violation(limits)]
    if violations:
        row, text = violations[0]
        more = f" (and the limits break in {len(violations) - 1} more rows)" if len(violations) > 1 else ""
        return False, f"Limits do not hold: in {what}, with {row.name} {row.value}: {text}{more}."
    worst, least = max(row.spread for row in judged), min(row.in_view for row in judged)
    alive = sum(row.survived for row in judged)
    first, last = (f"{row.name} {row.value}" for row in (judged[0], judged[-1]))
    where = first if len(judged) == 1 else f"{first} to {last}"
    return True, (
        f"Limits hold: of {what}, {alive} survive, {where}, with the ball in view for at least {100.0 * least:.1f} % "
        f"and places held to {centimeters(worst)} rms."
    )
