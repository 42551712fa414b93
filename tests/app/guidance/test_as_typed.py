"""What is printed to be typed can be typed: `program`."""

import os
import sys
from pathlib import Path

import pytest

from matchset.app.guidance.as_typed import program


@pytest.fixture
def called(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The command line in a virtual environment that is not active."""
    file = tmp_path / ".venv" / "bin" / "matchset"
    file.parent.mkdir(parents=True)
    file.write_text("#!/bin/sh\n")
    file.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path / "elsewhere"))
    monkeypatch.setattr(sys, "argv", [str(file)])
    return file


@pytest.mark.usefixtures("called")
def test_before_the_environment_is_active_it_is_typed_by_its_place() -> None:
    assert Path(program()) == Path(".venv") / "bin" / "matchset"


def test_where_a_shell_finds_it_its_name_does(called: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(called.parent))
    assert program() == "matchset"


def test_from_far_away_the_shorter_path_is_named(called: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    far = called.parents[2] / "a" / "b" / "c" / "d" / "e" / "f"
    far.mkdir(parents=True)
    monkeypatch.chdir(far)
    assert program() == min(os.path.relpath(called), str(called), key=len)


def test_as_a_module_it_is_typed_as_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["/somewhere/matchset/__main__.py"])
    assert program().endswith("-m matchset")
