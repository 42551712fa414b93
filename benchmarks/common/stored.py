"""A peer's file and the parameters that the search has found for it."""

import importlib
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

PARAMETERS = Path(__file__).resolve().parents[1] / "peers" / "parameters.toml"


def stored() -> dict[str, Any]:
    """Parameters that the search has found, by peer; nothing for those it has not looked at."""
    if not PARAMETERS.exists():
        return {}
    peers: dict[str, Any] = tomllib.loads(PARAMETERS.read_text(encoding="utf-8")).get("peers", {})
    return peers


def load(key: str) -> tuple[ModuleType, Any]:
    """Import a peer's file.

    Parameters
    ----------
    key : str
        Its name.

    Returns
    -------
    module, parameters

    Raises
    ------
    ImportError
        If what it needs is not installed.
    """
    module = importlib.import_module(f"benchmarks.peers.{key}")
    return module, module.Parameters(**stored().get(key, {}))
