"""`matchset fly`: one flight of a simulated chain or of real vehicles, shown, filmed, recorded and reported.

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
from matchset.app.flight.linked.options import LinkedOptions
from matchset.app.flight.output_files import FlightFiles, Quiet
from matchset.image.errors import LinkError

if TYPE_CHECKING:
    from matchset.app.flight.flight import ChainFlight, FlightParameters
    from matchset.app.flight.outputs import FlightOutputs
    from matchset.app.flight.pacer import Pacer

FLY_EPILOG = """
[bold]Examples[/bold]

  matchset fly sim://chain

  matchset fly "sim://chain?vehicles=5&seed=7&pal=bad" --video chain.webm --report chain.html

  matchset fly sim://chain --config flight.toml --record chain.mcap

  matchset fly --print-config > flight.toml

  matchset fly --camera 0 --link serial:///dev/ttyUSB0 --camera-file camera.toml --color ball.npz \
--marker-color marker.npz

The last one is a real vehicle, and a dry run: no throttle is sent without --arm. docs/flight.md has the way there.

Exit codes: 0 everyone flew to the end, 1 not, 2 bad input or options, 3 a device broke, 130 stopped by Ctrl-C \
(everyone lands, files are whole).

The space key, and SIGUSR1, stop all motors at once: the vehicles fall.
"""

Uri = Annotated[
    str | None, typer.Argument(metavar="URI", help="Whom to fly: sim://chain?vehicles=3&seed=7; real ones: --link.")
]
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


CHAIN = "sim://chain"


class FlyOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset fly`; each is explained where its type is defined."""

    uri: Uri = None
    config: Config = None
    vehicles: Vehicles = None
    seed: Seed = None
    duration: Duration = None
    pal: Pal = None
    latency_ms: Latency = None
    linked: LinkedOptions = LinkedOptions()
    files: FlightFiles = FlightFiles()
    real_time: RealTime = False
    print_config: PrintConfig = False
    quiet: Quiet = False
    force: Force = False

    def flight(self) -> "FlightParameters":
        """Read the settings and change what the URI and the options name; an option wins over the URI."""
        from matchset.app.flight.config import flight_parameters, with_uri, with_world

        flight = with_uri(self.uri or CHAIN, flight_parameters(self.config, self.duration))
        named = {name: getattr(self, name) for name in ("vehicles", "seed", "pal", "latency_ms")}
        return with_world(flight, **{name: value for name, value in named.items() if value is not None})


def fly(options: FlyOptions) -> int:
    """Fly a chain of quadcopters that hold their places by looking at each other."""
    if options.print_config:
        from matchset.app.flight.config import default_toml

        print(default_toml(), end="")
        return FOUND
    options.files.check(options.force, [options.config, *options.linked.inputs])
    followers = options.linked.followers(options.uri, options.config)
    if followers:
        from matchset.app.flight.linked.run import fly_linked

        return fly_linked(followers, options)
    return fly_simulated(options)


def fly_simulated(options: FlyOptions) -> int:
    """Fly the simulated chain; returns the exit code."""
    from matchset.app.flight.flight import Flight
    from matchset.app.flight.pacer import Pacer
    from matchset.app.progress import announce_if_slow
    from matchset.links.simulated import FPS

    parameters = options.flight()
    options.files.make_folders(options.force)
    with announce_if_slow("getting ready ..."):
        flight = Flight(parameters)
    return run_flight(flight, options, Pacer(1.0 / FPS) if options.real_time else None)


def run_flight(flight: "ChainFlight", options: FlyOptions, pacer: "Pacer | None" = None) -> int:
    """Fly, and return the exit code: 0 if everyone flew to the end, 1 if not, or that of the signal that stopped it.

    However it ends, everyone lands and the files are whole.

    Parameters
    ----------
    flight : ChainFlight
        Closed at the end.
    options : FlyOptions
    pacer : Pacer, optional
        For one that waits for no clock by itself.

    Raises
    ------
    LinkError
        If a device was to blame for its end.
    """
    from matchset.app.flight.outputs import FlightOutputs
    from matchset.app.flight.real_time.priority import raised_priority
    from matchset.app.flight.score import FlightScorer
    from matchset.app.kill_switch import KillSwitch

    _code_pictures(flight, options.files)
    scorer, real_time = FlightScorer(flight.parameters), pacer is not None or not flight.setup.has_truth
    with (
        StopRequest() as stop,
        flight,
        FlightOutputs(flight.setup, options.files, options.quiet, real_time) as outputs,
        flight,  # once more: everyone lands before the files are finished, which takes longer
        KillSwitch(flight.cut) as kill,
        raised_priority() if real_time else nullcontext(),
    ):
        for line in () if options.quiet else flight.briefing(kill.reads_keys):
            print(line, file=sys.stderr)
        for chain_step in flight:
            scorer.add(chain_step)
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
    from matchset.app.recording.coded_camera import CodedCamera

    for pilot in flight.pilots:
        pilot.camera = CodedCamera(pilot.camera, files.jpeg)


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
