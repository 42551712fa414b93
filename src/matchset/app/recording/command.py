"""The command line of `matchset replay`."""

from pathlib import Path
from typing import Annotated

import typer

from matchset.app.cli_options import Force
from matchset.app.exit_codes import errors_in_one_line

REPLAY_EPILOG = """
[bold]Examples[/bold]

  matchset replay flight.mcap

  matchset replay flight.mcap --video flight.webm --report flight.html

The recorded pictures go through the very code that flew; every step must come out as it was recorded, bit for bit,
but for the computing times. A recording that was cut off in the middle is replayed as far as it goes.

Exit codes: 0 every step is the same, 1 some differ or there is none, 2 bad input or options, 130 stopped by Ctrl-C.
"""

FlightVideo = Annotated[
    Path | None,
    typer.Option("--video", metavar="OUT.webm", help="Film every camera side by side, and the chain from above."),
]
FlightReport = Annotated[
    Path | None, typer.Option("--report", metavar="OUT.html", help="Write a report with pictures, one HTML file.")
]
FlightRecord = Annotated[
    Path | None,
    typer.Option("--record", metavar="OUT.mcap", help="Record everything, for 'matchset replay'; 40 MB a second."),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Show nothing while it flies.")]


def replay(
    recording: Annotated[Path, typer.Argument(metavar="FILE.mcap", help="What 'fly --record' wrote.")],
    video: FlightVideo = None,
    report: FlightReport = None,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Fly a recorded flight again through the same code, and check that every step comes out the same."""
    with errors_in_one_line():
        from matchset.app.flight.outputs import FlightFiles
        from matchset.app.recording import replay_command

        files = FlightFiles(video=video, report=report, force=force)
        code = replay_command.replay(replay_command.ReplayOptions(recording, files, quiet))
    raise typer.Exit(code)
