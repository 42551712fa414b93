"""A faster start of `matchset --help`: `load_help_printer`."""

import importlib
import sys
import types

_UNUSED = {"rich.markdown": "Markdown", "rich.traceback": "Traceback"}


def load_help_printer() -> None:
    """Load Typer's printer of help pages without Rich's Markdown and tracebacks, which the pages do not contain.

    These two modules (and the parsers of Markdown and source code below them) take a third of the time of `--help`.
    Whoever imports them later gets the real ones.
    """
    if "typer.rich_utils" in sys.modules or any(module in sys.modules for module in _UNUSED):
        return
    for module, name in _UNUSED.items():
        empty = types.ModuleType(module)
        setattr(empty, name, type(name, (), {}))
        sys.modules[module] = empty
    try:
        importlib.import_module("typer.rich_utils")
    finally:
        for module in _UNUSED:
            del sys.modules[module]
