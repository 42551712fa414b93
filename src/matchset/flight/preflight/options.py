"""The options of `matchset preflight`: `PreflightOptions`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import Force
from matchset.flight.fly.options import Config
from matchset.flight.fly.output_files import RecordingFile
from matchset.flight.linked.options import LinkedOptions

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
