"""`matchset fly`: one flight of a chain, shown, filmed, recorded and reported."""

import sys

import msgspec

from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.app.flight.flight import Flight, FlightParameters, flight_setup
from matchset.app.flight.log import verdict
from matchset.app.flight.outputs import FlightFiles, FlightOutputs
from matchset.app.flight.pacer import Pacer
from matchset.app.flight.score import FlightScorer
from matchset.app.patience import if_slow
from matchset.links.simulated import FPS


class FlyOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset fly`.

    Parameters
    ----------
    flight : FlightParameters
    files : FlightFiles
    quiet : bool
    real_time : bool
        Not faster than a clock.
    """

    flight: FlightParameters
    files: FlightFiles = FlightFiles()
    quiet: bool = False
    real_time: bool = False


def fly(options: FlyOptions) -> int:
    """Run the command.

    Returns
    -------
    int
        0 if everyone flew to the end, 1 if not, or the code of the signal that stopped it; then everyone lands and the
        files are whole.
    """
    options.files.check()
    scorer = FlightScorer(options.flight)
    with if_slow("getting ready ..."):
        flight = Flight(options.flight)
    pacer = Pacer(1.0 / FPS) if options.real_time else None
    with (
        StopRequest() as stop,
        flight,
        FlightOutputs(flight_setup(flight), options.files, options.quiet) as outputs,
        flight,  # once more: everyone lands before the files are finished, which takes longer
    ):
        for chain_step in flight:
            scorer.add(chain_step)
            outputs.show(chain_step, [pilot.armed for pilot in flight.pilots])
            if stop or scorer.crashed:
                break
            if pacer is not None:
                pacer.wait()
    print(f"flight: {verdict(outputs.log)}")
    for path in options.files.paths:
        print(f"  {path}")
    if stop:
        print("note: stopped; everyone landed, and the files hold what was flown so far", file=sys.stderr)
        return stop.code
    return FOUND if scorer.score().survived else NOT_FOUND
