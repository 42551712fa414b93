"""What is imported when it is used: public names, `lazy_names`, and packages that may be missing, `advice`."""

import sys
from collections.abc import Callable, Mapping
from importlib import import_module

# format: packages of each extra, as pyproject.toml names them; tests/numeric/test_imports.py compares
EXTRAS = {
    "av": "av>=15",
    "batch": "distributed>=2025.1",
    "frc": "pyntcore>=2026.2",
    "gym": "gymnasium>=1.0",
    "net": "eclipse-zenoh>=1.5.1",
    "record": "mcap>=1.6",
    "rerun": "rerun-sdk>=0.41",
    "ros": "rosbags>=0.11 mcap>=1.6",
    "serial": "pyserial>=3.5",
    "web": "starlette>=0.46 uvicorn>=0.34 websockets>=14 segno>=1.6",
}


def advice(extra: str) -> str:
    """Return what to type to get the packages of an extra: it works wherever `matchset` came from.

    Parameters
    ----------
    extra : str
        A name of `EXTRAS`.

    Returns
    -------
    str
        Such as ``pip install 'mcap>=1.6'``.
    """
    return "pip install " + " ".join(f"'{package}'" for package in EXTRAS[extra].split())


def lazy_names(package: str, modules: Mapping[str, str]) -> Callable[[str], object]:
    """Return the `__getattr__` of a package: it loads a public name when that is first used.

    Parameters
    ----------
    package : str
        Its `__name__`.
    modules : mapping of str to str
        The module that each name is from.
    """

    def load(name: str) -> object:
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        found: object = getattr(import_module(modules[name]), name)
        setattr(sys.modules[package], name, found)
        return found

    return load
