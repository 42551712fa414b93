"""The weights that ship are those that are written down, and what makes weights stands by itself."""

import ast
from pathlib import Path

from training.shipped import SHIPPED, checksum

from matchset.image.disc_network.network import FILE

ROOT = Path(__file__).resolve().parents[2]


def imported(folder: Path) -> set[str]:
    """Full names of the modules that the files of a folder import."""
    found = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module)
            elif isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
    return found


def test_the_shipped_weights_have_the_checksum_that_is_written_down() -> None:
    assert checksum(FILE) == SHIPPED, "new weights: their checksum and how they came about go into training/shipped.py"


def test_training_needs_no_benchmark() -> None:
    assert not [name for name in imported(ROOT / "training") if name.partition(".")[0] in ("benchmarks", "tests")]


def test_benchmarks_need_of_training_only_what_draws() -> None:
    """Random videos and clicks that mislead show balls before photographs: one code draws them, nothing is learned."""
    needed = {name for name in imported(ROOT / "benchmarks") if name.partition(".")[0] == "training"}
    assert needed
    assert not [name for name in needed if not name.startswith("training.rendering.")]


def test_the_package_needs_neither() -> None:
    needed = {name.partition(".")[0] for name in imported(ROOT / "src")}
    assert not needed & {"training", "benchmarks", "torch"}
