"""The options of `matchset identify`: `IdentifyOptions`. This module is loaded for every `matchset --help`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from matchset.app.cli_options import Force
from matchset.flight.fly.options import Config, FlyOptions, Seed
from matchset.flight.fly.output_files import FlightFiles, Quiet
from matchset.flight.linked.options import LinkedOptions

if TYPE_CHECKING:
    from matchset.flight.chain.flight_parameters import FlightParameters
    from matchset.flight.identify.parameters import IdentifyParameters

Whom = Annotated[
    str | None,
    typer.Argument(metavar="LINK", help="Whom to identify: serial:///dev/ttyUSB0, or sim://chain?seed=7."),
]


Output = Annotated[Path, typer.Option("-o", metavar="FILE.toml", help="Settings to write, for 'fly --config'.")]


Duration = Annotated[float | None, typer.Option("--duration", metavar="S", help="How long it flies, s; 10 without it.")]


Recorded = Annotated[
    Path | None, typer.Option("--from", metavar="FLIGHT.mcap", help="Fly nothing: identify by a recorded flight.")
]


Quick = Annotated[bool, typer.Option("--quick", help="Of a simulated one: without pictures, outlines with noise.")]


class IdentifyOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset identify`; each is explained where its type is defined."""

    whom: Whom = None
    out: Output = Path("vehicle.toml")
    config: Config = None
    seed: Seed = None
    duration: Duration = None
    linked: LinkedOptions = LinkedOptions()
    files: FlightFiles = FlightFiles()
    recorded: Recorded = None
    quick: Quick = False
    quiet: Quiet = False
    force: Force = False

    @property
    def is_simulated(self) -> bool:
        """Whether a simulated vehicle is meant."""
        return self.whom is None or self.whom.startswith("sim:")

    def fly_options(self) -> FlyOptions:
        """Return the options of the flight.

        Raises
        ------
        ValueError
            If the link is named twice.
        """
        linked, uri = self.linked, self.whom
        if not self.is_simulated:
            if linked.link is not None:
                raise ValueError(f"the link is named twice: {self.whom} and --link {linked.link}")
            linked, uri = msgspec.structs.replace(linked, link=self.whom), None
        return FlyOptions(
            uri=uri,
            config=self.config,
            seed=self.seed,
            linked=linked,
            files=self.files,
            quiet=self.quiet,
            force=self.force,
        )

    def flight(self, parameters: "IdentifyParameters") -> "FlightParameters":
        """Read the settings: one follower before a ball that hangs still, unless they say otherwise, flown carefully.

        Raises
        ------
        ValueError
            If a setting is refused, or names several followers.
        """
        from matchset.flight.chain.config import flight_parameters, with_uri, with_world
        from matchset.flight.identify.parameters import careful

        flight = flight_parameters(self.config, parameters.duration if self.duration is None else self.duration)
        if self.config is None:
            flight = with_world(flight, swing=0.0, yaw_deg=0.0)
        if self.whom is not None and self.is_simulated:
            flight = with_uri(self.whom, with_world(flight, vehicles=2))
            if flight.world.vehicles != 2:
                raise ValueError(f"one vehicle is identified at a time: vehicles is 2, got {flight.world.vehicles}")
        return careful(with_world(flight, seed=self.seed, quick=self.quick), parameters)
