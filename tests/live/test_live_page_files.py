"""The page's own files: few in a folder, short, whole, and nothing from elsewhere."""

import re
from pathlib import Path

import pytest

import matchset.live

PAGE = Path(matchset.live.__file__).parent / "page"
FILES = sorted(path for path in PAGE.rglob("*") if path.is_file())
SCRIPTS = [path for path in FILES if path.suffix == ".js"]
MOST_MODULES, MOST_LINES = 12, 400
NAMESPACE = "http://www.w3.org/2000/svg"


@pytest.mark.parametrize("folder", sorted({path.parent for path in FILES}), ids=lambda folder: folder.name)
def test_a_folder_has_few_modules(folder: Path) -> None:
    assert len([path for path in SCRIPTS if path.parent == folder]) <= MOST_MODULES


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_a_file_is_short_and_names_no_other_host(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.count("\n") <= MOST_LINES
    assert not re.search(r"//[\w.-]+\.\w+/", text.replace(NAMESPACE, ""))


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_a_module_says_what_it_is_and_imports_what_is_there(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.startswith("// ")
    for name in re.findall(r'from "([^"]+)"', text):
        assert (path.parent / name).resolve() in SCRIPTS, name


def test_the_page_names_what_is_there() -> None:
    text = (PAGE / "index.html").read_text(encoding="utf-8")
    for name in re.findall(r'(?:href|src)="([^"]+)"', text):
        assert (PAGE / name).is_file(), name
