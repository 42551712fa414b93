"""The figures of the results: laid out well, kept with their data, and drawn again from it."""

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest
from benchmarks.contest.summary import NAMED
from benchmarks.figures.kept import KINDS, draw_kept, figure_of_kept, numbers, redraw

from plot_layout import faults

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "benchmarks" / "pictures"
NAMES = sorted(path.stem for path in PICTURES.glob("*.json"))
NAN = math.nan


@pytest.mark.parametrize("name", NAMES)
def test_a_figure_of_the_results_is_laid_out_well(name: str) -> None:
    assert not faults(figure_of_kept((PICTURES / f"{name}.json").read_bytes()))


@pytest.mark.parametrize("name", NAMES)
def test_a_figure_shows_its_kept_data(name: str, tmp_path: Path) -> None:
    (tmp_path / f"{name}.json").write_bytes((PICTURES / f"{name}.json").read_bytes())
    assert redraw(tmp_path) == [tmp_path / f"{name}.svg"]
    drawn, kept = ((folder / f"{name}.svg").read_text(encoding="utf-8") for folder in (tmp_path, PICTURES))
    assert words(drawn) == words(kept), "`python -m benchmarks.figures` draws it again"


def words(svg: str) -> list[str]:
    """The numbers of glyphs and lines of a figure: libraries of another version place them elsewhere by a hair."""
    return re.findall(r"<(?:use|path|g|text)\b", svg)


def test_pages_show_the_figures_that_are_there() -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "benchmarks").glob("*.md")]
    shown = set()
    for page in pages:
        for target in re.findall(r"!\[[^]]*\]\(([^)]+\.(?:svg|png|jpg|webp))\)", page.read_text(encoding="utf-8")):
            path = (page.parent / target).resolve()
            assert path.is_file(), f"{page.name}: {target}"
            shown.add(path)
    assert {PICTURES / f"{name}.svg" for name in NAMES} <= shown
    assert {path.stem for path in PICTURES.glob("*.svg")} == set(NAMES)


def test_kept_data_are_plain_and_short(tmp_path: Path) -> None:
    draw_kept(tmp_path, "one", "spread along a chain", {"spreads_cm": {"side": (1.23456789, 2.0, 3.0)}})
    assert json.loads((tmp_path / "one.json").read_text()) == {
        "kind": "spread along a chain",
        "data": {"spreads_cm": {"side": [1.235, 2.0, 3.0]}},
    }
    assert (tmp_path / "one.svg").is_file()
    assert numbers([1, None, 2.5]).tolist()[::2] == [1.0, 2.5]


def test_the_named_points_are_in_the_figure() -> None:
    kept = json.loads((PICTURES / "accuracy_speed.json").read_text(encoding="utf-8"))["data"]
    assert kept["named"] == list(NAMED)
    assert set(NAMED) <= set(kept["points"])


NOISY = {
    "matchset": [0.2, 0.3, NAN, 0.25] * 30,
    "another one": [4.0, NAN, 6.0, 300.0] * 30,
    "a third": [5.0] * 120,
    "a fourth": [4.9, 5.1] * 60,
    "never": [NAN] * 119 + [5.0],
}
SYNTHETIC: dict[str, dict[str, Any]] = {
    "errors over frames": {"errors": NOISY, "radii": [30.0, NAN, 40.0] * 40, "best": "matchset"},
    "error histogram": {"errors": NOISY, "best": "matchset"},
    "times over radius": {
        "radii": [20.0, 60.0, 120.0],
        "times": [52.0, 53.0, 54.0],
        "levels": {"cvtColor + inRange": 54.5, "frame.copy()": 53.5},
        "name": "Tracker.update",
    },
    "times of many": {
        "xs": [20, 70, 120],
        "times": {"matchset": [99.0, 100.0, 101.0], "b": [100.0, 101.0, 102.0], "c, d": [9.0, 99.0, 103.0]},
        "label": "radius of the ball, px",
        "log_x": False,
    },
    "valid over time": {
        "points": {"matchset": (100.0, 99.0), "b": (110.0, 98.0), "c": (9000.0, 99.0), "d": (9100.0, 3.0)},
        "named": ["matchset", "b", "c"],
    },
    "range errors": {
        "angles_deg": [0, 10, 20],
        "errors": {"a": [[0.0], [1.0], [2.0]], "b": [[0.1], [1.1], [2.1]], "c": [[0.0], [0.0], [2.0]]},
        "best": "c",
    },
    "spread along a chain": {
        "spreads_cm": {"side": [1.0, 2.0, 8.0], "height": [1.0, 1.5, 8.1], "heading": [1.0, 2.0, 8.2]}
    },
}


def test_every_kind_has_data_that_lie_on_one_another() -> None:
    assert set(SYNTHETIC) == set(KINDS)


@pytest.mark.parametrize("kind", sorted(SYNTHETIC))
def test_hard_data_are_laid_out_well_too(kind: str, tmp_path: Path) -> None:
    draw_kept(tmp_path, "hard", kind, SYNTHETIC[kind])
    assert not faults(figure_of_kept((tmp_path / "hard.json").read_bytes()))
