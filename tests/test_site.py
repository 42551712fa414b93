"""The documentation site and the tree: every public name has its section, every file says what it is for."""

import ast
import re
import runpy
import tomllib
from pathlib import Path

import pytest

import matchset

ROOT = Path(__file__).resolve().parents[1]
TREE = runpy.run_path(str(ROOT / ".ci" / "tree.py"))


def test_every_public_name_has_its_section() -> None:
    pages = runpy.run_path(str(ROOT / "docs" / "site" / "pages.py"))
    explained = [name for _, names in pages["API"].values() for name in names]
    assert sorted(explained) == sorted(set(explained))
    assert set(matchset.__all__) <= set(explained)
    generated = pages["generated"]()
    for name in matchset.__all__:
        assert any(f"::: {pages['anchor'](name)}\n" in text for text in generated.values()), name


def test_public_folders_have_pages() -> None:
    pages = runpy.run_path(str(ROOT / "docs" / "site" / "pages.py"))
    assert {folder for _, folder in pages["FOLDERS"].values()} == set(matchset._FOLDERS)
    assert "::: matchset.sim.world.World\n" in pages["generated"]()["api/sim.md"]


def test_every_command_is_listed() -> None:
    page = runpy.run_path(str(ROOT / "docs" / "site" / "pages.py"))["generated"]()["api/commands.md"]
    assert {"matchset track", "matchset fly", "matchset radio bind"} <= set(
        re.findall(r"^## (.*)$", page, re.MULTILINE)
    )
    assert "| `--pick X,Y[@FRAME]` |" in page


def test_every_parameters_struct_is_listed_once() -> None:
    generated = runpy.run_path(str(ROOT / "docs" / "site" / "pages.py"))["generated"]().values()
    listed = [name for text in generated for name in re.findall(r"^::: (\S+Parameters)$", text, re.MULTILINE)]
    assert len(listed) == len(set(listed))
    structs = set()
    for path in (ROOT / "src" / "matchset").rglob("*.py"):
        body = ast.parse(path.read_text(encoding="utf-8")).body
        structs |= {node.name for node in body if isinstance(node, ast.ClassDef) and node.name.endswith("Parameters")}
    assert {name.rpartition(".")[2] for name in listed} == structs


def test_the_tools_of_the_site_have_a_group_and_ci_builds_it() -> None:
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["dependency-groups"]
    assert {"mkdocs-material", "mkdocstrings"} <= {re.split(r"[\[><=]", name)[0] for name in groups["docs"]}
    assert "make docs" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_the_site_loads_nothing_from_the_network() -> None:
    configuration = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert "font: false" in configuration
    texts = [configuration, *(path.read_text(encoding="utf-8") for path in (ROOT / "docs" / "site").glob("*.css"))]
    assert not [text for text in texts if re.search(r"https?://|@import", text)]


@pytest.mark.parametrize("folder", TREE["FOLDERS"])
def test_the_tree_prints_each_file_with_its_purpose(folder: str) -> None:
    lines = list(TREE["lines"](ROOT / folder))
    names = [line.split()[0] for line in lines]
    files = [path.name for path in (ROOT / folder).rglob("*.py") if path.name != "__init__.py"]
    assert sorted(name for name in names if not name.endswith("/")) == sorted(files)
    assert not [line for line in lines if len(line.split()) < 2 and line.split()[0] not in {f"{folder}/"}]
