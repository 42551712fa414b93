"""Decisions that were superseded say so on their top, and so does the one that did it; the index says it too."""

import re
import runpy
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FILES = {path.name: path.read_text(encoding="utf-8") for path in sorted(ROOT.glob("docs/decisions/*.md"))}
LINK = r"\[(?P<number>\d{3})\]\(((?P=number)-[\w-]+\.md)\)"


def top(text: str) -> str:
    """Give the paragraph below the title: day, and what superseded what."""
    return text.split("\n\n")[1]


def pairs(whole: str, part: str) -> list[tuple[str, str, bool]]:
    """List each decision, the one that it names so, and whether it is about a part."""
    found = []
    for name, text in FILES.items():
        for words, _, other in re.findall(rf"^({whole}|{part}) {LINK}[.:]", top(text), re.MULTILINE):
            found.append((name, other, words == part))
    return found


BY = pairs("Superseded by", "Superseded in part by")


def test_every_decision_has_its_number_and_its_day_on_top() -> None:
    for name, text in FILES.items():
        assert text.startswith(f"# {name[:3]}: "), name
        assert re.match(r"\d{4}-\d\d-\d\d, accepted", top(text)), name
    assert len({name[:3] for name in FILES}) == len(FILES)


def test_what_was_superseded_and_what_did_it_name_each_other() -> None:
    assert len(BY) > 15
    assert sorted(BY) == sorted(
        (other, name, part) for name, other, part in pairs("Supersedes", "Supersedes a part of")
    )
    assert all(name < other for name, other, _ in BY), "a later one does it"


def test_it_is_said_in_these_words_on_top_and_nowhere_else() -> None:
    """So nobody reads a page of reasons that hold no more."""
    said = sum(len(re.findall(r"[Ss]upersede|[Tt]akes the place of decision", text)) for text in FILES.values())
    assert said == 2 * len(BY)


def test_the_index_says_it_too() -> None:
    index = runpy.run_path(str(ROOT / "docs" / "site" / "pages.py"))["_decisions_index"]()
    lines = [line for line in index.splitlines() if line.startswith("- ")]
    assert len(lines) == len(FILES)
    for line, name in zip(lines, FILES, strict=True):
        assert f"]({name})" in line
        later = [(other, part) for old, other, part in BY if old == name]
        shown = re.findall(r"; superseded( in part)? by \[\d{3}\]\(([\w-]+\.md)\)", line)
        assert [(other, bool(part)) for part, other in shown] == later
