"""``python -m benchmarks.mutants``: run what was not run yet, write the table; exit code 1 if too many live."""

import argparse
import sys
from pathlib import Path

from benchmarks.mutants.mutant import ROOT, Mutant, load
from benchmarks.mutants.run import Outcome, Runner
from benchmarks.mutants.table import table, write_table

# Chosen by hand: what moves motors is tested hardest, and a change must not lose that.
BARS = {"safety": 0.97, "links": 0.97, "firmware": 0.97}  # geometry: share of the mutants that must be noticed
BAR_OF_ALL = 0.9  # geometry: the same for all lists together


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__)
    parser.add_argument("lists", nargs="*", help="names of lists (benchmarks/mutants/*.toml); none for all")
    parser.add_argument("--jobs", type=int, default=1, help="how many at a time (default: 1)")
    parser.add_argument("--quick", action="store_true", help="only the subset that CI runs; all of it must be noticed")
    parser.add_argument("--again", action="store_true", help="run again what is known")
    parser.add_argument("--table", action="store_true", help="run nothing, only write the table")
    parser.add_argument("--limit", type=float, default=300.0, help="longest time of the tests of a mutant, s")
    parser.add_argument(
        "--folder", type=Path, default=ROOT / "build" / "mutants", help="where copies and results are kept"
    )
    return parser.parse_args()


def _missed(mutants: list[Mutant], known: dict[str, Outcome], quick: bool) -> list[str]:
    """Say of which lists too many lived."""
    missed = []
    verdicts = [(mutant.group, known[mutant.key()].verdict) for mutant in mutants if mutant.key() in known]
    for group, bar in [*BARS.items(), ("all", BAR_OF_ALL)]:
        mine = [verdict for name, verdict in verdicts if group in (name, "all")]
        share = 1.0 - mine.count("alive") / max(len(mine), 1)
        if share < (1.0 if quick else bar):
            missed.append(f"{group}: {100 * share:.1f} % of {len(mine)} noticed, {100 * bar:.0f} % wanted")
    return missed


def main() -> int:
    """Run the command line; returns the exit code."""
    options = _arguments()
    options.folder.mkdir(parents=True, exist_ok=True)
    runner = Runner(options.folder.resolve(), options.jobs, options.limit)
    mutants = [mutant for mutant in load(tuple(options.lists)) if mutant.quick or not options.quick]
    known = runner.known()
    left = [mutant for mutant in mutants if options.again or not runner.holds(mutant, known)]
    print(f"{len(mutants)} mutants, {len(left)} to run", flush=True)
    for count, outcome in enumerate(runner.run(left) if left and not options.table else (), 1):
        changed = f"{outcome.path}: {outcome.before!r} -> {outcome.after!r}"
        print(f"{count}/{len(left)} {outcome.verdict} {outcome.seconds:.1f} s  {changed[:150]}", flush=True)
    known = runner.known()
    print(table(mutants, known))
    if not options.quick and not options.lists:
        write_table(ROOT / "docs" / "mutants.md", mutants, known)
    unknown = sum(mutant.key() not in known for mutant in mutants)
    missed = _missed(mutants, known, options.quick)
    print("\n".join([*missed, f"{unknown} not run"] if unknown else missed))
    return 1 if missed or (unknown and options.quick) else 0


if __name__ == "__main__":
    sys.exit(main())
