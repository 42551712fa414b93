"""The run of a flight, simulated or real, with its files: `run_flight`."""

import sys
from collections.abc import Callable
from contextlib import nullcontext
from typing import TYPE_CHECKING

from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.flight.fly.options import FlyOptions
from matchset.flight.fly.output_files import FlightFiles
from matchset.image.errors import LinkError

if TYPE_CHECKING:
    from matchset.flight.chain.chain_step import ChainStep
    from matchset.flight.chain.flight import ChainFlight
    from matchset.flight.chain.pacer import Pacer
    from matchset.flight.fly.outputs import FlightOutputs


def run_flight(
    flight: "ChainFlight",
    options: FlyOptions,
    pacer: "Pacer | None" = None,
    watch: "Callable[[ChainStep], None]" = lambda _: None,
) -> int:
    """Fly, and return the exit code: 0 if everyone flew to the end, 1 if not, or that of the signal that stopped it.

    However it ends, everyone lands and the files are whole.

    Parameters
    ----------
    flight : ChainFlight
        Closed at the end.
    options : FlyOptions
    pacer : Pacer, optional
        For one that waits for no clock by itself.
    watch : callable, optional
        Told every step.

    Raises
    ------
    LinkError
        If a device was to blame for its end.
    """
    from matchset.flight.chain.score import FlightScorer
    from matchset.flight.fly.outputs import FlightOutputs
    from matchset.flight.fly.shared_flight import SharedFlight
    from matchset.flight.kill_switch import KillSwitch
    from matchset.flight.real_time.priority import raised_priority

    _code_pictures(flight, options.files)
    scorer, real_time = FlightScorer(flight.parameters), pacer is not None or not flight.setup.has_truth
    with (
        StopRequest() as stop,
        flight,
        FlightOutputs(flight.setup, options.files, options.quiet, real_time) as outputs,
        SharedFlight(options.sharing.opened(), outputs.say) as shared,
        flight,  # once more: everyone lands before the files are finished, which takes longer
        KillSwitch(flight.cut) as kill,
        raised_priority() if real_time else nullcontext(),
    ):
        for line in () if options.quiet else flight.briefing(kill.reads_keys):
            print(line, file=sys.stderr)
        for chain_step in flight:
            watch(chain_step)
            scorer.add(chain_step)
            shared.add(chain_step)
            outputs.add(chain_step, [pilot.armed for pilot in flight.pilots])
            if kill.reason and not chain_step.down:
                flight.cut(kill.reason)  # once more, for one that was just being armed
            elif scorer.crashed or kill.reason or (stop and not flight.land("stopped")):
                break
            if pacer is not None:
                pacer.wait()
    _print_end(outputs, options.files, pacer)
    for line in flight.debriefing():
        print(line)
    if flight.fault:
        raise LinkError(flight.fault)
    if stop:
        print("note: stopped; everyone landed, and the files hold what was flown so far", file=sys.stderr)
        return stop.code
    return FOUND if flight.succeeded(scorer) else NOT_FOUND


def _code_pictures(flight: "ChainFlight", files: FlightFiles) -> None:
    """Let everyone fly by the pictures that are recorded, where those are not recorded without loss."""
    if files.jpeg is None or flight.parameters.world.quick:
        return
    from matchset.flight.recording.coded_camera import CodedCamera

    for pilot in flight.pilots:
        pilot.camera = CodedCamera(pilot.camera, files.jpeg)


def _print_end(outputs: "FlightOutputs", files: FlightFiles, pacer: "Pacer | None") -> None:
    """Print how the flight ended, what was written and what is missing in it."""
    from matchset.flight.fly.log import flight_summary

    print(f"flight: {flight_summary(outputs.log)}")
    for path in files.paths:
        print(f"  {path}")
    if pacer is not None:
        print(f"longest pause of the loop: {1e3 * pacer.longest:.0f} ms; {pacer.missed} pictures were late")
    for note in outputs.notes:
        print(f"note: {note}: it was too slow", file=sys.stderr)
