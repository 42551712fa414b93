"""Help pages: a faster start (`load_help_printer`), and pages for narrow terminals (`plain_help`)."""

import importlib
import re
import sys
import types

import typer

NARROW = 72  # format: columns of a terminal below which a table of options has no room for words
_MARKUP = re.compile(r"\\(?=\[)|\[/?bold\]")
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


def plain_help(app: typer.Typer) -> None:
    """Let an app and the apps in it print their help as lines of text that wrap, in place of tables."""
    app.rich_markup_mode = None
    for command in app.registered_commands:
        if isinstance(command.epilog, str):
            command.epilog = _MARKUP.sub("", command.epilog)
    for group in app.registered_groups:
        if group.typer_instance is not None:
            plain_help(group.typer_instance)
