"""The options of `matchset fly`: `FlyOptions`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from matchset.app.cli_options import Force
from matchset.app.sharing_options import SharingOptions
from matchset.flight.fly.output_files import FlightFiles, Quiet
from matchset.flight.linked.options import LinkedOptions

if TYPE_CHECKING:
    from matchset.flight.chain.flight_parameters import FlightParameters

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
    sharing: SharingOptions = SharingOptions()
    real_time: RealTime = False
    print_config: PrintConfig = False
    quiet: Quiet = False
    force: Force = False

    def flight(self) -> "FlightParameters":
        """Read the settings and change what the URI and the options name; an option wins over the URI."""
        from matchset.flight.chain.config import flight_parameters, with_uri, with_world

        flight = with_uri(self.uri or CHAIN, flight_parameters(self.config, self.duration))
        return with_world(flight, vehicles=self.vehicles, seed=self.seed, pal=self.pal, latency_ms=self.latency_ms)
