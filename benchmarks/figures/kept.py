"""Figures with their data: `draw_kept` writes both, `redraw` draws from what was kept."""

import importlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

DIGITS = 4  # significant ones of a kept number
KINDS = {
    "errors over frames": "errors:errors_over_frames",
    "error histogram": "errors:error_histogram",
    "times over radius": "times:times_over_radius",
    "times of many": "times:times_over",
    "valid over time": "times:valid_over_time",
    "range errors": "spreads:range_errors",
    "spread along a chain": "spreads:spread_along_chain",
}
"""What a figure shows, and the function that draws it; Matplotlib is loaded only to draw."""


class Kept(msgspec.Struct, frozen=True):
    """A figure's data: what it shows, one of `KINDS`, and the arguments of its function; None for NaN."""

    kind: str
    data: dict[str, Any]


def draw_kept(folder: Path, name: str, kind: str, data: Mapping[str, Any]) -> None:
    """Draw a figure and keep its data: NAME.svg and NAME.json.

    Parameters
    ----------
    folder : Path
    name : str
    kind : str
        One of `KINDS`.
    data : mapping
        Arguments of its function: numbers, strings, and sequences and mappings of them.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text = msgspec.json.encode(Kept(kind, {key: _plain(value) for key, value in data.items()}))
    (folder / f"{name}.json").write_bytes(text + b"\n")
    _draw(folder, name, text)


def redraw(folder: Path) -> list[Path]:
    """Draw all figures of a folder again from their kept data.

    Returns
    -------
    list of Path
        What was drawn.
    """
    names = sorted(path.stem for path in folder.glob("*.json"))
    for name in names:
        _draw(folder, name, (folder / f"{name}.json").read_bytes())
    return [folder / f"{name}.svg" for name in names]


def figure_of_kept(text: bytes) -> Any:
    """Draw the figure of some kept data; a Matplotlib figure."""
    kept = msgspec.json.decode(text, type=Kept)
    module, _, function = KINDS[kept.kind].partition(":")
    draw: Callable[..., Any] = getattr(importlib.import_module(f"benchmarks.figures.{module}"), function)
    return draw(**kept.data)


def numbers(values: Any) -> npt.NDArray[np.float64]:
    """Read kept numbers, in any nesting; None is NaN."""
    return np.array(values, dtype=object).astype(float)


def _draw(folder: Path, name: str, text: bytes) -> None:
    from matchset.app.drawing.plot_style import write_svg

    write_svg(figure_of_kept(text), folder / f"{name}.svg")


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, str):
        return value
    if np.ndim(value):
        return [_plain(each) for each in value]
    if isinstance(value, int | np.integer):
        return int(value)
    return float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None
