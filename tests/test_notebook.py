"""The notebook in examples/ runs from top to bottom as Jupyter would run it, and holds what it shows then.

A cell is executed as IPython does: its last expression is shown, by `_repr_html_` or `_repr_png_` where it has one, and
so is a figure of Matplotlib. `jupyter execute --inplace examples/first_look.ipynb` writes the outputs again.
"""

import ast
import base64
import json
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
PATH = ROOT / "examples" / "first_look.ipynb"
NOTEBOOK = json.loads(PATH.read_text(encoding="utf-8"))
CELLS = [cell for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]
LARGEST = 1_000_000  # bytes
RICH = {"_repr_png_": "image/png", "_repr_html_": "text/html", "_repr_svg_": "image/svg+xml"}


def shown(cell: str, names: dict[str, Any]) -> Any:
    """Execute a cell; what it shows."""
    tree = ast.parse(cell)
    last = tree.body.pop()
    assert isinstance(last, ast.Expr), "every cell ends with something to look at"
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names)


def outputs(cell: dict[str, Any], kind: str) -> list[str]:
    """What a cell holds of a kind, such as image/png."""
    data = [output["data"][kind] for output in cell["outputs"] if kind in output.get("data", {})]
    return ["".join(each) for each in data]


def printed(cell: dict[str, Any]) -> str:
    return "".join("".join(output["text"]) for output in cell["outputs"] if output["output_type"] == "stream")


def picture(packed: bytes) -> tuple[int, ...]:
    image = cv2.imdecode(np.frombuffer(packed, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    assert np.ptp(image) > 100, "not empty"
    return tuple(image.shape)


def test_every_cell_runs_and_shows_what_it_holds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for cell in CELLS:
        result = shown("".join(cell["source"]), names)
        for method, kind in RICH.items():
            if hasattr(result, method):
                assert outputs(cell, kind), f"{cell['id']} lacks {kind}"
        if hasattr(result, "_repr_png_"):
            (kept,) = outputs(cell, "image/png")
            assert picture(result._repr_png_()) == picture(base64.b64decode(kept))
        assert words(printed(cell)) == words(capsys.readouterr().out), cell["id"]
    assert sum(map(bool, names["tracks"])) >= 87
    assert not list(tmp_path.iterdir())


def words(text: str) -> list[str]:
    """Text without what is behind a decimal point, where libraries of another version may differ."""
    return re.sub(r"(\d)\.\d+", r"\1", text).split()


def test_the_curves_are_those_of_the_truth(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names: dict[str, Any] = {}
    for cell in CELLS:
        shown("".join(cell["source"]), names)
    assert np.nanmedian(np.abs(names["found"] - names["truth"])) < 0.3
    (curves,) = (cell for cell in CELLS if "plt.subplots" in "".join(cell["source"]))
    (kept,) = outputs(curves, "image/png")
    assert min(picture(base64.b64decode(kept))[:2]) > 300
    labels = [axis.get_ylabel() for axis in names["axes"].flat]
    assert labels[:2] == ["x, px", "error of x, px"]


def test_it_holds_its_outputs_and_nothing_of_the_machine_it_ran_on() -> None:
    assert NOTEBOOK["nbformat"] == 4
    assert len({cell["id"] for cell in NOTEBOOK["cells"]}) == len(NOTEBOOK["cells"])
    assert [cell["execution_count"] for cell in CELLS] == list(range(1, len(CELLS) + 1))
    assert all(cell["outputs"] for cell in CELLS)
    kinds = {output["output_type"] for cell in CELLS for output in cell["outputs"]}
    assert kinds <= {"stream", "display_data", "execute_result"}, "no errors"
    text = PATH.read_text(encoding="utf-8")
    assert len(text) < LARGEST
    assert not re.search(r"/(?:tmp|home|root|work|Users)/|\.\./", re.sub(r'"image/png": "[^"]*"', "", text))


def test_it_needs_nothing_but_the_package_and_what_that_depends_on() -> None:
    source = "\n".join("".join(cell["source"]) for cell in CELLS)
    imported = {name for node in ast.walk(ast.parse(source)) for name in modules(node)}
    assert imported == {"math", "matplotlib", "numpy", "matchset"}
    assert "Path(" not in source
    assert "open(" not in source


def modules(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [each.name.partition(".")[0] for each in node.names]
    return [(node.module or "").partition(".")[0]] if isinstance(node, ast.ImportFrom) else []
