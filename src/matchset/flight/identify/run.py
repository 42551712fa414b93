"""Flies, identifies, shows and writes: `run`."""

import datetime
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.app.progress import announce_if_slow
from matchset.app.run_folder import check_outputs, output_file
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.flight import ChainFlight, Flight
from matchset.flight.fly.run import run_flight
from matchset.flight.identify.estimate import estimate
from matchset.flight.identify.flight_log import LoggedStep, StickLog
from matchset.flight.identify.options import IdentifyOptions
from matchset.flight.identify.parameters import IdentifyParameters
from matchset.flight.identify.vehicle_file import vehicle_toml
from matchset.flight.identify.verdict import NEEDED, VehicleFinding, findings
from matchset.flight.linked.opening import open_flight
from matchset.flight.linked.vehicle_kind import told_to
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.replay import Replay
from matchset.flight.simulate.flights import fly_scored
from matchset.image.files.whole_file import write_whole


def run(options: IdentifyOptions, parameters: IdentifyParameters | None = None) -> int:
    """Fly and identify; returns the exit code.

    Parameters
    ----------
    options : IdentifyOptions
    parameters : IdentifyParameters, optional

    Raises
    ------
    ValueError
        If options do not belong together, or a file cannot be written.
    LinkError
        If a device was to blame for the end.
    """
    parameters = parameters or IdentifyParameters()
    fly_options = options.fly_options()
    inputs = [options.config, options.recorded, *fly_options.linked.inputs]
    check_outputs([options.out], inputs, options.force)
    options.files.check(options.force, [options.out, *inputs])
    if options.recorded is not None:
        if options.whom is not None or fly_options.linked.given or options.quick:
            raise ValueError("--from flies nothing: it goes with no link, no camera and no --quick")
        return _identified(_recorded(options.recorded), f"--from {options.recorded}", options, parameters)
    with announce_if_slow("getting ready ..."):
        flight = _opened(options, parameters)
    options.files.make_folders(options.force)
    logged: list[LoggedStep] = []

    def note(chain_step: ChainStep) -> None:
        logged.append(LoggedStep.of(chain_step.steps[0]))

    code = _flown_quickly(flight, note) if options.quick else run_flight(flight, fly_options, watch=note)
    if flight.setup.kind == "dry run":
        print("dry run: without throttle nothing can be identified; --arm flies")
        return code
    if code not in (FOUND, NOT_FOUND):
        return code
    if code == NOT_FOUND:
        print("note: it came down before its time", file=sys.stderr)
    source = options.whom or fly_options.linked.link or "simulated"
    return max(_identified(logged, source, options, parameters), code)


def _identified(
    steps: Sequence[LoggedStep], source: str, options: IdentifyOptions, parameters: IdentifyParameters
) -> int:
    """Identify, show and write; returns the exit code."""
    log = StickLog.of(steps, parameters.airborne)
    if len(log.taken) < parameters.estimate.least_pictures:
        print(f"note: nothing found: {len(log.taken)} pictures of a flight are too few", file=sys.stderr)
        return NOT_FOUND
    found = findings(estimate(log, parameters=parameters.estimate), log, parameters)
    path = output_file(options.out, options.force)
    words = f"{source}, {log.duration:.1f} s of flight"
    write_whole(path, vehicle_toml(found, words, datetime.date.today(), parameters).encode())
    _show(found, log)
    print(f"  {path}")
    return NOT_FOUND if any(each.missing for each in found if each.name in NEEDED) else FOUND


def _recorded(path: Path) -> list[LoggedStep]:
    """Replay the first follower of a recorded flight."""
    return [LoggedStep.of(chain_step.steps[0]) for chain_step in Replay(RecordingReader(path))]


def _opened(options: IdentifyOptions, parameters: IdentifyParameters) -> ChainFlight:
    """Make the flight, simulated or real."""
    fly_options = options.fly_options()
    followers = fly_options.linked.followers(fly_options.uri, options.config)
    if not followers and options.whom is None:
        raise ValueError(
            'say whom to identify: sim://chain, or serial:///dev/ttyUSB0 --camera 0; see "identify --help"'
        )
    flight = options.flight(parameters)
    if flight.world.commands == "speeds" or any(told_to(each.link) == "speeds" for each in followers):
        raise ValueError("what is identified is what a vehicle makes of angles and thrust; this one is told speeds")
    if not followers:
        return Flight(flight)
    if len(followers) > 1:
        raise ValueError(f"one vehicle is identified at a time: {options.config} names {len(followers)} followers")
    if options.quick:
        raise ValueError("--quick is for a simulated vehicle")
    return open_flight(fly_options.linked.flight(flight), followers, dry=not fly_options.linked.arm)


def _flown_quickly(flight: ChainFlight, watch: Callable[[ChainStep], None]) -> int:
    """Fly a simulated vehicle without pictures, tables and files; returns the exit code."""
    with StopRequest() as stop:
        scorer = fly_scored(flight, lambda: bool(stop), watch)
    return stop.code if stop else FOUND if flight.succeeded(scorer) else NOT_FOUND


def _show(found: Sequence[VehicleFinding], log: StickLog) -> None:
    """Print a line for each number."""
    for each in found:
        value = each.words if not each.missing else f"not found: {each.missing}"
        print(f"  {each.name:14} {value:28} {each.meaning}")
    whole = 1e3 * (next(each.value for each in found if each.name == "delay") + log.age)
    if np.isfinite(whole):
        print(
            f"  from a picture to the first effect of its command: {whole:.0f} ms, {1e3 * log.age:.0f} of them its age"
        )
