"""The page `benchmarks/REAL.md`, written of what is kept: `markdown`."""

import math
from collections.abc import Sequence
from pathlib import Path

from benchmarks.regression.figures import EXCEPTIONS, KINDS, Figure
from benchmarks.regression.kept import Kept
from benchmarks.regression.sections import SECTIONS
from benchmarks.results import table

PAGE = Path(__file__).resolve().parents[1] / "REAL.md"
HEAD = """# Real footage and time

What `make bench-real` measured last and compares with. Written by `python -m benchmarks.regression --store`.
Accuracy hangs on neither the machine nor the hour, times hang on both. *Valid* rows have an error below 5 px.
"""


def markdown(kept: Kept) -> str:
    """Write all figures, section by section, and by clip."""
    parts = [HEAD]
    for name, section in SECTIONS.items():
        origin = kept.sections.get(name)
        if origin is None:
            continue
        parts.append(f"## {name.replace('_', ' ').capitalize()}\n\n{section.how}\n")
        parts.append(f"{origin.date}, commit {origin.commit}, {origin.machine}; {origin.seconds:.0f} s.\n")
        for key in section.figures:
            figures = [figure for figure in kept.figure if figure.section == key]
            if figures:
                parts.append(f"### {key.capitalize()}\n\n{by_subject(figures)}")
        raised = [figure for figure in kept.figure if figure.key == (EXCEPTIONS, name, "raised")]
        parts += [f"Exceptions of `update`, `detect` and `pick`: {figure.value:.0f}.\n" for figure in raised]
    reasons = [[each.better, f"{each.noise:g}", f"{each.factor:g}", each.why] for each in KINDS]
    parts.append("## What counts as noise\n\n" + table(["better", "worse by", "times", "why"], reasons))
    return "\n".join(parts)


def by_subject(figures: Sequence[Figure]) -> str:
    """Write figures as a table, one row for each subject."""
    names = list(dict.fromkeys(figure.name for figure in figures))
    known = {(figure.subject, figure.name): figure for figure in figures}
    rows = []
    for subject in dict.fromkeys(figure.subject for figure in figures):
        cells = [known.get((subject, name)) for name in names]
        rows.append([subject, *("-" if each is None else number(each.value, each.name) for each in cells)])
    return table(["", *names], rows)


def number(value: float, name: str) -> str:
    """Write a value with as many decimals as its unit asks for."""
    if math.isnan(value):
        return "-"
    for unit, digits in ((", %", 1), (", px", 2), (", ms", 2), ("area", 2), ("own", 2)):
        if name.endswith(unit):
            return f"{value:.{digits}f}"
    return f"{value:g}"
