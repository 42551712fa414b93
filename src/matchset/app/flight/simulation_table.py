"""Flights at several values of one parameter: grouped (`rows_by_value`), as a table (`markdown_table`), judged."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from matchset.app.flight.flight import FlightParameters
from matchset.app.flight.score import FlightScore

HEADER = "seed,end,survived,reason,in_view,found,losses,worst_spread,settled,processing_us"


class Limits(msgspec.Struct, frozen=True, kw_only=True):
    """What every row of the table must reach.

    Parameters
    ----------
    survival : float
        Least share of flights that fly to the end.
    in_view : float
        Least share of pictures with the ball in view, of any follower of any flight.
    spread : float
        Largest root mean square of place minus set place, of any axis of any follower of any flight, m.
    """

    survival: float = 1.0
    in_view: float = 0.99
    spread: float = 0.10

    def __post_init__(self) -> None:
        for name in ("survival", "in_view"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"{name} must be within 0 ... 1, got {getattr(self, name)}")
        if not self.spread > 0.0:
            raise ValueError(f"spread must be positive, got {self.spread}")


class SweepRow(msgspec.Struct, frozen=True, kw_only=True):
    """All flights at one value of what was swept.

    Parameters
    ----------
    value : float
    scores : tuple of FlightScore
    """

    value: float
    scores: tuple[FlightScore, ...]

    @property
    def survived(self) -> int:
        """How many flew to the end."""
        return sum(score.survived for score in self.scores)

    @property
    def in_view(self) -> float:
        """Least share of pictures with the ball in view."""
        return min((share for score in self.scores for share in score.in_view), default=0.0)

    @property
    def spread(self) -> float:
        """Largest spread of any axis, m."""
        return max((score.worst_spread for score in self.scores), default=math.inf)

    @property
    def losses(self) -> int:
        """How often a ball was lost, in all flights together."""
        return sum(sum(score.losses) for score in self.scores)

    def median_spread(self, axis: int) -> float:
        """Median over flights and followers of the spread of an axis, m; inf if there is none."""
        values = [each[axis] for score in self.scores for each in score.spread]
        return float(np.median(values)) if values else math.inf

    def violation(self, limits: Limits) -> str:
        """Say which limit does not hold, empty if all do."""
        count = len(self.scores)
        if not count or self.survived < limits.survival * count:
            return f"only {self.survived} of {count} flights survive"
        if self.in_view < limits.in_view:
            return f"the ball is in view for only {100.0 * self.in_view:.1f} % of a flight"
        if self.spread > limits.spread:
            return f"the place is held to {100.0 * self.spread:.1f} cm rms only"
        return ""


def rows_by_value(values: Sequence[float], done: Sequence[tuple[float, FlightScore]]) -> list[SweepRow]:
    """Group scores by value; values without a flight are left out."""
    groups = [(value, tuple(score for at, score in done if at == value)) for value in values]
    return [SweepRow(value=value, scores=scores) for value, scores in groups if scores]


def csv_line(score: FlightScore) -> str:
    """One flight as a line of CSV, in the order of `HEADER`."""
    reason = (score.crash or score.landing_reason).replace(",", ";")
    spread = f"{score.worst_spread:.4f}" if math.isfinite(score.worst_spread) else ""
    settling_time = f"{score.settling_time:.2f}" if math.isfinite(score.settling_time) else ""
    return (
        f"{score.seed},{score.end:.2f},{int(score.survived)},{reason},{min(score.in_view):.4f},{min(score.found):.4f},"
        f"{sum(score.losses)},{spread},{settling_time},{1e6 * score.processing:.0f}"
    )


def markdown_table(name: str, unit: str, rows: Sequence[SweepRow]) -> str:
    """Show rows as a Markdown table."""
    label = name.removesuffix("_ms").removesuffix("_deg") + (f", {unit}" if unit else "")
    lines = [
        f"| {label} | survived | in view, least | losses | side | height | heading | worst axis | settled, worst |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for row in rows:
        axes = " | ".join(centimeters(row.median_spread(axis)) for axis in range(3))
        slowest = max(score.settling_time for score in row.scores)
        when = f"{slowest:.1f} s" if math.isfinite(slowest) else "never"
        lines.append(
            f"| {row.value:g} | {row.survived} of {len(row.scores)} | {100.0 * row.in_view:.1f} % | {row.losses} "
            f"| {axes} | {centimeters(row.spread)} | {when} |"
        )
    return "\n".join(lines)


def centimeters(value: float) -> str:
    """Say a length, m, in cm."""
    return f"{100.0 * value:.1f} cm" if math.isfinite(value) else "-"


def verdict(
    name: str, unit: str, rows: Sequence[SweepRow], flight: FlightParameters, limits: Limits
) -> tuple[bool, str]:
    """Judge all rows.

    Returns
    -------
    bool
        Whether every row holds every limit.
    str
        One sentence.
    """
    world = flight.world
    flown = sum(len(row.scores) for row in rows)
    what = f"{flown} flights of {flight.duration:g} s, a chain of {world.vehicles} with {world.pal} PAL"
    wrong = [(row, row.violation(limits)) for row in rows if row.violation(limits)]
    label = name.removesuffix("_ms").removesuffix("_deg")
    if not rows:
        return False, "No flight was flown, so there is no verdict."
    if wrong:
        row, words = wrong[0]
        more = f" (and the limits break in {len(wrong) - 1} more rows)" if len(wrong) > 1 else ""
        return False, f"Limits do not hold: in {what}, at {label} {row.value:g} {unit}".rstrip() + f" {words}{more}."
    worst, least = max(row.spread for row in rows), min(row.in_view for row in rows)
    return True, (
        f"Limits hold: all {what}, survive at {label} {rows[0].value:g} to {rows[-1].value:g} {unit}".rstrip()
        + f", with the ball in view for at least {100.0 * least:.1f} % and places held to {centimeters(worst)} rms."
    )
