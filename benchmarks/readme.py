"""The README's table of results, taken from the page of results: `python -m benchmarks.readme` fills it in again."""

import re
from pathlib import Path

from benchmarks.results import table

BEGIN, END = "<!-- from benchmarks/RESULTS.md -->", "<!-- end -->"
RENDERED, REAL = "In one table", "Real footage, beside what people use"
# The rows of the README: matchset, the fastest region, the most exact simple detector, and one of each other kind.
ROWS = (
    "matchset",
    "region + HSV mask, contour, moments",
    "scikit-image: RANSAC CircleModel on the contour",
    "ViSP vpMeEllipse",
    "EdgeDrawing (EDCircles), gray whole frame",
    "HoughCircles (gradient), gray whole frame",
    "CSRT",
    "the paper to the letter (NumPy)",
)
COLUMNS = {  # column of the README -> title of the chapter, its column
    "time, × ours": (RENDERED, "× ours"),
    "valid, rendered": (RENDERED, "valid, all sequences"),
    "valid, real": (REAL, "valid"),
}
TIME = (RENDERED, "time")  # of the first row: what the others are multiples of


def update(readme: Path, results: Path) -> None:
    """Put the table between the two marks of a README; the rest stays.

    Parameters
    ----------
    readme, results : Path

    Raises
    ------
    ValueError
        If the README has no place for it, or the results lack a chapter, a column or a row.
    """
    text = readme.read_text(encoding="utf-8")
    filled = f"{BEGIN}\n{block(results.read_text(encoding='utf-8'))}{END}"
    changed, count = re.subn(f"{re.escape(BEGIN)}.*?{re.escape(END)}", lambda _: filled, text, flags=re.DOTALL)
    if count != 1:
        raise ValueError(f"{readme} has {count} places between {BEGIN!r} and {END!r}, not one")
    readme.write_text(changed, encoding="utf-8")


def fill(readme: Path, results: Path) -> str:
    """Do the same, and say so; where the results lack something, as without the real clips, the README stays.

    Parameters
    ----------
    readme, results : Path

    Returns
    -------
    str
        What became of it, in one line.
    """
    try:
        update(readme, results)
    except ValueError as error:
        return f"note: {readme.name} stays as it was: {error}"
    return f"written: {readme}"


def block(results: str) -> str:
    """Write the README's table and its caption from the text of the page of results.

    Parameters
    ----------
    results : str
        Markdown.

    Returns
    -------
    str
        Markdown.
    """
    chapters = {title: read_table(chapter(results, title), title) for title in (RENDERED, REAL)}
    rows = []
    for name in ROWS:
        missing = [title for title, found in chapters.items() if name not in found]
        if missing:
            raise ValueError(f"the results have no row {name!r} in {missing}")
        rows.append([name, *(chapters[title][name][column] for title, column in COLUMNS.values())])
    where = re.search(r"^(\d{4}-\d\d-\d\d) .*?commit \w+\. (.*?), \d+ cores", results, flags=re.MULTILINE)
    made = f" {where[2]}, {where[1]}." if where else ""
    clip = re.search(r"^\*\*([\w ]+)\*\*, (\d+) rows", chapter(results, REAL), flags=re.MULTILINE)
    real = f" ({clip[1]}, {clip[2]} frames)" if clip else ""
    ours = chapters[TIME[0]][ROWS[0]][TIME[1]]
    return f"{table(['', *COLUMNS], rows)}\n*1.0: {ours}. Rendered sequences, and real footage{real}.{made}*\n"


def chapter(results: str, title: str) -> str:
    """Return the text of one chapter of the page."""
    found = re.search(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", results, flags=re.DOTALL | re.MULTILINE)
    if found is None:
        raise ValueError(f"the results have no chapter {title!r}")
    return found[1]


def read_table(text: str, title: str) -> dict[str, dict[str, str]]:
    """Read the first table of a text: row's name -> column -> cell."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]
    if len(cells) < 3:
        raise ValueError(f"the chapter {title!r} of the results has no table")
    head, _, *rows = cells
    found: dict[str, dict[str, str]] = {}
    for row in rows:
        found.setdefault(row[0], dict(zip(head, row, strict=False)))
    wanted = [column for chapter_title, column in (*COLUMNS.values(), TIME) if chapter_title == title]
    missing = [column for column in wanted if column not in head]
    if missing:
        raise ValueError(f"the table of the chapter {title!r} has no column {missing}")
    return found


if __name__ == "__main__":
    HERE = Path(__file__).resolve().parent
    update(HERE.parent / "README.md", HERE / "RESULTS.md")
