"""``python -m benchmarks.soak``: fly for hours of simulated time; exit code 1 at the first violation."""

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from benchmarks.soak.fly import Flown, Violation, fly
from benchmarks.soak.plan import Plan, make_plan
from benchmarks.soak.report import Totals, print_table
from benchmarks.soak.resources import ResourceParameters, growth, largest, measure

HOUR = 3600.0  # s


def soak(
    plans: Iterable[Plan], seconds: float, say: Callable[[str], None], limits: ResourceParameters | None = None
) -> Totals:
    """Fly plan after plan until so much time is simulated, or to the first violation.

    Parameters
    ----------
    plans : iterable of Plan
    seconds : float
        Simulated time, s.
    say : callable
        Gets a line after each flight.
    limits : ResourceParameters, optional
    """
    limits, totals = limits or ResourceParameters(), Totals()
    with tempfile.TemporaryDirectory(prefix="soak") as folder:
        for plan in plans:
            warm = totals.flown.simulated < limits.warm_up
            flown = fly(plan, Path(folder))
            totals.add(plan, flown)
            totals.violation = flown.violation or _look_at_resources(plan, warm, totals, limits)
            say(_line(plan, flown, totals))
            if totals.violation is not None or totals.flown.simulated >= seconds:
                break
    return totals


def _look_at_resources(plan: Plan, warm: bool, totals: Totals, limits: ResourceParameters) -> Violation | None:
    """Compare what is held with what is normal."""
    held = measure()
    if warm or totals.normal is None:
        totals.normal = held if totals.normal is None else largest(totals.normal, held)
        return None
    totals.most = held if totals.most is None else largest(totals.most, held)
    grown = growth(totals.normal, held, limits)
    return Violation(plan.seed, plan.number, 0, f"resources: {grown}") if grown else None


def _line(plan: Plan, flown: Flown, totals: Totals) -> str:
    kinds = ", ".join(f"{count} {kind}" for kind, count in plan.count().items() if count)
    held = totals.most or totals.normal
    return (
        f"flight {plan.number}: {flown.simulated:.1f} s in {flown.took:.1f} s"
        f"{', recorded' if plan.recorded else ''}; faults: {kinds or 'none'}; "
        f"{'VIOLATION' if totals.violation else 'held'}; so far {totals.flown.simulated / 60.0:.1f} min"
        f"{'' if held is None else f', {held.memory:.0f} MB'}"
    )


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.soak", description=__doc__)
    parser.add_argument("--hours", type=float, default=1.0, help="simulated time (default: 1)")
    parser.add_argument("--seed", type=int, default=0, help="decides all flights (default: 0)")
    parser.add_argument("--flight", type=int, default=None, help="only this flight of the seed, as after a violation")
    parser.add_argument("--first", type=int, default=0, help="number of the first flight (default: 0)")
    parser.add_argument("--quiet", action="store_true", help="no line after each flight")
    return parser.parse_args()


def main() -> int:
    """Run the command line; returns the exit code."""
    options = _arguments()
    numbers: Iterable[int] = iter(range(options.first, sys.maxsize))
    if options.flight is not None:
        numbers = (options.flight,)

    def say(line: str) -> None:
        if not options.quiet:
            print(line, flush=True)

    totals = soak((make_plan(options.seed, number) for number in numbers), HOUR * options.hours, say)
    print_table(totals)
    return 0 if totals.violation is None else 1


if __name__ == "__main__":
    sys.exit(main())
