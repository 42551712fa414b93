"""docs/live.md is true: its tables are those of the code, its Python and its JavaScript run."""

import re
import runpy
from pathlib import Path

import pytest

from live_docs import DOCUMENTED, HOST, TEXT, block, showing
from matchset.live.options import LiveOptions
from matchset.live.record.panel import RecordPanel
from matchset.live.record.recorder import PageRecorder
from matchset.live.web import application

TABLES = runpy.run_path(str(DOCUMENTED.parent / "site" / "live_tables.py"))


def test_its_tables_are_those_of_the_code() -> None:
    assert TABLES["filled"](TEXT) == TEXT, "python docs/site/live_tables.py writes them anew"


def test_its_addresses_are_those_of_the_server() -> None:
    source = Path(application.__file__).read_text(encoding="utf-8")
    routes = set(re.findall(r'Route\(\s*"/([\w.]+)', source))
    documented = set(re.findall(r"^\| `(?:GET|POST|WebSocket) /([\w.]+)", TEXT, re.MULTILINE))
    assert documented == routes


def test_what_can_go_wrong_has_tests_that_are_there() -> None:
    rows = TEXT.partition("## When something is wrong")[2].partition("\n## ")[0].splitlines()
    cells = [row.split("|")[3] for row in rows if row.startswith("|")][2:]
    folder = Path(__file__).resolve().parents[1]
    there = {
        name for path in folder.rglob("test_*.py") for name in re.findall(r"def (test_\w+)", path.read_text("utf-8"))
    }
    assert len(cells) >= 11
    for cell in cells:
        assert (named := set(re.findall(r"`(test_\w+)`", cell)))
        assert named <= there


def test_its_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    with showing() as server, PageRecorder() as recorder:
        recorder.changed(server.feed)
        server.session.add(RecordPanel(recorder))
        exec(compile(block("python").replace(HOST, server.host), "live.md", "exec"), {})
        assert recorder.state().on
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 100
    assert any("'radius': [12.5, 0.05]" in line for line in lines)
    assert any("too few edge points" in line for line in lines)


def test_both_are_ten_lines() -> None:
    for language in ("python", "javascript"):
        assert len([line for line in block(language).splitlines() if line.strip()]) <= 10


def test_its_port_is_the_usual_one() -> None:
    assert f"127.0.0.1:{LiveOptions().port}" == HOST
