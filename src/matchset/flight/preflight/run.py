"""Makes the checks until one fails, shows them, writes them and says what to type next: `run`."""

import sys
from collections.abc import Generator, Sequence
from contextlib import closing
from pathlib import Path

import msgspec
from rich.console import Console
from rich.table import Table
from rich.text import Text

from matchset.app.disk import FreeSpace, size_text
from matchset.app.exit_codes import BAD_INPUT, FOUND
from matchset.app.guidance.next_command import shell_command
from matchset.app.run_folder import check_outputs, output_file
from matchset.flight.chain.config import flight_parameters
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked.opening import check_followers
from matchset.flight.linked.parameters import LinkedFollower
from matchset.flight.preflight.options import PreflightOptions
from matchset.flight.preflight.outcome import CheckOutcome, judged
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.flight.preflight.person import somebody
from matchset.flight.preflight.sequence import Bench, flight_of, vehicle_checks
from matchset.image.files.whole_file import write_whole

RECORDING_RATE = 20e6  # format: bytes a second that a recording of one follower takes: docs/recording.md
RECORDING = Path("first.mcap")
STYLES = {"pass": "green", "fail": "bold red", "skipped": "yellow"}


def run(options: PreflightOptions, bench: Bench | None = None) -> int:
    """Check everybody, one after the other; returns the exit code.

    Parameters
    ----------
    options : PreflightOptions
    bench : Bench, optional
        Other devices than the real ones.

    Raises
    ------
    ValueError
        If options do not belong together, or the report cannot be written.
    """
    if options.linked.arm:
        raise ValueError("preflight arms nothing: leave out --arm; 'matchset fly ... --arm' flies")
    inputs = [options.config, *options.linked.inputs]
    check_outputs([options.report, options.record], inputs, options.force)
    followers = options.linked.followers(None, options.config)
    if not followers:
        raise ValueError("say whom to check: --camera 0 --link crsf:///dev/ttyUSB0; see 'matchset preflight --help'")
    check_followers(followers)
    flight = options.linked.flight(flight_parameters(options.config, None))
    bench = bench or Bench(parameters=PreflightParameters(), person=somebody(options.unattended))
    outcomes = []
    with closing(_checks(followers, flight, options, bench)) as checks:
        for outcome in checks:
            outcomes.append(outcome)
            if options.to_stdout:
                print(msgspec.json.encode(outcome).decode(), flush=True)
            if outcome.is_failed:
                break
    _write(outcomes, options)
    _show(outcomes, options)
    return outcomes[-1].code if outcomes[-1].is_failed else FOUND


def _checks(
    followers: Sequence[LinkedFollower], flight: FlightParameters, options: PreflightOptions, bench: Bench
) -> Generator[CheckOutcome, None, None]:
    """Check every vehicle, then what they share."""
    flight = flight_of(flight, bench.parameters, len(followers))
    for number, follower in enumerate(followers, 1):
        with closing(vehicle_checks(follower, flight, bench)) as checks:
            for outcome in checks:
                name = outcome.name if len(followers) == 1 else f"{number} {outcome.name}"
                yield msgspec.structs.replace(outcome, name=name)
    free = FreeSpace(options.record or RECORDING).left
    yield disk_check(free, len(followers), bench.parameters)


def disk_check(free: float, followers: int, parameters: PreflightParameters) -> CheckOutcome:
    """Check that a recording fits on the disk.

    Parameters
    ----------
    free : float
        Bytes that may be written.
    followers : int
        How many are recorded.
    parameters : PreflightParameters
    """
    needed = RECORDING_RATE * parameters.recorded * followers
    outcome = judged(
        "disk: room",
        f"{size_text(needed)} for a recording of {parameters.recorded:g} s",
        size_text(max(free, 0.0)),
        free >= needed,
        "make room, or record on another disk: --record",
    )
    return msgspec.structs.replace(outcome, code=BAD_INPUT)


def next_command(options: PreflightOptions) -> str:
    """Return what to type after all checks have passed: a short flight that is recorded.

    Parameters
    ----------
    options : PreflightOptions
    """
    linked, words = options.linked, ["fly"]
    named = {
        "--camera": linked.camera,
        "--link": linked.link,
        "--camera-file": linked.camera_file,
        "--fov": linked.fov,
        "--focal-sigma": linked.focal_sigma,
        "--diameter": linked.diameter,
        "--diameter-sigma": linked.diameter_sigma,
        "--marker-diameter": linked.marker_diameter,
        "--delay-ms": linked.delay_ms,
        "--timeout": linked.timeout,
        "--reconnect": linked.reconnect,
        "--fields": linked.fields,
        "--config": options.config,
    }
    for name, value in named.items():
        words += [] if value is None else [name, f"{value:g}" if isinstance(value, float) else str(value)]
    for name, files in (("--color", linked.color), ("--marker-color", linked.marker_color)):
        words += [word for file in files or () for word in (name, str(file))]
    words += linked.mounted.words
    record = options.record or RECORDING
    words += ["--duration", "10", "--record", str(record), "--report", str(record.with_suffix(".html")), "--arm"]
    return shell_command(*words)


def _write(outcomes: Sequence[CheckOutcome], options: PreflightOptions) -> None:
    if options.report is not None:
        path = output_file(options.report, options.force)
        write_whole(path, msgspec.json.format(msgspec.json.encode(outcomes), indent=1) + b"\n")


def _show(outcomes: Sequence[CheckOutcome], options: PreflightOptions) -> None:
    """Print the table and what comes next; to stderr where stdout has the lines of JSON."""
    console = Console(stderr=options.to_stdout, soft_wrap=False)
    table = Table("check", "wanted", "measured", "", box=None, pad_edge=False)
    for each in outcomes:
        table.add_row(
            each.name, Text(each.wanted, "dim"), Text(each.measured), Text(each.verdict, STYLES[each.verdict])
        )
    console.print(table)
    last, skipped = outcomes[-1], [each for each in outcomes if each.verdict == "skipped"]
    out = sys.stderr if options.to_stdout else sys.stdout
    if last.is_failed:
        print(f"error: {last.name}: {last.measured}" + f"; {last.advice}" * bool(last.advice), file=sys.stderr)
        print("stopped here: what comes after it was not checked", file=out)
        return
    for each in skipped:
        print(f"skipped: {each.name}: {each.advice}", file=out)
    print("all checks passed" if not skipped else f"no check failed, {len(skipped)} were skipped", file=out)
    print("next, PROPELLERS OFF, then on a tether (docs/first_flight.md):", file=out)
    print(f"  {next_command(options)}", file=out)
