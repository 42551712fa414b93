"""The options of `matchset calibrate`: `CalibrateOptions`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import Force, TargetOptions, Topic, TurnOptions


class BoardOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that describe a board."""

    board: Annotated[
        str | None, typer.Option(metavar="9x6", help="Inner corners of the board: 10 x 7 squares have 9x6.")
    ] = None
    square: Annotated[float | None, typer.Option(metavar="M", help="Side of a square, m.")] = None
    charuco: Annotated[float | None, typer.Option(metavar="M", help="It is a ChArUco board: a marker's side, m.")] = (
        None
    )
    dictionary: Annotated[str, typer.Option(metavar="NAME", help="The markers' dictionary.")] = "5X5_100"
    board_picture: Annotated[
        Path | None,
        typer.Option(metavar="OUT.pdf", help="Draw the board to print, .pdf, .svg or .png; no SOURCE then."),
    ] = None
    paper: Annotated[
        str | None, typer.Option(metavar="a4|letter", help="Paper of a .pdf or .svg; a4 if not given.")
    ] = None


class MountOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that ask how a camera is turned on its vehicle."""

    mount: Annotated[
        bool, typer.Option("--mount", help="Measure how the camera is turned on its vehicle, by a ball.")
    ] = False
    place: Annotated[
        list[str] | None,
        typer.Option(metavar="RIGHT,UP,AHEAD", help="Of the ball's center from the lens, m; one for each place."),
    ] = None
    camera_file: Annotated[
        Path | None, typer.Option("--camera-file", metavar="FILE.toml", help="The camera, for --mount.")
    ] = None
    marker_color: Annotated[
        list[Path] | None,
        typer.Option("--marker-color", metavar="FILE", help="Of the neighbor's marker: where on its ball is it?"),
    ] = None


class CalibrateOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset calibrate`."""

    sources: Annotated[
        list[str] | None,
        typer.Argument(metavar="SOURCE...", help="A video, a folder of pictures, a camera's number, or a URL."),
    ] = None
    topic: Topic = None
    mounted: TurnOptions = TurnOptions()
    printed_board: BoardOptions = BoardOptions()
    ball_diameter: Annotated[
        float | None, typer.Option(metavar="M", help="Use the ball in place of a board: its diameter, m.")
    ] = None
    at: Annotated[
        str | None, typer.Option(metavar="M,M,...", help="From the lens to the ball's nearest point, in turn, m.")
    ] = None
    mount: MountOptions = MountOptions()
    target: TargetOptions = TargetOptions()
    out: Annotated[Path | None, typer.Option("-o", metavar="FILE.toml", help="The camera file.")] = None
    force: Force = False
