"""The drawings of the docs are laid out well, and those in the repository are those that the scripts draw."""

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

from matchset.app.drawing.plot_style import svg_of
from plot_layout import crossed, faults
from test_layers import LAYERS

PICTURES = Path(__file__).resolve().parents[1] / "docs" / "pictures"


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"picture_{name}", PICTURES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


GEOMETRY = script("geometry").FIGURES


@pytest.mark.parametrize("name", sorted(GEOMETRY))
def test_a_drawing_of_the_geometry_is_laid_out_well(name: str) -> None:
    assert not faults(GEOMETRY[name]())
    assert not crossed(GEOMETRY[name]())


@pytest.mark.parametrize("name", sorted(GEOMETRY))
def test_a_drawing_of_the_geometry_is_what_its_script_draws(name: str) -> None:
    kept = (PICTURES / f"geometry_{name}.svg").read_text(encoding="utf-8")
    assert pieces(kept) == pieces(svg_of(GEOMETRY[name](), f"geometry_{name}"))


def test_the_picture_of_the_folders_shows_who_imports_from_whom() -> None:
    floors = script("floors")
    assert list(floors.ORDER) == LAYERS
    kept = (PICTURES / "floors.svg").read_text(encoding="utf-8")
    drawn = set(re.findall(r'id="floors-(\w+-\w+-0\.\d+)"', kept))
    assert drawn == {floors.named(*place, radius) for place, radius in floors.discs().items()}, "draw it anew"
    assert not [fault for fault in faults(floors.floors()) if "cut off" in fault]  # boxes of turned words overlap


def pieces(svg: str) -> list[str]:
    """What a drawing consists of, without places: libraries of another version place them elsewhere by a hair."""
    return re.findall(r"<(?:use|path|g|text)\b", svg)
