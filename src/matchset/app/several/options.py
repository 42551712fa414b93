"""The options for several targets, checked (`check_several`). This module is loaded for every `matchset --help`."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Protocol

import msgspec
import typer

from matchset.app.cli_options import SeveralTargetOptions, ShownOptions, ViewOptions

MOST = 20  # format: targets at once without --most
_NAMED = re.compile(r"([\w .-]{1,40})=(.+)")


class SeveralOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that are about several targets."""

    every: Annotated[
        bool, typer.Option("--all", help="Follow all that looks like it, each with an identity of its own.")
    ] = False
    most: Annotated[
        int | None, typer.Option("--most", metavar="N", help="Follow so many at once, 1 to 100; 20 without it.")
    ] = None
    smooth: Annotated[
        bool,
        typer.Option(
            "--smooth", help="Read a file forward and backward: identities are corrected by what comes later."
        ),
    ] = False
    on_table: Annotated[
        bool, typer.Option("--on-table", help="They roll on a table seen from above, and bounce off each other.")
    ] = False


class MotOptions(SeveralOptions, frozen=True, kw_only=True):
    """The same with `--mot`."""

    mot: Annotated[
        Path | None, typer.Option("--mot", metavar="FILE", help="Write what is found as MOTChallenge text, too.")
    ] = None


class TypedOptions(Protocol):
    """What is needed of the options of a command."""

    @property
    def target(self) -> SeveralTargetOptions:
        """What to track."""
        ...

    @property
    def several(self) -> SeveralOptions:
        """Of several targets."""
        ...

    @property
    def source(self) -> str:
        """What is read."""
        ...

    @property
    def topic(self) -> str | None:
        """Of a bag."""
        ...

    @property
    def view(self) -> ViewOptions:
        """How its pictures are used."""
        ...

    @property
    def shown(self) -> ShownOptions:
        """With the part that is used."""
        ...

    @property
    def out(self) -> Path | None:
        """The folder of the run."""
        ...

    @property
    def force(self) -> bool:
        """Whether files may be overwritten."""
        ...

    @property
    def params(self) -> Path | None:
        """A file of a single tracker's parameters."""
        ...


def named_color(path: Path) -> tuple[str, Path]:
    """Split ``NAME=FILE``; the name is empty where there is none, or a file has the whole name."""
    found = None if path.is_file() else _NAMED.fullmatch(str(path))
    return ("", path) if found is None else (found[1], Path(found[2]))


def color_files(colors: Sequence[Path] | None) -> list[Path]:
    """Return the files of colors, without their names."""
    return [named_color(path)[1] for path in colors or ()]


def are_several(options: TypedOptions) -> bool:
    """Whether what was typed is about several targets."""
    named = any(named_color(path)[0] for path in options.target.color or ())
    return options.several.every or len(options.target.picks or ()) > 1 or named


def check_several(options: TypedOptions) -> None:
    """Check the options for several targets, before anything is opened.

    Raises
    ------
    ValueError
        If they do not fit together, in one line.
    """
    most, picks = options.several.most, options.target.picks or []
    if most is not None and not 1 <= most <= 100:
        raise ValueError(f"--most must be 1 to 100, got {most}")
    if not are_several(options):
        several = options.several
        for option, given in (
            ("--most", most is not None),
            ("--smooth", several.smooth),
            ("--on-table", several.on_table),
        ):
            if given:
                raise ValueError(
                    f"{option} is of several targets: give --all, --pick several times or --color NAME=FILE"
                )
        return
    if options.params is not None:
        raise ValueError("--params is of the tracker of one target: leave it out with --all or several targets")
    if most is not None and most < len(picks):
        raise ValueError(f"--most {most} is less than the number of --pick, {len(picks)}")
    if len(picks) > 1 and options.target.reading != 1:
        raise ValueError(f"--reading {options.target.reading} is of one --pick, got {len(picks)}")
    twice = [text for k, text in enumerate(picks) if text in picks[:k]]
    if twice:
        raise ValueError(f"--pick {twice[0]} is given twice")
    _check_names([named_color(path) for path in options.target.color or ()])


def _check_names(colors: Sequence[tuple[str, Path]]) -> None:
    names = [name for name, _ in colors]
    if any(names) and not all(names):
        file = next(path for name, path in colors if not name)
        raise ValueError(f"of several targets each color has a name, NAME=FILE; got --color {file}")
    for k, (name, path) in enumerate(colors):
        if name and name in names[:k]:
            raise ValueError(f"two colors are named {name!r}: each needs a name of its own")
        other = next((other for other, file in colors[:k] if name and file == path), None)
        if other is not None:
            raise ValueError(f"--color {path} is named {other!r} and {name!r}: one name is enough")
