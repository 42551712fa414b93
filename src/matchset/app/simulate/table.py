"""Scores of many flights in rows, one row for each value of the swept parameter; the rows as a table; the verdict."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from matchset.app.flight.flight import FlightParameters
from matchset.app.flight.score import FlightScore

HEADER = "seed,end,survived,reason,in_view,found,losses,worst_spread,settled,processing_us"
"""Columns of ``flights.csv`` after the swept value; `csv_line` writes them."""
UNITS = {"latency_ms": "ms", "swing": "m", "yaw_deg": "degrees", "bias_deg": "degrees", "hidden": "s", "start_off": "m"}
UNITS |= dict.fromkeys(
    ("cable", "freeze", "freeze_for", "stale", "stale_for", "stale_age", "silent", "silent_for"), "s"
)
"""Units of the parameters that can be swept, where they have one."""


class Limits(msgspec.Struct, frozen=True, kw_only=True):
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
        for name in ("survival", "in_view"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"{name} must be within 0 ... 1, got {getattr(self, name)}")
        if not self.spread > 0.0:
            raise ValueError(f"spread must be positive, got {self.spread}")


class SweepRow(msgspec.Struct, frozen=True, kw_only=True):
    """All flights at one value of the swept parameter.

    Parameters
    ----------
    value : float
    scores : tuple of FlightScore
    """

    value: float
    scores: tuple[FlightScore, ...]

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

    def violation(self, limits: Limits) -> str:
        """Name the first limit that does not hold; empty if all hold."""
        count = len(self.scores)
        if not count or self.survived < limits.survival * count:
            return f"only {self.survived} of {count} flights survive"
        if self.in_view < limits.in_view:
            return f"the ball is in view for only {100.0 * self.in_view:.1f} % of a flight"
        if self.spread > limits.spread:
            return f"the place is held to {100.0 * self.spread:.1f} cm rms only"
        return ""


def rows_by_value(values: Sequence[float], done: Sequence[tuple[float, FlightScore]]) -> list[SweepRow]:
    """Group scores by the swept value; values without a flight are left out."""
    groups = [(value, tuple(score for at, score in done if at == value)) for value in values]
    return [SweepRow(value=value, scores=scores) for value, scores in groups if scores]


def csv_line(score: FlightScore) -> str:
    """Write one flight as a line of CSV, with the columns of `HEADER`."""
    reason = (score.crash or score.landing_reason).replace(",", ";")
    spread = f"{score.worst_spread:.4f}" if math.isfinite(score.worst_spread) else ""
    settled = f"{score.settling_time:.2f}" if math.isfinite(score.settling_time) else ""
    return (
        f"{score.seed},{score.end:.2f},{int(score.survived)},{reason},{min(score.in_view):.4f},{min(score.found):.4f},"
        f"{sum(score.losses)},{spread},{settled},{1e6 * score.processing:.0f}"
    )


def markdown_table(name: str, rows: Sequence[SweepRow]) -> str:
    """Write rows as a Markdown table; `name` is the swept parameter."""
    heading = _without_unit(name) + (f", {UNITS[name]}" if name in UNITS else "")
    lines = [
        f"| {heading} | survived | in view, least | losses | side | height | heading | worst axis | settled, worst |",
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
    """Write a length, m, in cm; ``-`` if it is not finite."""
    return f"{100.0 * value:.1f} cm" if math.isfinite(value) else "-"


def sweep_verdict(name: str, rows: Sequence[SweepRow], flight: FlightParameters, limits: Limits) -> tuple[bool, str]:
    """Compare all rows with the limits.

    Parameters
    ----------
    name : str
        The swept parameter.
    rows : sequence of SweepRow
    flight : FlightParameters
        Of all flights, but for seed and swept value.
    limits : Limits

    Returns
    -------
    bool
        Whether every row holds every limit.
    str
        One sentence.
    """
    world, label, unit = flight.world, _without_unit(name), UNITS.get(name, "")
    flown = sum(len(row.scores) for row in rows)
    what = f"{flown} flights of {flight.duration:g} s, a chain of {world.vehicles} with {world.pal} PAL"
    violations = [(row, row.violation(limits)) for row in rows if row.violation(limits)]
    if not rows:
        return False, "No flight was flown, so there is no verdict."
    if violations:
        row, text = violations[0]
        more = f" (and the limits break in {len(violations) - 1} more rows)" if len(violations) > 1 else ""
        return False, f"Limits do not hold: in {what}, at {label} {row.value:g} {unit}".rstrip() + f" {text}{more}."
    worst, least = max(row.spread for row in rows), min(row.in_view for row in rows)
    return True, (
        f"Limits hold: all {what}, survive at {label} {rows[0].value:g} to {rows[-1].value:g} {unit}".rstrip()
        + f", with the ball in view for at least {100.0 * least:.1f} % and places held to {centimeters(worst)} rms."
    )


def _without_unit(name: str) -> str:
    """Return a parameter's name without its unit."""
    return name.removesuffix("_ms").removesuffix("_deg")
