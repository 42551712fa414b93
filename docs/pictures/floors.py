"""Draw who imports whom, for ARCHITECTURE.md: `python docs/pictures/floors.py`, from the root of the repository.

All is read from the source: a row for each folder of `src/matchset`, a disc in the column of each folder that it
imports from. Nothing stands right of the diagonal, or `tests/test_layers.py` fails.
"""

import ast
import tomllib
from collections import Counter
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from matchset.app.drawing.plot_style import GRID, INK, OURS, PAPER, QUIET, SERIES, TEXT, figure_of, write_svg

PACKAGE = Path(__file__).resolve().parents[2] / "src" / "matchset"
ORDER = tuple(tomllib.loads((PACKAGE.parents[1] / "tests" / "budget.toml").read_text(encoding="utf-8")))
"""The folders, each after those from which it may import."""

LIBRARY = ORDER.index("app")
SIZES = ((16, 0.40), (4, 0.26), (1, 0.14))  # files that import, at least; radius of their disc, of a square
WIDTH, HEIGHT = 560, 540  # px; letters can be read on a phone


def main() -> None:
    """Write docs/pictures/floors.svg."""
    path = Path(__file__).with_suffix(".svg")
    write_svg(floors(), path)
    print(f"{path}: {path.stat().st_size // 1000} kB")


def floors() -> Figure:
    """Draw the folders, and how many files of each import from each other one."""
    figure, (axes,) = figure_of((WIDTH, HEIGHT))
    for row, name in enumerate(ORDER):
        axes.text(-0.8, row, name, color=INK, fontsize=TEXT, ha="right", va="center")
        axes.text(
            row, -0.9, name, color=INK, fontsize=TEXT, ha="left", va="center", rotation=60, rotation_mode="anchor"
        )
        axes.add_patch(Rectangle((row - 0.5, row - 0.5), 1.0, 1.0, facecolor=GRID, edgecolor=PAPER))
    for (row, column), radius in discs().items():
        color = SERIES[0] if row < LIBRARY else OURS
        axes.add_patch(Circle((column, row), radius, color=color, gid=named(row, column, radius)))
    axes.plot((-4.6, len(ORDER)), (LIBRARY - 0.5, LIBRARY - 0.5), color=QUIET, linewidth=1.0)
    axes.set(xlim=(-4.8, len(ORDER) + 1.2), ylim=(len(ORDER) - 0.3, -4.6), aspect="equal")
    axes.axis("off")
    return figure


def discs() -> dict[tuple[int, int], float]:
    """Radius of the disc of each row and column that has one."""
    return {
        (ORDER.index(user), ORDER.index(used)): next(radius for least, radius in SIZES if number >= least)
        for (user, used), number in imports().items()
        if used in ORDER
    }


def named(row: int, column: int, radius: float) -> str:
    """Name a disc in the SVG, so that a test can read what was drawn."""
    return f"{ORDER[row]}-{ORDER[column]}-{radius}"


def imports() -> Counter[tuple[str, str]]:
    """Count the files of a folder that import from another one."""
    found: Counter[tuple[str, str]] = Counter()
    for name in ORDER:
        for path in (PACKAGE / name).rglob("*.py"):
            modules = {each.module or "" for each in ast.walk(parsed(path)) if isinstance(each, ast.ImportFrom)}
            folders = {module.split(".")[1] for module in modules if module.startswith("matchset.")}
            found.update((name, folder) for folder in folders if folder != name)
    return found


def parsed(path: Path) -> ast.Module:
    """Read a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
