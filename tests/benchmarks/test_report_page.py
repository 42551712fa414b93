import json
import math
from pathlib import Path

import benchmarks.__main__ as bench
import pytest
from benchmarks.machine import Machine
from benchmarks.readme import BEGIN, END, REAL, RENDERED, ROWS, block, update
from benchmarks.report import json_line, page
from benchmarks.results import Figure, Finding, Goal, Picture, Section, table

MACHINE = Machine("2026-11-21 12:00 UTC", "abc1234", "A processor", 2, "Linux", "3.11", {"numpy": "2"}, "bench")
SECTIONS = [
    Section(
        "Accuracy",
        [
            Finding(
                name="clean",
                what="rendered `clean`",
                figures=(Figure("mean", 0.08, "px"), Figure("longest", math.inf)),
                bar=(Goal("mean", high=0.25),),
                prize=(Goal("mean", high=0.1),),
            ),
            Finding(name="bad", what="`bad`", figures=(Figure("mean", None),), bar=(Goal("mean", high=1.2),)),
        ],
        "How it was measured.",
        (Picture("error.png", "Error"),),
    ),
    Section("Real", [Finding(name="real", what="skipped", figures=())]),
]


def test_the_page_holds_machine_rows_pictures_and_text() -> None:
    text = page(SECTIONS, MACHINE)
    assert "commit abc1234. A processor, 2 cores" in text
    assert "1 of 2 bars held, 1 prizes won." in text
    assert "| rendered `clean` | mean 0.08 px, longest inf | mean ≤ 0.25 px | mean ≤ 0.1 px | prize |" in text
    assert "| `bad` | mean - | mean ≤ 1.2 | - | **missed** |" in text
    assert "| skipped | - | - | - | - |" in text
    assert "![Error](pictures/error.png)\n\nHow it was measured." in text


def test_the_json_line_is_one_line_without_infinities() -> None:
    line = json_line(SECTIONS, MACHINE)
    document = json.loads(line, parse_constant=lambda name: pytest_fail(name))
    assert "\n" not in line
    assert document["machine"]["commit"] == "abc1234"
    assert document["findings"]["clean"]["figures"] == {"mean": 0.08, "longest": None}
    assert document["findings"]["clean"]["verdict"] == "prize"


def pytest_fail(name: str) -> None:
    raise AssertionError(f"{name} is not JSON")


def results_page() -> str:
    rendered = {"time": "141 µs", "matchset beside it": "141 µs", "× ours": "1.0", "valid, all sequences": "99.8 %"}
    rendered |= {"`typical`": "0.24 px", "`hard`": "0.38 px", "false locks": "0"}
    real = {"median": "1.2 px", "valid": "92 %"}
    text = MACHINE.words() + "\n"
    for title, cells in ((RENDERED, rendered), (REAL, real)):
        lines = table(["", *cells], [[name, *cells.values()] for name in ROWS])
        text += f"\n## {title}\n\n**hand**, 39 rows\n\n{lines}"
    return text + "\n## More\n"


def test_the_readme_gets_its_table_from_the_results(tmp_path: Path) -> None:
    readme, results = tmp_path / "README.md", tmp_path / "RESULTS.md"
    readme.write_text(f"# Title\n\n{BEGIN}\nold\n{END}\n\nmore\n", encoding="utf-8")
    results.write_text(results_page(), encoding="utf-8")
    update(readme, results)
    text = readme.read_text(encoding="utf-8")
    assert "old" not in text
    assert "| CSRT | 1.0 | 99.8 % | 92 % |" in text
    assert "*1.0: 141 µs." in text
    assert "(hand, 39 frames). A processor, 2026-11-21." in text
    assert text.startswith("# Title\n")
    assert text.endswith("more\n")
    readme.write_text("# Title\n", encoding="utf-8")
    with pytest.raises(ValueError, match="README"):
        update(readme, results)


def test_without_the_real_clips_a_run_ends_well_and_the_readme_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    skipped = Section(REAL, [Finding(name="contest_real", what="no clips", figures=())], "Skipped: they are not here.")
    cells = {"time": "141 µs", "× ours": "1.0", "valid, all sequences": "99.8 %"}
    rendered = table(["", *cells], [[name, *cells.values()] for name in ROWS])
    (tmp_path / "benchmarks").mkdir()
    monkeypatch.setattr(bench, "HERE", tmp_path / "benchmarks")
    monkeypatch.setattr(bench, "measure", lambda *_: [*SECTIONS, Section(RENDERED, [], rendered), skipped])
    readme = tmp_path / "README.md"
    readme.write_text(f"# Title\n\n{BEGIN}\nold\n{END}\n", encoding="utf-8")
    bench.main("", False, "", tmp_path / "none", 1, None, None, None)
    assert "old" in readme.read_text(encoding="utf-8")
    *_, note, last = capsys.readouterr().out.splitlines()
    assert note == f"note: README.md stays as it was: the chapter {REAL!r} of the results has no table"
    assert json.loads(last)["machine"]


@pytest.mark.parametrize(
    ("old", "new", "missing"),
    [("CSRT", "?", "CSRT"), ("× ours", "?", "ours"), ("| time |", "| ? |", "time"), (REAL, "?", REAL)],
)
def test_what_the_readme_needs_and_the_results_lack_is_named(old: str, new: str, missing: str) -> None:
    with pytest.raises(ValueError, match=missing):
        block(results_page().replace(old, new))
