"""`matchset fly`: one flight of a simulated chain, shown, filmed, recorded and reported.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from matchset.app.cli_options import Force
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.app.flight.output_files import FlightFiles, Quiet

if TYPE_CHECKING:
    from matchset.app.flight.flight import FlightParameters
    from matchset.app.flight.outputs import FlightOutputs
    from matchset.app.flight.pacer import Pacer

FLY_EPILOG = """
[bold]Examples[/bold]

  matchset fly sim://chain

  matchset fly "sim://chain?vehicles=5&seed=7&pal=bad" --video chain.webm --report chain.html

  matchset fly sim://chain --config flight.toml --record chain.mcap

  matchset fly --print-config > flight.toml

Exit codes: 0 everyone flew to the end, 1 not, 2 bad input or options, 3 a device broke, 130 stopped by Ctrl-C \
(everyone lands, files are whole).

The space key, and SIGUSR1, stop all motors at once: the vehicles fall.
"""

Uri = Annotated[str, typer.Argument(metavar="URI", help="Whom to fly: sim://chain?vehicles=3&seed=7")]
Config = Annotated[
    Path | None, typer.Option("--config", metavar="FILE.toml", help="Settings; see 'fly --print-config'.")
]
Vehicles = Annotated[int | None, typer.Option("--vehicles", help="Length of the chain, 2 to 20.")]
Seed = Annotated[int | None, typer.Option(help="Decides everything that is left to chance.")]
Duration = Annotated[float | None, typer.Option("--duration", metavar="S", help="How long each flight is, s.")]
Pal = Annotated[str | None, typer.Option("--pal", help="The analog link: clean, typical or bad.")]
Latency = Annotated[float | None, typer.Option("--latency-ms", metavar="MS", help="From capture to command, ms.")]
RealTime = Annotated[bool, typer.Option("--real-time", help="No faster than a clock.")]
PrintConfig = Annotated[bool, typer.Option("--print-config", help="Print all settings, and do not fly.")]


class FlyOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset fly`; each is explained where its type is defined."""

    uri: Uri = "sim://chain"
    config: Config = None
    vehicles: Vehicles = None
    seed: Seed = None
    duration: Duration = None
    pal: Pal = None
    latency_ms: Latency = None
    files: FlightFiles = FlightFiles()
    real_time: RealTime = False
    print_config: PrintConfig = False
    quiet: Quiet = False
    force: Force = False

    def flight(self) -> "FlightParameters":
        """Read the settings and change what the URI and the options name; an option wins over the URI."""
        from matchset.app.flight.config import flight_parameters, with_uri, with_world

        flight = with_uri(self.uri, flight_parameters(self.config, self.duration))
        named = {name: getattr(self, name) for name in ("vehicles", "seed", "pal", "latency_ms")}
        return with_world(flight, **{name: value for name, value in named.items() if value is not None})


def fly(options: FlyOptions) -> int:
    """Fly a chain of quadcopters that hold their places by looking at each other."""
    if options.print_config:
        from matchset.app.flight.config import default_toml

        print(default_toml(), end="")
        return FOUND
    options.files.check(options.force, [options.config])
    return _fly(options.flight(), options)


def _fly(parameters: "FlightParameters", options: FlyOptions) -> int:
    """Fly, and return the exit code: 0 if everyone flew to the end, 1 if not, or that of the signal that stopped it.

    However it ends, everyone lands and the files are whole.
    """
    from matchset.app.flight.flight import Flight, flight_setup
    from matchset.app.flight.outputs import FlightOutputs
    from matchset.app.flight.pacer import Pacer
    from matchset.app.flight.real_time.priority import raised_priority
    from matchset.app.flight.score import FlightScorer
    from matchset.app.kill_switch import KillSwitch
    from matchset.app.progress import announce_if_slow
    from matchset.links.simulated import FPS

    options.files.make_folders(options.force)
    scorer = FlightScorer(parameters)
    with announce_if_slow("getting ready ..."):
        flight = Flight(parameters)
    pacer = Pacer(1.0 / FPS) if options.real_time else None
    with (
        StopRequest() as stop,
        flight,
        FlightOutputs(flight_setup(flight), options.files, options.quiet, options.real_time) as outputs,
        flight,  # once more: everyone lands before the files are finished, which takes longer
        KillSwitch(flight.cut) as kill,
        raised_priority() if options.real_time else nullcontext(),
    ):
        if kill.reads_keys and not options.quiet:
            print("space stops all motors at once", file=sys.stderr)
        for chain_step in flight:
            scorer.add(chain_step)
            outputs.add(chain_step, [pilot.armed for pilot in flight.pilots])
            if kill.reason and not chain_step.down:
                flight.cut(kill.reason)  # once more, for one that was just being armed
            elif stop or scorer.crashed or kill.reason:
                break
            if pacer is not None:
                pacer.wait()
    _print_end(outputs, options.files, pacer)
    if stop:
        print("note: stopped; everyone landed, and the files hold what was flown so far", file=sys.stderr)
        return stop.code
    return FOUND if scorer.score().survived else NOT_FOUND


def _print_end(outputs: "FlightOutputs", files: FlightFiles, pacer: "Pacer | None") -> None:
    """Print how the flight ended, what was written and what is missing in it."""
    from matchset.app.flight.log import flight_summary

    print(f"flight: {flight_summary(outputs.log)}")
    for path in files.paths:
        print(f"  {path}")
    if pacer is not None:
        print(f"longest pause of the loop: {1e3 * pacer.longest:.0f} ms; {pacer.missed} pictures were late")
    for note in outputs.notes:
        print(f"note: {note}: it was too slow", file=sys.stderr)
