"""Kept machine code is good as long as no source that it was made from has changed."""

from pathlib import Path

import pytest

from matchset.numeric import kept_code


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "matchset"
    (folder / "a").mkdir(parents=True)
    monkeypatch.setattr(kept_code, "PACKAGE", folder)
    (folder / "a" / "first.py").write_text("x = 1\n", encoding="utf-8")
    (folder / "a" / "second.py").write_text("from matchset.a import (\n    first,\n)\n", encoding="utf-8")
    (folder / "a" / "other.py").write_text("y = 1\n", encoding="utf-8")
    (tmp_path / "mine.py").write_text("from matchset.a.second import x\n", encoding="utf-8")
    return folder


def stamp(file: Path) -> int:
    kept_code._read_source.cache_clear()
    kept_code.source_stamp.cache_clear()
    return kept_code.source_stamp(file)


@pytest.mark.parametrize(("changed", "counts"), [("first", True), ("second", True), ("other", False)])
def test_the_stamp_follows_imports_and_nothing_else(package: Path, changed: str, counts: bool) -> None:
    mine = package.parent / "mine.py"
    before = stamp(mine)
    assert stamp(mine) == before
    with (package / "a" / f"{changed}.py").open("a", encoding="utf-8") as file:
        file.write("# changed\n")
    assert (stamp(mine) != before) == counts
