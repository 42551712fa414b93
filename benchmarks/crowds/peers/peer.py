"""What a tracker of others is, and all that there are: `Peer`, `PEERS`. Imports nothing that must be installed."""

import importlib
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

PARAMETERS = Path(__file__).with_name("parameters.toml")
ROOT = Path(__file__).resolve().parents[3]

Detection = tuple[float, float, float, float]
"""x, y, radius, px, and how sure it is, 0 ... 1."""
Find = Callable[[Any], list[Detection]]
"""From a picture to what is found in it."""
Named = tuple[int, float, float, float]
"""Name, x, y, radius, px."""
Step = Callable[[list[Detection]], list[Named]]
"""From what was detected in a frame to what is answered of it."""


class Peer(NamedTuple):
    """A tracker of others.

    Parameters
    ----------
    name : str
        Its name in tables.
    environment : str
        Folder below `.bench` in which it is installed.
    module : str
        Where its `start` is, below this folder: from parameters to a `Step`.
    choices : dict
        Values of each parameter that are tried; the first is what it begins with.
    finder : str
        One of `FINDERS`, with which it is fed; empty: with the circles of `ms.detect`.
    """

    name: str
    environment: str
    module: str
    choices: dict[str, tuple[Any, ...]]
    finder: str = ""

    @property
    def python(self) -> Path:
        """The interpreter of its environment."""
        return ROOT / ".bench" / self.environment / "bin" / "python"

    def start(self, key: str, parameters: dict[str, Any]) -> Step:
        """Make one; only where it is installed."""
        step: Step = importlib.import_module(f"benchmarks.crowds.peers.{self.module}").start(key, parameters)
        return step


_SHARED: dict[str, tuple[Any, ...]] = {
    "lost_track_buffer": (30, 8, 15, 60, 120),
    "minimum_consecutive_frames": (2, 1, 3),
    "state": ("XYXY", "XCYCSR"),
}
_OVERLAPS = ("iou", "giou", "diou", "wide_iou")
_NORFAIR: dict[str, tuple[Any, ...]] = {
    "distance_threshold": (40.0, 15.0, 25.0, 60.0, 90.0),
    "hit_counter_max": (15, 5, 30, 60),
    "initialization_delay": (2, 0, 1, 4),
    "measurement_noise": (4.0, 0.5, 1.0, 16.0),
    "process_noise": (0.1, 0.02, 0.5, 2.0),
    "predicted": (False, True),
}
_BYTE_TRACK: dict[str, tuple[Any, ...]] = {
    "overlap": _OVERLAPS,
    "minimum_iou_threshold": (0.1, -0.6, -0.3, 0.02, 0.2, 0.3),
    "track_activation_threshold": (0.7, 0.5, 0.6, 0.8, 0.9),
    "high_conf_det_threshold": (0.6, 0.5, 0.7, 0.8),
    **_SHARED,
}
_SORT: dict[str, tuple[Any, ...]] = {
    "overlap": _OVERLAPS,
    "minimum_iou_threshold": (0.3, -0.6, -0.3, 0.02, 0.1, 0.2),
    "track_activation_threshold": (0.25, 0.6, 0.7, 0.8),
    **_SHARED,
}
_LINK: dict[str, tuple[Any, ...]] = {
    "search_range": (40.0, 15.0, 25.0, 60.0, 90.0),
    "memory": (8, 0, 3, 15, 30),
    "span": (1, 0, 3),
}
PEERS = {
    "recipe": Peer("recipe, norfair 2.3", "crowds-norfair", "norfair", _NORFAIR, "recipe"),
    "recipe_byte": Peer("recipe, ByteTrack (trackers 2.6)", "crowds-trackers", "sort_family", _BYTE_TRACK, "recipe"),
    "edges": Peer("Edge Drawing, SORT (trackers 2.6)", "crowds-trackers", "sort_family", _SORT, "edges"),
    "trackpy": Peer("trackpy 0.7", ".", "trackpy", _LINK, "spots"),
    "norfair": Peer("norfair 2.3", "crowds-norfair", "norfair", _NORFAIR),
    "byte_track": Peer("ByteTrack (trackers 2.6)", "crowds-trackers", "sort_family", _BYTE_TRACK),
    "oc_sort": Peer(
        "OC-SORT (trackers 2.6)",
        "crowds-trackers",
        "sort_family",
        {
            "overlap": _OVERLAPS,
            "minimum_iou_threshold": (0.3, -0.6, -0.3, 0.02, 0.1, 0.2),
            "direction_consistency_weight": (0.2, 0.0, 0.1, 0.4),
            "high_conf_det_threshold": (0.6, 0.5, 0.7),
            "delta_t": (3, 1, 2, 5),
            **_SHARED,
        },
    ),
    "sort": Peer("SORT (trackers 2.6)", "crowds-trackers", "sort_family", _SORT),
}
"""The first bring a finder of their own; the others are fed with the circles of `ms.detect`."""


def first_of(choices: dict[str, tuple[Any, ...]]) -> dict[str, Any]:
    """Return the first value of each."""
    return {name: values[0] for name, values in choices.items()}


def stored(key: str) -> dict[str, Any]:
    """Return parameters of a peer that the search has found; what it begins with where it has not."""
    return stored_of(key, PEERS[key].choices)


def stored_of(key: str, choices: dict[str, tuple[Any, ...]]) -> dict[str, Any]:
    """Return parameters of that name in `parameters.toml`, and the first of the choices where there are none."""
    found: dict[str, Any] = {}
    if PARAMETERS.exists():
        found = tomllib.loads(PARAMETERS.read_text(encoding="utf-8")).get(key, {})
    return first_of(choices) | {name: value for name, value in found.items() if name in choices}
