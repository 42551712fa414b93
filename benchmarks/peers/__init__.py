"""What people use: one module for each way to find a ball, with all its variants.

Each module ends with `PEERS`: for each variant its key and a `Method` (see `common.start`): its name, what it is
given in the first frame, its parameters with the values that `python -m benchmarks.contest.search` tries, and one
function, from the first frame to a function that is called with every frame. `MODULES` says where each key is.
Read `mask_contour.py` first: it is the recipe of every tutorial.

None of these modules imports matchset except `matchset.py` and `paper.py`, so that the memory and the start of a peer
are its own.
"""

import importlib
import tomllib
from pathlib import Path
from typing import Any

from benchmarks.common.start import Method

PARAMETERS = Path(__file__).resolve().parent / "parameters.toml"
MODULES = {
    "matchset": "matchset",
    "paper": "paper",
    "contour_moments": "mask_contour",
    "contour_ellipse": "mask_contour",
    "hobby": "mask_contour",
    "region_bgr": "region",
    "region_moments": "region",
    "region_ellipse": "region",
    "edge_drawing": "edge_drawing",
    "region_edge_drawing": "edge_drawing",
    "mosse": "box_trackers",
    "kcf": "box_trackers",
    "csrt": "box_trackers",
    "cam_shift": "cam_shift",
    "hough_gradient": "hough",
    "hough_alt": "hough",
    "simple_blob": "simple_blob",
    "skimage_ransac": "skimage",
    "skimage_regions": "skimage",
    "visp_ellipse": "visp",
    "visp_dot": "visp",
    "april_tag": "tags",
    "aruco": "tags",
}


def stored() -> dict[str, Any]:
    """Parameters that the search has found, by peer; nothing for those it has not looked at."""
    if not PARAMETERS.exists():
        return {}
    peers: dict[str, Any] = tomllib.loads(PARAMETERS.read_text(encoding="utf-8")).get("peers", {})
    return peers


def load(key: str) -> tuple[Method, Any]:
    """Import the module of a peer.

    Parameters
    ----------
    key : str
        Its name in `MODULES`.

    Returns
    -------
    Method, parameters
        With the parameters that the search has found for it.

    Raises
    ------
    ImportError
        If what it needs is not installed.
    """
    methods: dict[str, Method] = importlib.import_module(f"benchmarks.peers.{MODULES[key]}").PEERS
    return methods[key], methods[key].parameters(**stored().get(key, {}))
