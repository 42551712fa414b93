"""Every test that docs/safety.md names exists."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "safety.md").read_text(encoding="utf-8")
NAMED = re.compile(r"`(test_\w+\.py)::(test_\w+)`")


def test_every_test_that_the_page_names_exists() -> None:
    named = NAMED.findall(PAGE)
    assert len(named) > 25
    files = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py")}
    missing = [f"{file}::{name}" for file, name in named if f"def {name}(" not in files.get(file, "")]
    assert not missing


def test_every_row_names_a_test_or_says_why_not() -> None:
    begin, end = PAGE.index("## What can turn a motor"), PAGE.index("### Old pictures")
    rows = [line for line in PAGE[begin:end].splitlines() if line.startswith("|") and not line.startswith("| ---")]
    rows = [row for row in rows if not row.startswith("| what could")]
    assert len(rows) > 20
    assert all(NAMED.search(row) or "| none: " in row for row in rows)
