"""The field: who competes, in the order of the tables, and with which parameters."""

import importlib
from collections.abc import Callable
from typing import Any

import msgspec

from benchmarks.common.start import Choices, Start, Step
from benchmarks.peers import load
from benchmarks.peers.visp import DRIVER

OURS, PAPER, RIVAL = "matchset", "paper", "region_bgr"
GRAY = ("edge_drawing", "hough_gradient", "hough_alt")
"""Detectors that look at the gray whole frame."""

LIGHT = (
    OURS,
    "region_bgr",
    "region_moments",
    "region_ellipse",
    "region_edge_drawing",
    "contour_moments",
    "contour_ellipse",
    "cam_shift",
    "mosse",
    "visp_ellipse",
    "visp_dot",
)
"""Those that take about a millisecond or less: they are timed among themselves."""

HEAVY = (
    "hobby",
    "simple_blob",
    "skimage_regions",
    "skimage_ransac",
    "kcf",
    *GRAY,
    "csrt",
    PAPER,
)
TAGS = ("april_tag", "aruco")
PEERS = (*LIGHT, *HEAVY)

NEEDS_WORDS = {"nothing": "nothing", "color": "the color of the ball", "circle": "the circle in the first frame"}


class Peer(msgspec.Struct, frozen=True):
    """One of the methods in `peers/`, with the parameters that were found for it.

    Parameters
    ----------
    key : str
        Its name in `peers.MODULES`.
    name : str
        For tables.
    needs : str
        What it is given in the first frame: "nothing", "color" or "circle".
    parameters : Struct
        A struct, see its module.
    choices : mapping of str to sequence
        What the search tries.
    start : callable
        From the first frame and parameters to a function of a frame.
    """

    key: str
    name: str
    needs: str
    parameters: Any
    choices: Choices
    start: Callable[[Start, Any], Step]

    @property
    def detects(self) -> bool:
        """It needs no place to begin at."""
        return self.needs != "circle"

    def follow(self, start: Start) -> Step:
        """Begin with the parameters that were found."""
        return self.start(start, self.parameters)


def peer(key: str) -> Peer:
    """Load a peer.

    Parameters
    ----------
    key : str
        Its name in `peers.MODULES`.

    Returns
    -------
    Peer

    Raises
    ------
    ImportError
        If what it needs is not installed.
    """
    method, parameters = load(key)
    return Peer(key, method.name, method.needs, parameters, method.choices, method.follow)


def missing(key: str) -> str:
    """Say why a peer cannot run here, empty if it can."""
    if key.startswith("visp") and not DRIVER.exists():
        note = DRIVER.with_suffix(".missing")
        return note.read_text(encoding="utf-8").strip() if note.exists() else "its driver was not built (`make bench`)"
    try:
        peer(key)
        if key == "april_tag":
            importlib.import_module("pupil_apriltags")
        if key.startswith("skimage"):
            importlib.import_module("skimage")
    except ImportError as error:
        return f"not installed ({error.name or error})"
    return ""


def present(keys: tuple[str, ...]) -> list[Peer]:
    """Load those that can run here."""
    return [peer(key) for key in keys if not missing(key)]
