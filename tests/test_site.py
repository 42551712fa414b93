"""The documentation site and the tree: every public name has its section, every file says what it is for."""

import ast
import re
import runpy
import tomllib
from pathlib import Path
from typing import Any

import pytest

import matchset

ROOT = Path(__file__).resolve().parents[1]
TREE = runpy.run_path(str(ROOT / ".ci" / "tree.py"))


def site_code(name: str) -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "docs" / "site" / f"{name}.py"))


def guides() -> tuple[str, ...]:
    text = (ROOT / "docs" / "site" / "hooks.py").read_text(encoding="utf-8")
    (found,) = (node.value for node in ast.parse(text).body if isinstance(node, ast.Assign) and assigns(node, "GUIDES"))
    return tuple(ast.literal_eval(found))


def assigns(node: ast.Assign, name: str) -> bool:
    return [ast.unparse(each) for each in node.targets] == [name]


def test_the_search_weighs_tasks_before_guides_before_the_rest_and_leaves_decisions_and_log_out() -> None:
    """`make docs` fails where words of a task find another page first, by the index of the built site."""
    weight = site_code("finding")["weight"]
    tasks = [f"docs/{page}.md" for page, _ in site_code("finding")["TASKS"]]
    assert {Path(page).stem for page in tasks} == {"own_video", "webcam", "two_balls", "meters", "pandas", "ros2"}
    assert all((ROOT / page).exists() for page in tasks)
    others = {path.relative_to(ROOT).as_posix() for path in ROOT.glob("docs/**/*.md")} - set(tasks)
    weights = {page: weight(page, guides()) for page in others}
    heaviest = max(weights.values())
    assert all(weight(page, guides()) > heaviest for page in tasks)
    assert {page for page in others if weights[page] == heaviest} == {f"docs/{name}.md" for name in guides()}
    assert all(weights[page] == 0.0 for page in others if page.startswith(("docs/decisions/", "docs/log/")))
    assert heaviest > weight("api/tracking.md", guides()) > weight("CHANGELOG.md", guides()) > 0.0


def test_the_words_of_a_task_are_searched_as_the_page_does() -> None:
    pytest.importorskip("lunr", reason="lunr is in the dependency group `docs`")
    finding = site_code("finding")
    pages = [(f"docs/{page}.html", words) for page, words in finding["TASKS"]] + list(finding["ALSO"])
    titles = {page: " ".join(words for other, words in pages if other == page) for page, _ in pages}
    docs = [{"location": page, "title": title, "text": "", "boost": 10.0} for page, title in titles.items()]
    wordy: dict[str, Any] = {
        "location": "docs/log/tracking.html",
        "title": "Two balls before a webcam",
        "text": "<p>two balls, meters</p>",
    }
    config = {"separator": r"[\s\-]+", "fields": {"title": {"boost": 1e3}, "text": {"boost": 1.0}}}
    index = {"config": config, "docs": [*docs, wordy]}
    assert finding["searcher"](index)("before webcam")[0] == "docs/webcam.html"
    assert "'two balls'" not in str(finding["misses"](index))
    wordy["boost"] = 1e3
    assert "'two balls' finds ['docs/log/tracking.html'" in str(finding["misses"](index))


def test_the_tasks_are_in_the_navigation_and_the_index_is_searched_when_it_is_built() -> None:
    hooks = (ROOT / "docs" / "site" / "hooks.py").read_text(encoding="utf-8")
    assert '{"Tasks": [f"docs/{name}.md" for name, _ in TASKS]}' in hooks
    assert "misses(json.loads(" in hooks
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert all(f"(docs/{page}.md)" in readme for page, _ in site_code("finding")["TASKS"])


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
    assert {"mkdocs-material", "mkdocstrings", "lunr"} <= {re.split(r"[\[><=]", name)[0] for name in groups["docs"]}
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
