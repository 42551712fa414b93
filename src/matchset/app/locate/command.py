"""The command `matchset locate`: its options and its run.

This module is loaded for every `matchset --help`; the functions import what they need.
"""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import (
    LARGE_BALL,
    AnnotatedVideo,
    Folder,
    Force,
    Fps,
    Params,
    Points,
    ShownOptions,
    SilenceOptions,
    Source,
    TargetOptions,
    Topic,
    ToStdout,
    ViewOptions,
    unit_note,
)
from matchset.app.exit_codes import EXIT_CODES

LOCATE_EPILOG = f"""
[bold]Examples[/bold]

  matchset locate ball.mp4 --camera camera.toml --diameter 0.28 --candidate 1 --video out.webm

  matchset locate ball.mp4 --fov 62 --diameter 0.28 --pick 300,210 --marker-pick 346,212

  matchset locate 0 --camera camera.toml --markers ball.toml --color ball.npz --marker-color marker.npz --print

Without -o everything goes to a new folder, runs/0001-locate and so on. poses.png shows the path, poses.csv holds one
row a frame: x (right), y (down), z (forward) of the ball before the camera, m; side, height, heading of the camera as
the ball sees it, m, and yaw, rad, where a marker is seen; their standard deviations; what was observed, and why it
was lost. Without --diameter-sigma and --focal-sigma, or a calibrated camera, these leave out how well the diameter
and the focal length are known.

A ball's file is TOML: diameter = 0.28, marker_diameter = 0.06, markers = \\[[0, 0, 1], [0.77, 0, 0.64]], directions
from its center: z out through marker 0, y down, x = y cross z.

{EXIT_CODES}
"""


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
    target: TargetOptions = TargetOptions()
    marker: MarkerOptions = MarkerOptions()
    marker_diameter: Annotated[
        float | None, typer.Option(metavar="M", help="Straight across a marker; without it 0.06.")
    ] = None
    markers: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="The ball, if it has several markers: see below.")
    ] = None
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


def locate(options: LocateOptions) -> int:
    """Say where a ball of known size is, in meters, and the camera as the ball's markers see it."""
    _check_outputs(options)
    from matchset.app.locate.options import check_options
    from matchset.app.locate.run import run_locate

    check_options(options)
    unit_note("--diameter", options.diameter, LARGE_BALL)
    unit_note("--diameter-sigma", options.diameter_sigma, LARGE_BALL)
    unit_note("--marker-diameter", options.marker_diameter, LARGE_BALL)
    return run_locate(options)


def _check_outputs(options: LocateOptions) -> None:
    """Check the outputs before anything is opened or loaded."""
    from matchset.app.run_folder import check_run

    shown = options.shown.names("locate", options.video, options.to_stdout)
    tables = "poses.csv", "latency.csv", *(("poses.jsonl",) if options.jsonl else ())
    names = *tables, "poses.png", "why.png", *shown
    colors = [*(options.target.color or ()), *(options.marker.marker_color or ())]
    inputs = [options.source, options.camera, options.markers, options.params, *colors]
    check_run(options.out, names, [options.video, options.shown.gif], inputs, options.force)
    options.shown.check(options.video)
    if options.mavlink is not None:
        from matchset.app.adapters.mavlink_poses import parse_publisher

        parse_publisher(options.mavlink)
