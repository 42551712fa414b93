"""Print the tree of the sources, each file with the first line of its docstring."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("src/matchset", "benchmarks", "training", "examples")


def purpose(path: Path) -> str:
    """Return the first line of a Python file's docstring."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return text.partition("\n")[0]


def lines(folder: Path, depth: int = 0) -> Iterator[str]:
    """Yield a line for the folder, then for its files, then for what is below it."""
    name = folder.relative_to(ROOT).as_posix() if depth == 0 else folder.name
    start = folder / "__init__.py"
    yield _line(depth, f"{name}/", purpose(start) if start.exists() else "")
    for path in sorted(folder.glob("*.py")):
        if path != start:
            yield _line(depth + 1, path.name, purpose(path))
    for below in sorted(path for path in folder.iterdir() if any(path.glob("*.py"))):
        yield from lines(below, depth + 1)


def _line(depth: int, name: str, what: str) -> str:
    return f"{'  ' * depth + name:<36}{what}".rstrip()


def main() -> None:
    """Print the folders that are given, or all."""
    for name in sys.argv[1:] or FOLDERS:
        print("\n".join(lines(ROOT / name)))


if __name__ == "__main__":
    main()
