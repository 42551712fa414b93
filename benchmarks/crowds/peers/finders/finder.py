"""Finders of others and what they find: `FINDERS`, `found_by`."""

import hashlib
import importlib
import json
from functools import cache
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

import matchset as ms
from benchmarks.crowds.cases import FOLDER, Case, Watched, checksum, click_of, composed_checksum, watch
from benchmarks.crowds.peers.finders.color_range import Bytes
from benchmarks.crowds.peers.peer import Find, stored_of

_COLORS: dict[str, tuple[Any, ...]] = {
    "hue": (12, 6, 9, 18),
    "saturation": (70, 40, 100, 140),
    "value": (90, 50, 130, 200),
    "blur": (5, 1, 11),
    "opened": (1, 0, 2),
}
FINDERS: dict[str, dict[str, tuple[Any, ...]]] = {
    "recipe": {**_COLORS, "least": (0.4, 0.2, 0.6), "filled": (0.5, 0.0, 0.3, 0.65)},
    "edges": {
        "on": ("gray", "mask"),
        "colored": (0.5, 0.2, 0.35, 0.65),
        **_COLORS,
        "gradient": (20, 10, 36),
        "anchor": (4, 0, 8),
        "path": (10, 20),
        "round": (0.7, 0.5, 0.85),
        "least": (0.4, 0.6),
        "validated": (True, False),
    },
    "spots": {
        "wide": (1.0, 0.6, 1.3),
        "far": (60.0, 30.0, 45.0, 90.0),
        "mass": (0.4, 0.2, 0.6),
        "separation": (0.8, 0.5),
        "sized": (False, True),
    },
}
"""Values of each parameter that are tried; the first is what it begins with."""


def parameters_of(name: str) -> dict[str, Any]:
    """Return parameters of a finder that tuning has found; what it begins with where it has not."""
    return stored_of(f"finder_{name}", FINDERS[name])


def taught(name: str, image: Bytes, circle: ms.Circle, parameters: dict[str, Any]) -> Find:
    """Show a finder a click."""
    module = importlib.import_module(f"benchmarks.crowds.peers.finders.{name}")
    find: Find = module.start(image, circle, parameters)
    return find


def found_by(name: str, case: Case) -> Watched:
    """Return the truth of a crowd and what a finder finds in it, from a file if that is known."""
    parameters = parameters_of(name)
    key = hashlib.sha256(json.dumps(parameters, sort_keys=True).encode()).hexdigest()[:6]
    version = f"{key}{finder_checksum()}{checksum(())}{composed_checksum(case.scene)}"
    path = FOLDER / f"{name}_{case.scene}_{case.balls}_{case.seconds:g}_{case.seed}_{version}.json"
    if path.exists():
        return msgspec.json.decode(path.read_bytes(), type=Watched)
    frame, circle = click_of(case.crowd())  # from which all followers learn the color
    find = taught(name, np.asarray(frame.image, np.uint8), circle, parameters)
    return watch(path, case.crowd(), lambda frame: find(frame.image))


@cache
def finder_checksum() -> str:
    """Checksum of the code of all finders."""
    total = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        if path.stem != "tuning":
            total.update(path.name.encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:6]
