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
from matchset.app.viewers.options import ViewerOptions


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
    camera: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The camera: .toml of 'calibrate', or .yaml of ROS or OpenCV.")
    ] = None
    fov: Annotated[
        float | None, typer.Option(metavar="DEG", help="In place of --camera: the horizontal field of view.")
    ] = None
    focal_sigma: Annotated[
        float | None,
        typer.Option(metavar="SHARE", help="Standard deviation of the focal length, as a share of it; 0.05 is 5 %."),
    ] = None
    diameter: Annotated[float | None, typer.Option(metavar="M", help="The ball's diameter.")] = None
    diameter_sigma: Annotated[
        float | None, typer.Option(metavar="M", help="Standard deviation of the diameter; it counts in every pose.")
    ] = None
    target: SeveralTargetOptions = SeveralTargetOptions()
    several: SeveralOptions = SeveralOptions()
    marker: MarkerOptions = MarkerOptions()
    marker_diameter: Annotated[
        float | None, typer.Option(metavar="M", help="Straight across a marker; without it 0.06.")
    ] = None
    markers: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="The ball, if it has several markers: see below.")
    ] = None
    video: AnnotatedVideo = None
    shown: ShownOptions = ShownOptions()
    viewers: ViewerOptions = ViewerOptions()
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
