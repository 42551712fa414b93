"""The notebook in examples/ runs from top to bottom as Jupyter would run it, on a real clip and on a rendered one.

A cell is executed as IPython does: its last expression is shown, by `_repr_html_` or `_repr_png_` where it has one.
"""

import ast
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOK = json.loads((ROOT / "examples" / "first_look.ipynb").read_text(encoding="utf-8"))
CELLS = ["".join(cell["source"]) for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]
REAL = ROOT.parent / "shared" / "data" / "green_ball_hand" / "video.mp4"


def shown(cell: str, names: dict[str, Any]) -> Any:
    """Execute a cell; what it shows."""
    tree = ast.parse(cell)
    last = tree.body.pop()
    assert isinstance(last, ast.Expr), "every cell ends with something to look at"
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names)


@pytest.mark.parametrize("clip", ["real", "rendered"])
def test_every_cell_runs_and_shows_something(
    clip: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if clip == "real" and not REAL.exists():
        pytest.skip(f"the real clip is not here: {REAL}")
    monkeypatch.chdir(ROOT / "examples" if clip == "real" else tmp_path)
    names: dict[str, Any] = {}
    results = [shown(cell, names) for cell in CELLS]
    pictures = [each._repr_png_() for each in results if hasattr(each, "_repr_png_")]
    assert len(pictures) == 5
    for picture in pictures:
        assert np.asarray(cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR)).size > 10_000
    assert sum("<table>" in each._repr_html_() for each in results if hasattr(each, "_repr_html_")) == 2
    assert f"a {clip} clip" in capsys.readouterr().out
    assert sum(map(bool, names["tracks"])) >= 27
    assert not list(tmp_path.iterdir())


def test_it_holds_no_outputs_and_says_what_it_is() -> None:
    assert NOTEBOOK["nbformat"] == 4
    assert len({cell["id"] for cell in NOTEBOOK["cells"]}) == len(NOTEBOOK["cells"])
    assert not any(cell.get("outputs") or cell.get("execution_count") for cell in NOTEBOOK["cells"])
