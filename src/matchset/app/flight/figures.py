"""What a flight was worth, in numbers: a row of words per follower."""

import numpy as np
import numpy.typing as npt

from matchset.app.flight.flight import SETTLING
from matchset.app.flight.log import PHASES, FlightLog

Floats = npt.NDArray[np.float64]

HEADINGS = (
    "",
    "pictures",
    "ball found where it was to be seen",
    "losses",
    "longest, s",
    "error of the circle, px (mean, 95 %)",
    f"off the set place, cm rms, from {SETTLING:g} s after its start on (side, height, heading)",
    "age, ms (median, 95 %)",
    "computing, µs (median)",
    "at the end",
)


def follower_figures(log: FlightLog, number: int) -> tuple[str, ...]:
    """Say one follower's figures, in the order of `HEADINGS`.

    Parameters
    ----------
    log : FlightLog
    number : int
        From 0.
    """
    follower, figures = log.followers[number], log.tally.followers[number]
    to_see, error = follower.inside, follower.error_px[np.isfinite(follower.error_px)]
    age = 1000.0 * follower.age[np.isfinite(follower.age)]
    spent = 1e6 * follower.processing[np.isfinite(follower.processing)]
    off = 100.0 * log.spread(number)
    return (
        f"{number + 1} watches {number + 2}",
        str(figures.frames),
        f"{100.0 * float(follower.found[to_see].mean()):.1f} %" if to_see.any() else "-",
        str(figures.losses),
        f"{figures.longest:.2f}",
        f"{error.mean():.2f}, {np.percentile(error, 95):.2f}" if len(error) else "-",
        ", ".join(f"{value:.1f}" for value in off.tolist()) or "-",
        f"{np.median(age):.0f}, {np.percentile(age, 95):.0f}" if len(age) else "-",
        f"{np.median(spent):.0f}" if len(spent) else "-",
        _end(log, number),
    )


def verdict(log: FlightLog) -> str:
    """Say in one sentence how the flight ended."""
    time = f"{log.tally.time:.1f} s"
    if log.crashes:
        return f"{time}; " + "; ".join(each.words for each in log.crashes)
    if not log.tally.ticks:
        return "nothing was flown"
    down = [str(k + 1) for k, follower in enumerate(log.followers) if PHASES[follower.phase[-1]] == "cut"]
    if down:
        return f"{time}; vehicle {' and '.join(down)} came down along the safety path"
    spread = [value for k in range(len(log.followers)) for value in log.spread(k).tolist()]
    if not spread:
        return f"{time}, nobody crashed"
    return f"{time}, nobody crashed; worst axis {100.0 * max(spread):.1f} cm rms off the set place"


def _end(log: FlightLog, number: int) -> str:
    for crash in log.crashes:
        if crash.vehicle == number + 1:
            return f"{crash.what} at {crash.time:.1f} s"
    phase = log.followers[number].phase
    return PHASES[phase[-1]] if len(phase) else "-"
