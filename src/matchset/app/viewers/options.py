"""The options for files of viewers: `ViewerOptions`. This module is loaded for every `matchset --help`."""

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.numeric.imports import advice


class ViewerOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that name a file for a viewer of others."""

    mcap: Annotated[
        Path | None, typer.Option("--mcap", metavar="FILE", help="Write pictures and results for Foxglove: .mcap.")
    ] = None
    rerun: Annotated[
        Path | None, typer.Option("--rerun", metavar="FILE", help="Write pictures and results for Rerun: .rrd.")
    ] = None

    @property
    def files(self) -> list[Path]:
        """What is asked for."""
        return [path for path in (self.mcap, self.rerun) if path is not None]

    def check(self) -> None:
        """Check names and packages before anything is opened.

        Raises
        ------
        ValueError
            If a name has another ending, or a package is missing: says what to install.
        """
        for path, option, ending, package, extra in (
            (self.mcap, "--mcap", ".mcap", "mcap", "record"),
            (self.rerun, "--rerun", ".rrd", "rerun", "rerun"),
        ):
            if path is None:
                continue
            if path.suffix.lower() != ending:
                raise ValueError(f"{option} names a file that ends in {ending}, got {str(path)!r}")
            if find_spec(package) is None:
                raise ValueError(f"{option} needs the package {package}: {advice(extra)}")
