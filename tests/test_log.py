"""The log by subject: every file is in its index and small, and who points to an entry finds it."""

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOG = ROOT / "docs" / "log"
FILES = sorted(path for path in LOG.glob("*.md") if path.name != "index.md")
LARGEST = 60_000  # bytes of a file: it is read from top to bottom
MOST = 12  # files
ANCHOR = re.compile(r'^<a id="([\w-]+)"></a>$', re.MULTILINE)
ENTRY = re.compile(r'<a id="[\w-]+"></a>\n\n## \d{4}-\d\d-\d\d, \S.*\n\n\*`[^*]+\*\n\n\S')
NAMED = re.compile(r"docs/log/([\w-]+\.md)(?:#([\w-]*\w))?")  # in texts and docstrings
LINKED = re.compile(r"\]\(([^)\s#]*)(?:#([\w-]+))?\)")
TEXTS = {".py", ".md", ".toml", ".yml", ".c", ".h", ".js", ".html", ".txt", ".ipynb"}


def anchors(path: Path) -> list[str]:
    return ANCHOR.findall(path.read_text(encoding="utf-8"))


def texts() -> list[Path]:
    """Files of the repository; in an archive without git, those of its folders."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True)
    names = listed.stdout.splitlines()
    paths = (
        [ROOT / name for name in names] if names else [path for path in ROOT.rglob("*") if ".venv" not in path.parts]
    )
    return [path for path in paths if path.suffix in TEXTS and path.is_file() and path != Path(__file__)]


def test_the_files_are_few_and_small_and_all_in_the_index() -> None:
    assert 1 < len(FILES) <= MOST
    assert {path.name: path.stat().st_size for path in FILES if path.stat().st_size > LARGEST} == {}
    index = (LOG / "index.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\| .* \| .* \| \[[\w.]+\]\((\w+\.md)\) \|$", index, re.MULTILINE)) == [
        path.name for path in FILES
    ]
    assert not (ROOT / "docs" / "log.md").exists(), "an entry goes to the file of its subject: docs/log/index.md"


def test_every_entry_has_an_anchor_its_day_and_its_commit() -> None:
    for path in FILES:
        text = path.read_text(encoding="utf-8")
        assert len(ENTRY.findall(text)) == len(re.findall(r"^## ", text, re.MULTILINE)) == len(anchors(path)), path.name
        assert len(set(anchors(path))) == len(anchors(path)), path.name
        days = re.findall(r"^## (\d{4}-\d\d-\d\d), ", text, re.MULTILINE)
        assert days == sorted(days, reverse=True), path.name


def test_every_reference_to_an_entry_leads_to_it() -> None:
    known = {path.name: {"", *anchors(path)} for path in [*FILES, LOG / "index.md"]}
    lost, found = [], 0
    for path in texts():
        text = path.read_text(encoding="utf-8")
        where = path.relative_to(ROOT).as_posix()
        assert "docs/log.md" not in text, where
        named = NAMED.findall(text)
        if path.suffix == ".md":
            targets = [(path.parent / name if name else path, anchor) for name, anchor in LINKED.findall(text)]
            named += [(file.name, anchor) for file, anchor in targets if file.resolve().parent == LOG]
        lost += [f"{where}: {name}#{anchor}" for name, anchor in named if anchor not in known.get(name, set())]
        found += len(named)
    assert not lost
    assert found > 60
