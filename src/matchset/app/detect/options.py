"""The options of `detect`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import Force, ReadingNumber, SilenceOptions, Source, Topic, ViewOptions

MOST = 20  # format: discs that are shown without --most


class DetectOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset detect`."""

    source: Source
    pick: Annotated[str, typer.Option(metavar="X,Y[@FRAME]", help="A pixel on the ball, in frame 0 or FRAME.")]
    topic: Topic = None
    view: ViewOptions = ViewOptions()
    reading: ReadingNumber = 1
    every: Annotated[bool, typer.Option("--all", help="Find all that look like it, in the same picture.")] = False
    most: Annotated[
        int | None,
        typer.Option("--most", metavar="N", min=1, max=1000, help=f"With --all, show so many; {MOST} without it."),
    ] = None
    out: Annotated[
        Path | None, typer.Option("-o", metavar="FILE", help="The picture with what was found (.png or .jpg).")
    ] = None
    force: Force = False
    silence: SilenceOptions = SilenceOptions()
