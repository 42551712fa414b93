"""`matchset replay`: a recorded flight through the same code again; every step must come out the same.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from matchset.app.cli_options import Force
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.flight.fly.output_files import FlightFiles, Quiet, ReportFile, VideoFile

if TYPE_CHECKING:
    from matchset.flight.recording.replay import Replay

REPLAY_EPILOG = """
[bold]Examples[/bold]

  matchset replay flight.mcap

  matchset replay flight.mcap --video flight.webm --report flight.html

The recorded pictures go through the very code that flew; every step must come out as it was recorded, bit for bit,
but for the computing times. A recording that was cut off in the middle is replayed as far as it goes.

Exit codes: 0 every step is the same, 1 some differ, are missing or there is none, 2 bad input or options, 130 stopped
by Ctrl-C.
"""

LISTED = 5  # format: differences that are printed one by one

RecordingArgument = Annotated[Path, typer.Argument(metavar="FILE.mcap", help="What 'fly --record' wrote.")]


class ReplayOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset replay`; each is explained where its type is defined."""

    recording: RecordingArgument
    video: VideoFile = None
    report: ReportFile = None
    quiet: Quiet = False
    force: Force = False

    @property
    def files(self) -> FlightFiles:
        """The files that are written."""
        return FlightFiles(video=self.video, report=self.report)


def replay(options: ReplayOptions) -> int:
    """Fly a recorded flight again through the same code, and check that every step comes out the same."""
    options.files.check(options.force, [options.recording])
    from matchset.flight.fly.log import flight_summary
    from matchset.flight.fly.outputs import FlightOutputs
    from matchset.flight.recording.reader import RecordingReader
    from matchset.flight.recording.replay import Replay

    recorded = RecordingReader(options.recording)
    options.files.make_folders(options.force)
    replayed = Replay(recorded)
    with StopRequest() as stop, FlightOutputs(recorded.setup, options.files, options.quiet) as outputs:
        for chain_step in replayed:
            outputs.add(chain_step)
            if stop:
                break
    print(f"flight: {flight_summary(outputs.log)}")
    if recorded.cut_off:
        print(f"note: {options.recording} ends in the middle; what it holds was replayed", file=sys.stderr)
    for each in recorded.damaged:
        text = f"note: {options.recording} is damaged: {each.start:.2f} to {each.end:.2f} s are missing ({each.reason})"
        print(text + "; what follows is replayed, but not compared", file=sys.stderr)
    _print_differences(replayed, recorded.matchset)
    for path in options.files.paths:
        print(f"  {path}")
    if stop:
        print("note: stopped; the files hold what was replayed so far", file=sys.stderr)
        return stop.code
    return FOUND if replayed.steps and not replayed.differences and not recorded.damaged else NOT_FOUND


def _print_differences(replayed: "Replay", version: str) -> None:
    """Print how many steps differ, and the first differences."""
    differences = replayed.differences
    if not replayed.steps:
        print("not a single step is recorded")
    elif not differences:
        print(f"replayed {replayed.steps} steps: every one came out bit for bit as recorded")
    else:
        count = len(differences)
        print(f"replayed {replayed.steps} steps: {count} differ from what was recorded (by matchset {version})")
        for each in differences[:LISTED]:
            print(f"  tick {each.tick}, follower {each.follower}: {each.text}")
        if count > LISTED:
            print(f"  and {count - LISTED} more")
