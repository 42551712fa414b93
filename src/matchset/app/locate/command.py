"""The options of `matchset locate`."""

from pathlib import Path
from typing import Annotated

import typer

from matchset.app.cli_options import (
    AnnotatedVideo,
    Candidate,
    Color,
    Folder,
    Force,
    Hsv,
    Pick,
    Points,
    Source,
    ToStdout,
)
from matchset.app.exit_codes import EXIT_CODES, errors_in_one_line

LOCATE_EPILOG = f"""
[bold]Examples[/bold]

  matchset locate ball.mp4 --camera camera.toml --diameter 0.28 --candidate 1 --video out.webm

  matchset locate ball.mp4 --fov 62 --diameter 0.28 --pick 300,210 --marker-pick 346,212

  matchset locate 0 --camera camera.toml --markers ball.toml --color ball.npz --marker-color marker.npz --print

Without -o everything goes to a new folder, runs/0001-locate and so on. poses.png shows the path, poses.csv holds one
row a frame: x (right), y (down), z (forward) of the ball before the camera, m; side, height, heading of the camera as
the ball sees it, m, and yaw, rad; their standard deviations; what was observed, and why it was lost.

A ball's file is TOML: diameter = 0.28, marker_diameter = 0.06, markers = \\[[0, 0, 1], [0.77, 0, 0.64]], directions
from its center: z out through marker 0, y down, x = y cross z.

{EXIT_CODES}
"""


def locate(
    source: Source,
    camera: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The camera: .toml of 'calibrate', or .yaml of ROS or OpenCV.")
    ] = None,
    fov: Annotated[
        float | None, typer.Option(metavar="DEG", help="In place of --camera: the horizontal field of view.")
    ] = None,
    diameter: Annotated[float | None, typer.Option(metavar="M", help="The ball's diameter.")] = None,
    pick: Pick = None,
    candidate: Candidate = None,
    color: Color = None,
    hsv: Hsv = None,
    marker_pick: Annotated[
        str | None, typer.Option(metavar="X,Y[@FRAME]", help="A pixel on a marker, in the ball's frame or FRAME.")
    ] = None,
    marker_color: Annotated[
        list[Path] | None, typer.Option(metavar="FILE", help="A color of the markers; several are joined.")
    ] = None,
    marker_diameter: Annotated[
        float | None, typer.Option(metavar="M", help="Straight across a marker; without it 0.06.")
    ] = None,
    markers: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="The ball, if it has several markers: see below.")
    ] = None,
    video: AnnotatedVideo = None,
    out: Folder = None,
    jsonl: Annotated[bool, typer.Option("--jsonl", help="Write poses.jsonl too.")] = False,
    to_stdout: ToStdout = False,
    force: Force = False,
    points: Points = 64,
) -> None:
    """Say where a ball of known size is, in meters, and the camera as the ball's markers see it."""
    with errors_in_one_line():
        from matchset.app.locate import run as locate_command
        from matchset.app.locate.marker_wish import MarkerWish
        from matchset.app.track.target_options import Wish

        options = locate_command.LocateOptions(
            source=source,
            wish=Wish(pick, candidate, tuple(color or ()), tuple(hsv or ())),
            marker=MarkerWish(marker_pick, tuple(marker_color or ())),
            camera=camera,
            fov_deg=fov,
            diameter=diameter,
            marker_diameter=marker_diameter,
            markers=markers,
            folder=out,
            video=video,
            jsonl=jsonl,
            print=to_stdout,
            force=force,
            points=points,
        )
        code = locate_command.run_locate(options)
    raise typer.Exit(code)
