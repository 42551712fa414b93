"""The options of `matchset batch`: `BatchOptions`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import (
    End,
    Fps,
    GrayTargetOptions,
    Params,
    Points,
    ShapeName,
    Start,
    ViewOptions,
)
from matchset.app.locate.options import (
    CameraFile,
    Diameter,
    DiameterSigma,
    FieldOfView,
    FocalSigma,
    MarkerDiameter,
    MarkerOptions,
    MarkersFile,
)
from matchset.app.several.options import SeveralOptions


class LocateBatchOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset locate` that a batch has too."""

    locate: Annotated[
        bool, typer.Option("--locate", help="Locate as 'matchset locate' does; without it follow, as 'track' does.")
    ] = False
    camera: CameraFile = None
    fov: FieldOfView = None
    focal_sigma: FocalSigma = None
    diameter: Diameter = None
    diameter_sigma: DiameterSigma = None
    marker: MarkerOptions = MarkerOptions()
    marker_diameter: MarkerDiameter = None
    markers: MarkersFile = None


class WorkerOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say who does the work."""

    jobs: Annotated[
        int | None,
        typer.Option("--jobs", metavar="N", min=1, help="So many processes; without it one for each processor."),
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", metavar="tcp://HOST:PORT", help="The workers of this scheduler of Dask, in place of --jobs."
        ),
    ] = None
    split: Annotated[
        float | None,
        typer.Option(
            "--split", metavar="S", help="Cut videos longer than this into stretches, s, for several workers."
        ),
    ] = None


class ChoiceOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say what is followed where that differs from video to video."""

    color_name: Annotated[
        str | None,
        typer.Option(
            "--color-name",
            metavar="NAME.npz",
            help="Each video has the color file of this name beside it, or in the next folder above that has one.",
        ),
    ] = None
    clicks: Annotated[
        Path | None,
        typer.Option("--clicks", metavar="FILE.csv", help="A click for each video: columns video,frame,x,y."),
    ] = None
    auto: Annotated[
        bool, typer.Option("--auto", help="Follow what is most likely the ball; where that is doubtful, ask.")
    ] = False


class BatchOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset batch`."""

    videos: Annotated[
        list[str],
        typer.Argument(
            metavar="FOLDER|LIST.txt|GLOB ...", help="Videos: a folder, a list with one in each line, names."
        ),
    ]
    out: Annotated[
        str, typer.Option("--out", "-o", metavar="DIR", help="Folder for all results, or a URL that fsspec knows.")
    ]
    worker: WorkerOptions = WorkerOptions()
    choice: ChoiceOptions = ChoiceOptions()
    view: ViewOptions = ViewOptions()
    target: GrayTargetOptions = GrayTargetOptions()
    several: SeveralOptions = SeveralOptions()
    shape: ShapeName = "circle"
    start: Start = None
    end: End = None
    located: LocateBatchOptions = LocateBatchOptions()
    points: Points = 64
    params: Params = None
    fps: Fps = None
    films: Annotated[
        bool, typer.Option("--films", help="Write the annotated video and summary.png of each video, too.")
    ] = False
    retry: Annotated[bool, typer.Option("--retry", help="Do those again that failed before.")] = False
    page: Annotated[
        bool, typer.Option("--page", help="Show a page on which what is doubtful can be clicked (extra web).")
    ] = False
