"""The options of `matchset locate`: `LocateOptions`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import (
    AnnotatedVideo,
    Folder,
    Force,
    Fps,
    Params,
    Points,
    SeveralTargetOptions,
    ShownOptions,
    SilenceOptions,
    Source,
    Topic,
    ToStdout,
    ViewOptions,
)
from matchset.app.several.options import SeveralOptions

CameraFile = Annotated[
    Path | None,
    typer.Option("--camera", metavar="FILE", help="The camera: .toml of 'calibrate', or .yaml of ROS or OpenCV."),
]
FieldOfView = Annotated[
    float | None, typer.Option("--fov", metavar="DEG", help="In place of --camera: the horizontal field of view.")
]
FocalSigma = Annotated[
    float | None,
    typer.Option(
        "--focal-sigma",
        metavar="SHARE",
        help="Standard deviation of the focal length, as a share of it; 0.05 is 5 %.",
    ),
]
Diameter = Annotated[float | None, typer.Option("--diameter", metavar="M", help="The ball's diameter.")]
DiameterSigma = Annotated[
    float | None,
    typer.Option("--diameter-sigma", metavar="M", help="Standard deviation of the diameter; it counts in every pose."),
]
MarkerDiameter = Annotated[
    float | None,
    typer.Option("--marker-diameter", metavar="M", help="Straight across a marker; without it 0.06."),
]
MarkersFile = Annotated[
    Path | None,
    typer.Option("--markers", metavar="FILE.toml", help="The ball, if it has several markers: see below."),
]


class MarkerOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that say what color the markers have; at most one of the two is given."""

    marker_pick: Annotated[
        str | None,
        typer.Option(metavar="X,Y[@FRAME]", help="A pixel on a marker, in the ball's frame or FRAME."),
    ] = None
    marker_color: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="A color of the markers; several are joined."),
    ] = None

    @property
    def given(self) -> bool:
        """Whether there are markers to track."""
        return self.marker_pick is not None or bool(self.marker_color)


class LocateOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset locate`."""

    source: Source
    topic: Topic = None
    view: ViewOptions = ViewOptions()
    camera: CameraFile = None
    fov: FieldOfView = None
    focal_sigma: FocalSigma = None
    diameter: Diameter = None
    diameter_sigma: DiameterSigma = None
    target: SeveralTargetOptions = SeveralTargetOptions()
    several: SeveralOptions = SeveralOptions()
    marker: MarkerOptions = MarkerOptions()
    marker_diameter: MarkerDiameter = None
    markers: MarkersFile = None
    video: AnnotatedVideo = None
    shown: ShownOptions = ShownOptions()
    out: Folder = None
    jsonl: Annotated[bool, typer.Option("--jsonl", help="Write poses.jsonl too.")] = False
    to_stdout: ToStdout = False
    mavlink: Annotated[
        str | None, typer.Option(metavar="URI", help="Send the poses to an autopilot too: docs/mavlink.md.")
    ] = None
    force: Force = False
    points: Points = 64
    params: Params = None
    fps: Fps = None
    silence: SilenceOptions = SilenceOptions()
