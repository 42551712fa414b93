"""The command `matchset locate`.

This module is loaded for every `matchset --help`; the functions import what they need.
"""

import msgspec

from matchset.app.cli_options import LARGE_BALL, unit_note
from matchset.app.exit_codes import EXIT_CODES
from matchset.app.locate.options import LocateOptions
from matchset.app.several.options import are_several, check_several, color_files

LOCATE_EPILOG = f"""
[bold]Examples[/bold]

  matchset locate ball.mp4 --camera camera.toml --diameter 0.28 --candidate 1 --video out.webm

  matchset locate ball.mp4 --fov 62 --diameter 0.28 --pick 300,210 --marker-pick 346,212

  matchset locate swarm.mp4 --fov 62 --diameter 0.28 --pick 300,210 --all

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


def locate(options: LocateOptions) -> int:
    """Say where a ball of known size is, in meters, and the camera as the ball's markers see it."""
    check_several(options)
    _check_outputs(options)
    several = are_several(options)
    options = options if several else msgspec.structs.replace(options, target=options.target.single)
    from matchset.app.locate.run import run_locate
    from matchset.app.locate.what_options_name import check_options

    check_options(msgspec.structs.replace(options, target=options.target.single))
    unit_note("--diameter", options.diameter, LARGE_BALL)
    unit_note("--diameter-sigma", options.diameter_sigma, LARGE_BALL)
    unit_note("--marker-diameter", options.marker_diameter, LARGE_BALL)
    if several:
        from matchset.app.several.locate_run import run_locate_several

        return run_locate_several(options)
    return run_locate(options)


def _check_outputs(options: LocateOptions) -> None:
    """Check the outputs before anything is opened or loaded."""
    from matchset.app.run_folder import check_run

    shown = options.shown.names("locate", options.video, options.to_stdout)
    tables = "poses.csv", "latency.csv", *(("poses.jsonl",) if options.jsonl else ())
    names = *tables, "poses.png", "why.png", *shown
    colors = [*color_files(options.target.color), *(options.marker.marker_color or ())]
    inputs = [options.source, options.camera, options.markers, options.params, *colors]
    files = [options.video, options.shown.gif, *options.viewers.files]
    check_run(options.out, names, files, inputs, options.force)
    options.shown.check(options.video)
    options.viewers.check()
    if options.mavlink is not None:
        from matchset.app.adapters.mavlink_poses import parse_publisher

        parse_publisher(options.mavlink)
