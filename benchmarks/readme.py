"""The README's table and picture, taken from the results."""

import re
from pathlib import Path

from benchmarks.contest.summary import TITLE
from benchmarks.machine import Machine
from benchmarks.results import Section

BEGIN, END = "<!-- from benchmarks/RESULTS.md -->", "<!-- end -->"


def update(readme: Path, sections: list[Section], machine: Machine) -> bool:
    """Put the contest's table and picture between the two marks of a README; the rest stays.

    Parameters
    ----------
    readme : Path
    sections : list of Section
        If the summary is not among them, nothing is changed.
    machine : Machine
        Where they were measured.

    Returns
    -------
    bool
        Whether it was changed.
    """
    summary = next((section for section in sections if section.title == TITLE), None)
    if summary is None:
        return False
    pictures = [f"![{picture.caption}](benchmarks/pictures/{picture.file})\n" for picture in summary.pictures]
    lines = [BEGIN, *pictures, summary.text.strip() + "\n", f"*{machine.processor}, {machine.date}.*", END]
    text = readme.read_text(encoding="utf-8")
    block = "\n".join(lines)
    changed, count = re.subn(f"{re.escape(BEGIN)}.*?{re.escape(END)}", lambda _: block, text, flags=re.DOTALL)
    if count != 1:
        raise ValueError(f"{readme} has {count} places between {BEGIN!r} and {END!r}, not one")
    readme.write_text(changed, encoding="utf-8")
    return True
