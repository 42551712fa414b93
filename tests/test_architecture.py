"""The maps of the house are true: every path and every code name in them exists."""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "matchset"
PAGES = ("ARCHITECTURE.md", "docs/glossary.md", "docs/finding_your_way.md")
GUIDES = sorted((ROOT / "docs").glob("*.md"))
PATH = re.compile(r"[\w./-]+\.(?:py|c|h|md|toml)")
NAME = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
MOST_WORDS = 30  # of a table's cell: it is read at a glance
MOST_TERMS = 60
WORDS = {"True", "False", "None", "blue", "purple"}


def names_of(body: list[ast.stmt]) -> Iterator[str]:
    """Names that a module or a class defines, fields included."""
    for node in body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            yield node.name
        elif isinstance(node, ast.Assign):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id


def collected() -> tuple[set[str], dict[str, set[str]]]:
    """All names of the package, and the members of each class, those set in methods included."""
    everything: set[str] = set()
    members: dict[str, set[str]] = defaultdict(set)
    for path in PACKAGE.rglob("*.py"):
        module = ast.parse(path.read_text(encoding="utf-8"))
        everything |= set(names_of(module.body))
        for node in ast.walk(module):
            if isinstance(node, ast.ClassDef):
                own = {
                    each.attr
                    for each in ast.walk(node)
                    if isinstance(each, ast.Attribute) and isinstance(each.value, ast.Name) and each.value.id == "self"
                }
                members[node.name] |= own | set(names_of(node.body))
    return everything, members


EVERYTHING, MEMBERS = collected()


def quoted(page: str) -> set[str]:
    text = re.sub(r"```.*?```", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL)
    return {word.replace("\\|", "|") for word in re.findall(r"`([^`\n]+)`", text)}


@pytest.mark.parametrize("page", PAGES)
def test_every_path_exists(page: str) -> None:
    paths = {word for word in quoted(page) if PATH.fullmatch(word)}
    assert len(paths) > 10
    assert not sorted(path for path in paths if not ((PACKAGE / path).exists() or (ROOT / path).exists()))


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", *(f"docs/{path.name}" for path in GUIDES)])
def test_every_path_with_a_folder_exists(page: str) -> None:
    paths = {word for word in quoted(page) if PATH.fullmatch(word) and "/" in word}
    assert not sorted(path for path in paths if not ((PACKAGE / path).exists() or (ROOT / path).exists()))


@pytest.mark.parametrize("page", PAGES)
def test_every_code_name_exists(page: str) -> None:
    words = {word for word in quoted(page) if NAME.fullmatch(word) and not PATH.fullmatch(word)} - WORDS
    folders = {path.name for path in PACKAGE.rglob("*") if path.is_dir()}
    missing = set()
    for word in words - folders:
        first, _, rest = word.partition(".")
        known = first in EVERYTHING and (not rest or rest in MEMBERS[first])
        if not known and not (not rest and any(first in found for found in MEMBERS.values())):
            missing.add(word)
    assert len(words) > 10
    assert not sorted(missing)


def cells(page: str) -> list[list[str]]:
    """Rows of the tables of a page, without the lines below their heads."""
    lines = (ROOT / page).read_text(encoding="utf-8").splitlines()
    rows = [line.strip().strip("|").split(" | ") for line in lines if line.startswith("| ")]
    return [[cell.strip() for cell in row] for row in rows if "---" not in row[0]]


@pytest.mark.parametrize("page", ["ARCHITECTURE.md", "docs/glossary.md"])
def test_no_cell_is_long(page: str) -> None:
    rows = cells(page)
    assert len(rows) > 30
    assert not [cell for row in rows for cell in row if len(cell.split()) > MOST_WORDS]


def test_the_three_steps_stand_first() -> None:
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    first = text.split("\n## ")[1]
    steps = re.findall(r"^(\d)\. \*\*(\w+)\*\*", first, re.MULTILINE)
    assert steps == [("1", "Predict"), ("2", "Match"), ("3", "Fit")]
    assert "(docs/glossary.md)" in text


def test_the_glossary_is_short_and_says_each_term_once() -> None:
    rows = [row for row in cells("docs/glossary.md") if row[0] != "term"]
    assert 40 < len(rows) <= MOST_TERMS
    assert len({row[0].lower() for row in rows}) == len(rows)
    for term, meaning, where in rows:
        assert 1 <= len(re.findall(r"\.(?= |$)", meaning)) <= 2, term
        assert meaning.endswith("."), term
        assert "`" in where, term


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("__init__.py")), ids=lambda path: path.parent.name)
def test_what_a_folder_says_of_itself_is_there(path: Path) -> None:
    """Its docstring names modules and folders that stand in it, or names of the code."""
    said = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    inside = {each.stem for each in path.parent.iterdir()}
    named = {name.removesuffix(".py").rstrip("/") for name in re.findall(r"`([a-z][a-z0-9_]*(?:\.py|/)?)`", said)}
    modules = {each.stem for each in PACKAGE.rglob("*.py")} | {
        each.name for each in PACKAGE.rglob("*") if each.is_dir()
    }
    assert named - inside <= modules | EVERYTHING | set().union(*MEMBERS.values()) | {"with", "ros", "training"}
