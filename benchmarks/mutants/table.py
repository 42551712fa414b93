"""The table of docs/mutants.md: `write_table`."""

from pathlib import Path

from benchmarks.mutants.mutant import Mutant
from benchmarks.mutants.run import Outcome

BEGIN, END = "<!-- table: make mutants -->", "<!-- end of the table -->"


def table(mutants: list[Mutant], known: dict[str, Outcome]) -> str:
    """Return the table, and below it the mutants that lived."""
    lines = ["| list | mutants | run | noticed | | lived |", "| --- | ---: | ---: | ---: | ---: | ---: |"]
    alive: list[Mutant] = []
    total = [0, 0, 0]
    for group in sorted({mutant.group for mutant in mutants}):
        mine = [mutant for mutant in mutants if mutant.group == group]
        run = [(mutant, known[mutant.key()].verdict) for mutant in mine if mutant.key() in known]
        lived = [mutant for mutant, verdict in run if verdict == "alive"]
        alive += lived
        lines.append(_row(group, len(mine), len(run), len(lived)))
        total = [before + now for before, now in zip(total, (len(mine), len(run), len(lived)), strict=True)]
    lines.append(_row("all", *total))
    lines += ["", "Those that lived:" if alive else "None lived.", ""]
    lines += [f"- `{each.path}`: `{_short(each.before)}` became `{_short(each.after)}`" for each in alive]
    return "\n".join(lines).rstrip() + "\n"


def write_table(page: Path, mutants: list[Mutant], known: dict[str, Outcome]) -> None:
    """Replace the table of a page."""
    text = page.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    page.write_text(f"{before}{BEGIN}\n\n{table(mutants, known)}\n{END}{after}", encoding="utf-8")


def _row(name: str, count: int, run: int, lived: int) -> str:
    share = f"{100.0 * (run - lived) / run:.1f} %" if run else "-"
    return f"| {name} | {count} | {run} | {run - lived} | {share} | {lived} |"


def _short(text: str) -> str:
    return " ".join(text.split()).replace("`", "'").replace("|", "\\|")
