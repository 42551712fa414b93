"""The command line of `matchset fly` and `matchset simulate`."""

from pathlib import Path
from typing import Annotated

import typer

from matchset.app.cli_options import Folder, Force
from matchset.app.exit_codes import errors_in_one_line
from matchset.app.recording.command import FlightRecord, FlightReport, FlightVideo, Quiet

FLIGHT_CODES = (
    "Exit codes: 0 everyone flew to the end, 1 not, 2 bad input or options, 3 a device broke, "
    "130 stopped by Ctrl-C (everyone lands, files are whole)."
)
FLY_EPILOG = f"""
[bold]Examples[/bold]

  matchset fly sim://chain

  matchset fly "sim://chain?vehicles=5&seed=7&pal=bad" --video chain.webm --report chain.html

  matchset fly sim://chain --config flight.toml --record chain.mcap

  matchset fly --print-config > flight.toml

{FLIGHT_CODES}
"""
SIMULATE_EPILOG = """
[bold]Examples[/bold]

  matchset simulate

  matchset simulate --sweep hidden=0.5,1.0 --seeds 20 --pal bad

  matchset simulate --sweep vehicles=3,5,10 --seeds 2 --duration 20

The last line is the verdict. Latency is from the middle of a picture's exposure to the command leaving the laptop; the
radio's delay comes on top.

Exit codes: 0 the limits hold in every row, 1 they do not, 2 bad input or options, 130 stopped by Ctrl-C.
"""

Config = Annotated[
    Path | None, typer.Option("--config", metavar="FILE.toml", help="Settings; see 'fly --print-config'.")
]
Vehicles = Annotated[int | None, typer.Option("--vehicles", help="Length of the chain, 2 to 20.")]
Duration = Annotated[float | None, typer.Option("--duration", metavar="S", help="How long each flight is, s.")]
Pal = Annotated[str | None, typer.Option("--pal", help="The analog link: clean, typical or bad.")]
Latency = Annotated[float | None, typer.Option("--latency-ms", metavar="MS", help="From capture to command, ms.")]


def fly(
    uri: Annotated[
        str, typer.Argument(metavar="URI", help="Whom to fly: sim://chain?vehicles=3&seed=7")
    ] = "sim://chain",
    config: Config = None,
    vehicles: Vehicles = None,
    seed: Annotated[int | None, typer.Option(help="Decides everything that is left to chance.")] = None,
    duration: Duration = None,
    pal: Pal = None,
    latency_ms: Latency = None,
    video: FlightVideo = None,
    report: FlightReport = None,
    record: FlightRecord = None,
    real_time: Annotated[bool, typer.Option("--real-time", help="No faster than a clock.")] = False,
    print_config: Annotated[bool, typer.Option("--print-config", help="Print all settings, and do not fly.")] = False,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Fly a chain of quadcopters that hold their places by looking at each other."""
    with errors_in_one_line():
        from matchset.app.flight import config as flight_settings
        from matchset.app.flight import fly_command
        from matchset.app.flight.outputs import FlightFiles

        if print_config:
            print(flight_settings.default_toml(), end="")
            raise typer.Exit
        flight = flight_settings.with_uri(uri, flight_settings.flight_parameters(config, duration))
        said = {"vehicles": vehicles, "seed": seed, "pal": pal, "latency_ms": latency_ms}
        flight = flight_settings.with_world(
            flight, **{name: value for name, value in said.items() if value is not None}
        )
        files = FlightFiles(video=video, report=report, record=record, force=force)
        code = fly_command.fly(fly_command.FlyOptions(flight=flight, files=files, quiet=quiet, real_time=real_time))
    raise typer.Exit(code)


def simulate(
    world: Annotated[str, typer.Option("--world", help="What is simulated: chain.")] = "chain",
    config: Config = None,
    vehicles: Vehicles = None,
    duration: Duration = None,
    pal: Pal = None,
    latency_ms: Latency = None,
    sweep: Annotated[
        str, typer.Option(metavar="NAME=VALUES", help="What to change, and to which values.")
    ] = "latency_ms=0,33,67,100,133",
    seeds: Annotated[int, typer.Option(min=1, max=10_000, help="Flights at each value.")] = 20,
    first_seed: Annotated[int, typer.Option(min=0, help="The first of their seeds.")] = 100,
    survival: Annotated[float, typer.Option(help="Limit: least share of flights that survive.")] = 1.0,
    in_view: Annotated[float, typer.Option(help="Limit: least share of pictures with the ball in view.")] = 0.99,
    spread: Annotated[float, typer.Option(metavar="M", help="Limit: largest rms off the set place, m.")] = 0.10,
    jobs: Annotated[int, typer.Option(min=0, max=256, help="Flights at once; 0: one for every core.")] = 0,
    out: Folder = None,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Fly many simulated flights under changed conditions and judge them by limits."""
    with errors_in_one_line():
        from matchset.app.flight import config as flight_settings
        from matchset.app.flight import simulate as simulate_command
        from matchset.app.flight.simulation_table import Limits

        if world != "chain":
            raise ValueError(f"--world must be chain, got {world!r}")
        said = {"vehicles": vehicles, "pal": pal, "latency_ms": latency_ms}
        flight = flight_settings.with_world(
            flight_settings.flight_parameters(config, duration),
            **{name: each for name, each in said.items() if each is not None},
        )
        limits = Limits(survival=survival, in_view=in_view, spread=spread)
        options = simulate_command.SimulateOptions(
            flight=flight,
            sweep=sweep,
            seeds=seeds,
            first_seed=first_seed,
            limits=limits,
            jobs=jobs,
            out=out,
            force=force,
            quiet=quiet,
        )
        code = simulate_command.simulate(options)
    raise typer.Exit(code)
