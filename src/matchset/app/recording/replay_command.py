"""`matchset replay`: a recorded flight through the same code again, and whether every step comes out the same."""

import sys
from pathlib import Path

import msgspec

from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.app.flight.log import verdict
from matchset.app.flight.outputs import FlightFiles, FlightOutputs
from matchset.app.recording.reader import RecordingReader
from matchset.app.recording.replay import Replay

SAID = 5
"""Differences that are told one by one."""


class ReplayOptions(msgspec.Struct, frozen=True):
    """The options of `matchset replay`, as typed."""

    recording: Path
    files: FlightFiles = FlightFiles()
    quiet: bool = False


def replay(options: ReplayOptions) -> int:
    """Run the command.

    Returns
    -------
    int
        0 if every step came out as it was recorded, 1 if not, or the code of the signal that stopped it.
    """
    recorded = RecordingReader(options.recording)
    _refuse_itself(options)
    options.files.check()
    flown = Replay(recorded)
    with StopRequest() as stop, FlightOutputs(recorded.setup, options.files, options.quiet) as outputs:
        for chain_step in flown:
            outputs.show(chain_step)
            if stop:
                break
    print(f"flight: {verdict(outputs.log)}")
    if recorded.cut_off:
        print(f"note: {options.recording} ends in the middle; what it holds was replayed", file=sys.stderr)
    _say(flown, recorded.matchset)
    for path in options.files.paths:
        print(f"  {path}")
    if stop:
        print("note: stopped; the files hold what was replayed so far", file=sys.stderr)
        return stop.code
    return FOUND if flown.steps and not flown.differences else NOT_FOUND


def _refuse_itself(options: ReplayOptions) -> None:
    """Refuse to write over the recording that is being read."""
    for path in options.files.paths:
        if path.resolve() == options.recording.resolve():
            raise ValueError(f"{path} is the recording itself")


def _say(flown: Replay, version: str) -> None:
    """Say how exactly it was reproduced."""
    wrong = flown.differences
    if not flown.steps:
        print("not a single step is recorded")
    elif not wrong:
        print(f"replayed {flown.steps} steps: every one came out bit for bit as recorded")
    else:
        print(f"replayed {flown.steps} steps: {len(wrong)} differ from what was recorded (by matchset {version})")
        for each in wrong[:SAID]:
            print(f"  tick {each.tick}, follower {each.follower}: {each.words}")
        if len(wrong) > SAID:
            print(f"  and {len(wrong) - SAID} more")
