"""The options of `fly`, `identify` and `preflight` for a real vehicle: `LinkedOptions`.

Imported by the command line, so imports that take long stand inside the functions.
"""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from matchset.app.cli_options import FieldsName, TurnOptions

if TYPE_CHECKING:
    from matchset.flight.chain.flight_parameters import FlightParameters
    from matchset.flight.linked.parameters import LinkedFollower

Camera = Annotated[
    str | None,
    typer.Option("--camera", metavar="SOURCE", help="Of a real vehicle: a camera's number, or the URL of a stream."),
]
LinkUri = Annotated[
    str | None, typer.Option("--link", metavar="URI", help="Of a real vehicle: serial:///dev/ttyUSB0 for an Arduino.")
]
CameraFile = Annotated[
    Path | None, typer.Option("--camera-file", metavar="FILE.toml", help="The camera, by 'matchset calibrate'.")
]
Fov = Annotated[
    float | None, typer.Option("--fov", metavar="DEG", help="In its place: the horizontal field of view, degrees.")
]
FocalSigma = Annotated[
    float | None,
    typer.Option("--focal-sigma", metavar="SHARE", help="Standard deviation of the focal length, as a share of it."),
]
Color = Annotated[
    list[Path] | None,
    typer.Option("--color", metavar="FILE", help="The ball's color, by 'matchset learn'; several are joined."),
]
MarkerColor = Annotated[
    list[Path] | None, typer.Option("--marker-color", metavar="FILE", help="The color of the ball's marker.")
]
Diameter = Annotated[float | None, typer.Option("--diameter", metavar="M", help="Of the ball, m: 0.28 without it.")]
DiameterSigma = Annotated[
    float | None, typer.Option("--diameter-sigma", metavar="M", help="Standard deviation of the ball's diameter, m.")
]
MarkerDiameter = Annotated[
    float | None, typer.Option("--marker-diameter", metavar="M", help="Of its marker, m: 0.06 without it.")
]
Delay = Annotated[
    float | None,
    typer.Option("--delay-ms", metavar="MS", help="How old a picture is when it arrives, where nothing stamps it."),
]
Timeout = Annotated[
    float | None,
    typer.Option("--timeout", metavar="S", help="Of a real camera: after which silence it is opened again; 2 s."),
]
Reconnect = Annotated[
    float | None,
    typer.Option(
        "--reconnect",
        metavar="S",
        help="How long that is tried, s; without pictures it lands meanwhile. 10 of a stream, 0 of a camera.",
    ),
]
DryRun = Annotated[
    bool, typer.Option("--dry-run", help="Send no throttle, say what would be sent. So it is without --arm.")
]
Arm = Annotated[bool, typer.Option("--arm", help="Let the motors of a real vehicle turn, after a countdown.")]

# format: options that a file of several followers has for each
OF_ONE = ("camera_file", "fov", "focal_sigma", "color", "marker_color", "delay_ms", "timeout", "reconnect", "fields")
NEEDED = "--camera-file camera.toml --color ball.npz --marker-color marker.npz"


class LinkedOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that name real devices; each is explained where its type is defined."""

    camera: Camera = None
    link: LinkUri = None
    camera_file: CameraFile = None
    fov: Fov = None
    focal_sigma: FocalSigma = None
    color: Color = None
    marker_color: MarkerColor = None
    diameter: Diameter = None
    diameter_sigma: DiameterSigma = None
    marker_diameter: MarkerDiameter = None
    delay_ms: Delay = None
    mounted: TurnOptions = TurnOptions()
    fields: FieldsName | None = None
    timeout: Timeout = None
    reconnect: Reconnect = None
    dry_run: DryRun = False
    arm: Arm = False

    @property
    def given(self) -> bool:
        """Whether any of them was typed."""
        return any(getattr(self, name) not in (None, False, TurnOptions()) for name in self.__struct_fields__)

    @property
    def inputs(self) -> list[Path | None]:
        """The files that they name."""
        return [self.camera_file, *(self.color or ()), *(self.marker_color or ())]

    def followers(self, uri: str | None, config: Path | None) -> "tuple[LinkedFollower, ...]":
        """Return the real followers that options and settings name; none: the chain is simulated.

        Raises
        ------
        ValueError
            If options do not belong together; says what to type.
        """
        from matchset.flight.chain.config import read_followers
        from matchset.flight.linked.parameters import LinkedFollower
        from matchset.media.upright.view import checked_fields

        if self.arm and self.dry_run:
            raise ValueError("give --arm or --dry-run, not both")
        if uri is not None:
            _check_uri(uri, self.given)
            return ()
        known = () if config is None else read_followers(config)
        if self.camera is None and self.link is None:
            typed = [name for name in OF_ONE if getattr(self, name) not in (None, [])]
            typed += ["turn"] if self.mounted.words else []
            if typed and known:
                raise ValueError(f"--{typed[0].replace('_', '-')}: of several followers, write it into {config}")
            if self.given and not known:
                raise ValueError(f"say whom to fly: --camera 0 --link serial:///dev/ttyUSB0 {NEEDED}")
            return known
        if known:
            raise ValueError(f"{config} names the followers already: give --camera and --link, or the file's followers")
        if self.camera is None or self.link is None:
            missing = "--camera 0" if self.camera is None else "--link serial:///dev/ttyUSB0"
            raise ValueError(f"a real flight needs a camera and a link: {missing} is missing")
        return (
            LinkedFollower(
                camera=self.camera,
                link=self.link,
                camera_file=str(self.camera_file or ""),
                fov_deg=self.fov,
                focal_sigma=self.focal_sigma,
                color=tuple(map(str, self.color or ())),
                marker_color=tuple(map(str, self.marker_color or ())),
                delay_ms=self.delay_ms or 0.0,
                turn=self.mounted.turn,
                mirror=self.mounted.mirror,
                fields=checked_fields(self.fields or "frames"),
                timeout=self.timeout,
                reconnect=self.reconnect,
            ),
        )

    def flight(self, flight: "FlightParameters") -> "FlightParameters":
        """Change the ball of a flight to what was typed."""
        from matchset.localization.ball_target import NeighborBall

        target = flight.pilot.target
        new = NeighborBall(
            target.diameter if self.diameter is None else self.diameter,
            target.markers,
            target.marker_diameter if self.marker_diameter is None else self.marker_diameter,
            target.diameter_sigma if self.diameter_sigma is None else self.diameter_sigma,
        )
        return msgspec.structs.replace(flight, pilot=msgspec.structs.replace(flight.pilot, target=new))


def _check_uri(uri: str, linked: bool) -> None:
    """Refuse the URI of a real link, with what to type, and one beside options of real devices (ValueError)."""
    if not uri.startswith("sim:"):
        raise ValueError(
            f"a link alone cannot fly, it needs a camera: matchset fly --camera 0 --link {shlex.quote(uri)} {NEEDED} "
            "(no motor turns without --arm; docs/flight.md)"
        )
    if linked:
        raise ValueError(f"{uri} is a simulated chain: the options of a real vehicle (--camera, --arm ...) do not fit")
