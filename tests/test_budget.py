"""Lines of code and parameters of each folder stay within `budget.toml`: to grow is a decision, written down there."""

import ast
import tomllib
from pathlib import Path

import pytest

from test_layers import LAYERS

PACKAGE = Path(__file__).resolve().parents[1] / "src" / "matchset"
BUDGET = tomllib.loads((Path(__file__).parent / "budget.toml").read_text(encoding="utf-8"))
ROOM = 0.03  # of a budget: how far below it a folder may be before the budget is lowered


def lines_of_code(text: str) -> int:
    """Lines that are not empty, not comments, and not part of a docstring."""
    documented = set[int]()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            documented.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    lines = [line.strip() for number, line in enumerate(text.splitlines(), 1) if number not in documented]
    return sum(bool(line) and not line.startswith("#") for line in lines)


def parameters(text: str) -> int:
    """Fields of the structs whose name ends in `Parameters`."""
    structs = [node for node in ast.parse(text).body if isinstance(node, ast.ClassDef)]
    named = [struct for struct in structs if struct.name.endswith("Parameters")]
    return sum(isinstance(node, ast.AnnAssign) for struct in named for node in struct.body)


def test_what_counts() -> None:
    lines = '"""Doc."""', "# why", "X = 1  # here", "class AParameters:", '    """Doc."""', "    one: int = 1", ""
    text = "\n".join(lines)
    assert (lines_of_code(text), parameters(text)) == (3, 1)


def test_every_folder_has_a_budget() -> None:
    assert list(BUDGET) == LAYERS


@pytest.mark.parametrize("folder", LAYERS)
def test_a_folder_stays_within_its_budget(folder: str) -> None:
    texts = [path.read_text(encoding="utf-8") for path in (PACKAGE / folder).rglob("*.py")]
    for name, count in (("lines", lines_of_code), ("parameters", parameters)):
        actual, budget = sum(map(count, texts)), BUDGET[folder][name]
        assert actual <= budget, f"{folder} has {actual} {name}: take some away, or write down in budget.toml why not"
        assert actual >= (1.0 - ROOM) * budget - 1, f"{folder} has {actual} {name}: lower its budget, so that it stays"
