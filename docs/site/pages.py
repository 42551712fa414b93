"""The generated pages of the site, as Markdown: API and commands from their docstrings, the list of decisions."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

import matchset
from matchset.cli import app

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "matchset"
LAYERS = (
    *("shapes", "image", "media", "fitting", "tracking", "camera", "localization", "control", "sim", "links"),
    *("sharing", "app", "flight", "live", "batch"),
)

# file -> title, the names of `matchset.__all__` that it explains
API = {
    "tracking": ("Tracking", ("Tracker", "TrackerParameters", "TrackerConstants", "Track", "Lost", "detect")),
    "shapes": ("Shapes", ("Circle", "Ellipse", "Rectangle", "Quadrilateral", "Polygon", "Convex")),
    "pictures": ("Pictures and color", ("Video", "Frame", "ColorModel", "LinkError")),
    "meters": (
        "Camera and position",
        ("CameraModel", "BallTarget", "Localizer", "MarkerTracker", "Pose", "PoseFilter"),
    ),
    "drawing": ("Pictures and tables of results", ("draw", "draw_pose", "write_video", "table", "to_supervision")),
    "neighbors": ("Several balls", ("MultiTracker", "Target", "Neighbors", "Neighbor")),
    "sharing": ("Several computers", ("Share", "SharedTarget", "NetworkTables")),
}

# file -> title, the public folder of `matchset` whose names it explains
FOLDERS = {"sim": ("The simulated world", "sim"), "gym": ("Gymnasium", "gym")}


def generated() -> dict[str, str]:
    """All generated pages: path in the site -> Markdown."""
    pages = {f"api/{file}.md": _names_page(title, _public(names)) for file, (title, names) in API.items()}
    for file, (title, folder) in FOLDERS.items():
        pages[f"api/{file}.md"] = _folder_page(title, folder)
    index = {"api/index.md": _api_index(), "docs/decisions/index.md": _decisions_index()}
    return pages | index | {"api/parameters.md": _parameters_page(), "api/commands.md": _commands_page()}


def decisions() -> list[str]:
    """Paths of the decisions' pages, in their order."""
    return [path.relative_to(ROOT).as_posix() for path in sorted(ROOT.glob("docs/decisions/*.md"))]


def log() -> list[str]:
    """Paths of the log's pages, in the order of its index."""
    index = (ROOT / "docs" / "log" / "index.md").read_text(encoding="utf-8")
    return [f"docs/log/{name}" for name in re.findall(r"\]\((\w+\.md)\) \|$", index, re.MULTILINE)]


def anchor(name: str) -> str:
    """Full name of the place where a public name is defined: its anchor in the page of the API."""
    thing = getattr(matchset, name)
    return f"{thing.__module__}.{thing.__qualname__}"


def _public(names: tuple[str, ...]) -> list[str]:
    return [name for name in names if name in matchset.__all__]


def _names_page(title: str, names: list[str]) -> str:
    sections = [f"::: {anchor(name)}\n    options:\n      heading: matchset.{name}\n" for name in names]
    return "\n".join([f"# {title}", "", *sections])


def _folder_page(title: str, folder: str) -> str:
    """Sections of the names of a public folder; parameters have a page of their own."""
    lines = [f"# {title}", "", f"`import matchset as ms`, then `ms.{folder}.NAME`.", ""]
    for name in getattr(matchset, folder).__all__:
        thing = getattr(getattr(matchset, folder), name)
        if hasattr(thing, "__qualname__") and not name.endswith("Parameters"):
            where = f"{thing.__module__}.{thing.__qualname__}"
            lines.append(f"::: {where}\n    options:\n      heading: matchset.{folder}.{name}\n")
    return "\n".join(lines)


def _api_index() -> str:
    lines = ["# API", "", "`import matchset as ms`: these names are public.", ""]
    for file, (title, names) in API.items():
        lines += [f"## [{title}]({file}.md)", "", "| name | |", "| --- | --- |"]
        for name in _public(names):
            what = (getattr(matchset, name).__doc__ or "").strip().partition("\n")[0]
            lines.append(f"| [`{name}`]({file}.md#{anchor(name)}) | {what} |")
        lines.append("")
    for file, (title, folder) in FOLDERS.items():
        names = ", ".join(f"`{name}`" for name in getattr(matchset, folder).__all__)
        lines += [f"## [{title}]({file}.md)", "", f"In `ms.{folder}`: {names}.", ""]
    lines += ["## [Parameters](parameters.md)", "", "Every number that decides a result.", ""]
    return "\n".join([*lines, "## [Commands](commands.md)", "", "Every option of the command line."])


def _parameters_page() -> str:
    """All parameters structs of the package, in the order of the layers."""
    lines = ["# Parameters", "", "Every number that decides a result, with its unit and its default.", ""]
    shown = {anchor(name) for _, names in API.values() for name in _public(names)}
    for layer in LAYERS:
        structs = [name for path in sorted((PACKAGE / layer).rglob("*.py")) for name in _structs(path)]
        sections = [f"::: {name}\n    options:\n      heading_level: 3\n" for name in structs if name not in shown]
        lines += [f"## {layer}", "", *sections] if sections else []
    return "\n".join(lines)


def _structs(path: Path) -> list[str]:
    """Full names of the parameters structs that a file defines."""
    module = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
    classes = [node.name for node in ast.parse(path.read_text(encoding="utf-8")).body if isinstance(node, ast.ClassDef)]
    return [f"{module}.{name}" for name in classes if name.endswith("Parameters")]


def _decisions_index() -> str:
    lines = ["# Decisions", "", "Why things are as they are: half a page each, with what was measured.", ""]
    for name in decisions():
        text = (ROOT / name).read_text(encoding="utf-8")
        title = text.partition("\n")[0].removeprefix("# ")
        later = "".join(f"; {how} {link}" for how, link in _superseded(text))
        lines.append(f"- [{title}]({Path(name).name}){later}")
    return "\n".join(lines) + "\n"


def _superseded(text: str) -> list[tuple[str, str]]:
    """In what way, and the link of the decision that did it, as a decision says on its top."""
    found = re.findall(r"^(Superseded(?: in part)? by) (\[\d{3}\]\([\w-]+\.md\))", text, re.MULTILINE)
    return [(how.lower(), link) for how, link in found]


def _commands_page() -> str:
    """Every command with its options, as `--help` shows them."""
    lines = ["# Commands", "", "Every option, as `matchset COMMAND --help` shows it.", ""]
    for name, command in _commands("matchset", typer.main.get_command(app)):
        what = str(command.help or "").partition("\f")[0].strip()
        rows = [_option(each) for each in command.params if not getattr(each, "hidden", False)]
        lines += [f"## {name}", "", what, "", "| option | |", "| --- | --- |", *rows, ""]
    return "\n".join(lines)


def _commands(name: str, command: Any) -> Iterator[tuple[str, Any]]:
    """All commands below this one, with their full names."""
    below = getattr(command, "commands", None)
    if below is None:
        yield name, command
        return
    for word, each in below.items():
        yield from _commands(f"{name} {word}", each)


def _option(option: Any) -> str:
    """Write a row of a command's table."""
    if option.param_type_name == "argument":
        words = [(option.metavar or option.name).upper()]
    else:
        words = [*option.opts, *option.secondary_opts]
        words[-1] += f" {option.metavar}" if option.metavar else ""
    default = option.default
    says = isinstance(default, str | int | float) and not isinstance(default, bool) and default != ""
    text = f"{option.help or ''}{f' Default: {default}.' if says else ''}"
    return f"| {', '.join(f'`{word}`' for word in words)} | {' '.join(text.split())} |"
