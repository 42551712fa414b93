"""`matchset preflight`: the checks before a real vehicle's motors turn, in their order, with its real devices.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import Force
from matchset.app.flight.command import Config
from matchset.app.flight.linked.options import LinkedOptions
from matchset.app.flight.output_files import RecordingFile

PREFLIGHT_EPILOG = """
[bold]Examples[/bold]

  matchset preflight --camera 0 --link crsf:///dev/ttyUSB0 --camera-file camera.toml --color ball.npz \
--marker-color marker.npz

  matchset preflight --config flight.toml -o preflight.json

The options are those of 'matchset fly'. The motors stay off: nothing is armed, and no throttle is sent. At a terminal \
it asks what no program can see; --unattended leaves that out. docs/first_flight.md has the way there.

Exit codes: 0 all checks passed or were skipped, 1 one failed, 2 bad input or options, 3 a device broke, 130 stopped \
by Ctrl-C.
"""

Report = Annotated[
    Path | None, typer.Option("-o", metavar="FILE.json", help="Write every check, what it wanted and what it found.")
]
JsonLines = Annotated[bool, typer.Option("--print", help="One line of JSON for each check, to stdout.")]
Unattended = Annotated[
    bool, typer.Option("--unattended", help="Ask nothing: what a person has to look at is skipped, and said.")
]


class PreflightOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset preflight`; each is explained where its type is defined."""

    config: Config = None
    linked: LinkedOptions = LinkedOptions()
    record: RecordingFile = None
    report: Report = None
    to_stdout: JsonLines = False
    unattended: Unattended = False
    force: Force = False


def preflight(options: PreflightOptions) -> int:
    """Check camera, radio, ball and computer before a first flight, one after the other; no motor turns."""
    from matchset.app.preflight.run import run

    return run(options)
