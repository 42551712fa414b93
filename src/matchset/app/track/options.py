"""The options of `track`, `learn`, `score`, `demo` and `params`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import (
    AnnotatedVideo,
    Folder,
    Force,
    Fps,
    GrayTargetOptions,
    Params,
    Points,
    ReadingNumber,
    ShapeName,
    ShownOptions,
    SilenceOptions,
    Source,
    Topic,
    ToStdout,
    ViewOptions,
)
from matchset.app.several.options import MotOptions
from matchset.app.viewers.options import ViewerOptions


class TrackOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset track`."""

    source: Source
    topic: Topic = None
    view: ViewOptions = ViewOptions()
    target: GrayTargetOptions = GrayTargetOptions()
    several: MotOptions = MotOptions()
    shape: ShapeName = "circle"
    video: AnnotatedVideo = None
    shown: ShownOptions = ShownOptions()
    viewers: ViewerOptions = ViewerOptions()
    out: Folder = None
    jsonl: Annotated[bool, typer.Option("--jsonl", help="Write tracks.jsonl too.")] = False
    to_stdout: ToStdout = False
    force: Force = False
    points: Points = 64
    params: Params = None
    fps: Fps = None
    silence: SilenceOptions = SilenceOptions()


class LearnOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset learn`."""

    source: Source
    topic: Topic = None
    view: ViewOptions = ViewOptions()
    frame: Annotated[
        int | None,
        typer.Option(min=0, help="The frame to look at; without it one that shows a ball is chosen."),
    ] = None
    pick: Annotated[
        str | None,
        typer.Option(metavar="X,Y[@FRAME]", help="A pixel on the ball: learn its color and save it."),
    ] = None
    reading: ReadingNumber = 1
    marker: Annotated[bool, typer.Option("--marker", help="The --pick lies on a ball's marker: learn that spot.")] = (
        False
    )
    out: Annotated[
        Path | None,
        typer.Option("-o", metavar="FILE", help="The color file (.npz); without a pick, the picture."),
    ] = None
    shape: ShapeName = "circle"
    force: Force = False
    silence: SilenceOptions = SilenceOptions()


class ScoreOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset score`."""

    tracks: Annotated[Path, typer.Argument(help="tracks.csv of 'matchset track'.")]
    truth: Annotated[Path, typer.Argument(help="Truth: video,frame,x,y,r,visible,method.")]
    as_json: Annotated[bool, typer.Option("--json", help="Print one line of JSON.")] = False
    start: Annotated[int, typer.Option("--from", min=0, metavar="FRAME", help="Score from this frame on.")] = 0
    video: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which video's rows, if the truth holds several.")
    ] = None
    identity: Annotated[
        int | None, typer.Option(min=0, metavar="N", help="Whose rows, if the tracks are of several targets.")
    ] = None


class DemoOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset demo`."""

    out: Annotated[Path | None, typer.Option("-o", metavar="DIR", help="Folder for what it writes.")] = None
    frames: Annotated[int, typer.Option(min=10, max=100_000, help="Length of the clip.")] = 300
    shape: ShapeName = "circle"
    force: Force = False


class ParamsOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset params`."""

    params: Params = None
