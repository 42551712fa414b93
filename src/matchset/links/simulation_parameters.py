"""What a simulation is told, by fields or by a URI ``sim://chain?vehicles=3``: `SimulationParameters`, `parse_uri`."""

import math
from typing import Literal
from urllib.parse import parse_qsl

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.control.follower import RelativeSetpoint
from matchset.links.picture_faults import PictureFaults, PictureTimes
from matchset.numeric.arguments import require_within
from matchset.sim.analog_link import PRESETS
from matchset.sim.cameras import FIELD
from matchset.sim.conditions.conditions import Conditions
from matchset.sim.conditions.exposures import half_exposure
from matchset.sim.conditions.outline_noise import OutlineNoise
from matchset.sim.on_board.speed_control import SpeedControlParameters
from matchset.sim.rope import RopeParameters
from matchset.sim.vehicle import VehicleParameters, toy
from matchset.sim.world import RATE, ChainParameters

SCHEME = "sim://"
FPS = 30  # format: pictures a second, PAL without interlace
STEPS_PER_FRAME = RATE // FPS


class SimulationParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of the simulation. Their names are the keys of a URI and of a settings file.

    The defaults are those of the project's experiment; `flight/chain/flight.toml` has the source of each.

    Parameters
    ----------
    vehicles : int
        Length of the chain; the last vehicle hangs on a rope.
    seed : int
        Of all random numbers.
    pal : str
        Quality of the analog video link: "clean", "typical" or "bad".
    latency_ms : float
        From the middle of a picture's exposure to the moment its command leaves the laptop, ms, rounded to 1/480 s; the
        delay of the radio is added. At least 8.3 ms, when the second field is exposed.
    swing : float
        Amplitude of the last vehicle's swing, m.
    yaw_deg : float
        Amplitude of its yaw, degree.
    bias_deg : float
        Error of the level of each vehicle, degree.
    start_off : float
        Offset of each vehicle's start in every axis, m.
    hidden : float
        How long the ball is hidden at a time, s; 0 for never.
    hidden_every : float
        Time from one hiding to the next, s.
    cable : float
        When the cables of the cameras are pulled, s; inf for never.
    freeze, freeze_for : float
        When the grabbers begin to repeat their last picture with new times, and for how long, s; inf for never, and for
        ever.
    stale, stale_for : float
        When they begin to deliver pictures that are `stale_age` old with new times, and for how long, s.
    stale_age : float
        How old these are, s.
    silent, silent_for : float
        When the transmitters begin to hear nothing, and for how long, s; inf for never. A vehicle in flight that hears
        nothing for `VehicleParameters.failsafe` is refused until its link is armed again.
    distortion : float
        Radial distortion k1 of the lenses (OpenCV), no unit.
    width, height : int
        Of the pictures, px.
    fov_deg : float
        Horizontal field of view of the lenses, without their distortion, degree.
    model : CameraModel, optional
        The cameras, in place of `distortion` and `fov_deg`; its size must be that of the pictures.
    vehicle : VehicleParameters, optional
        The vehicles; their level bias is replaced by `bias_deg`.
    conditions : Conditions
        How the simulated side differs from all that. In a URI its names stand beside the others: ``?thrust=0.8``.
    commands : str
        What the vehicles are told: "angles", and thrust; or "speeds", which they hold by themselves.
    speed_control : SpeedControlParameters
        Of vehicles that are told speeds; its `used` does not count.
    quick : bool
        Without pictures: outlines of balls and markers from the truth, with the noise of a tracker. Many times as fast;
        nothing can be taken for a ball that is none.
    noise : OutlineNoise
        Of these.
    fields : str
        "frames"; or "top": the grabbers deliver each field of an interlaced link as soon as it is there, as a
        half-frame of its own time, 60 a second. `latency_ms` still counts from the middle of a whole frame's exposure.
    """

    vehicles: int = 3
    seed: int = 0
    pal: Literal["clean", "typical", "bad"] = "typical"
    latency_ms: float = 67.0
    swing: float = 0.1
    yaw_deg: float = 20.0
    bias_deg: float = 2.0
    start_off: float = 0.0
    hidden: float = 0.0
    hidden_every: float = 6.0
    cable: float = math.inf
    freeze: float = math.inf
    freeze_for: float = math.inf
    stale: float = math.inf
    stale_for: float = math.inf
    stale_age: float = 0.5
    silent: float = math.inf
    silent_for: float = 0.3
    distortion: float = -0.08
    width: int = 640
    height: int = 480
    fov_deg: float = 90.0
    model: CameraModel | None = None
    vehicle: VehicleParameters = msgspec.field(default_factory=toy)
    conditions: Conditions = Conditions()
    commands: Literal["angles", "speeds"] = "angles"
    speed_control: SpeedControlParameters = SpeedControlParameters()
    quick: bool = False
    noise: OutlineNoise = OutlineNoise()
    fields: Literal["frames", "top"] = "frames"

    def __post_init__(self) -> None:
        require_within(
            self,
            {
                "seed": (0, 2**31),
                "latency_ms": (0.0, 700.0),
                "start_off": (0.0, 2.0),
                "hidden": (0.0, 60.0),
                "hidden_every": (0.1, 1e6),
                "cable": (0.0, math.inf),
                "freeze": (0.0, math.inf),
                "freeze_for": (0.0, math.inf),
                "stale": (0.0, math.inf),
                "stale_for": (0.0, math.inf),
                "stale_age": (0.0, 10.0),
                "silent": (0.0, math.inf),
                "silent_for": (0.0, math.inf),
                "distortion": (-0.3, 0.3),
                "vehicles": (2, 20),
                "width": (64, 1920),
                "height": (64, 1080),
                "fov_deg": (20.0, 120.0),
                "swing": (0.0, 1.0),
                "yaw_deg": (0.0, 180.0),
                "bias_deg": (0.0, 30.0),
            },
        )
        self.conditions.rope(RopeParameters(swing=self.swing))  # refuses one that is too short for its swing
        if self.pal not in PRESETS:
            raise ValueError(f"pal must be one of {', '.join(PRESETS)}, got {self.pal!r}")
        if self.fields != "frames" and (self.quick or not PRESETS[self.pal].interlaced):
            lacks = "a quick chain has no pictures" if self.quick else f"pal={self.pal} is not interlaced"
            raise ValueError(f"fields={self.fields} needs interlaced pictures, and {lacks}")
        model, size = self.model, f"{self.width} x {self.height}"
        if model is not None and (model.width, model.height) != (self.width, self.height):
            raise ValueError(f"width and height are {size}, but the camera is for {model.width} x {model.height} px")

    @property
    def fps(self) -> int:
        """Pictures a second: frames, or half-frames."""
        return FPS if self.fields == "frames" else 2 * FPS

    def exposed(self, index: int) -> int:
        """Step of the world at which a picture, from 1, has the middle of its exposure; of a half-frame its field's."""
        return RATE // self.fps * index + (0 if self.fields == "frames" else FIELD)

    def chain(self, place: RelativeSetpoint) -> ChainParameters:
        """Return the parameters of the world.

        Parameters
        ----------
        place : RelativeSetpoint
            Where each vehicle begins beside the next.
        """
        return ChainParameters(
            vehicles=self.vehicles,
            place=place,
            start_off=(self.start_off,) * 3,
            rope=RopeParameters(swing=self.swing, yaw_deg=self.yaw_deg),
            vehicle=msgspec.structs.replace(self.vehicle, level_bias_deg=self.bias_deg),
            conditions=self.conditions,
            speed_control=msgspec.structs.replace(self.speed_control, used=self.commands == "speeds"),
        )

    @property
    def picture_faults(self) -> PictureFaults:
        """Which pictures the grabbers deliver."""
        return PictureFaults(
            fps=self.fps,
            freeze=self.freeze,
            freeze_for=self.freeze_for,
            stale=self.stale,
            stale_for=self.stale_for,
            stale_age=self.stale_age,
        )

    @property
    def picture_times(self) -> PictureTimes:
        """When pictures are delivered, what their time stamps say, and which do not come."""
        told, conditions = self.conditions.told_latency_ms, self.conditions
        half = self.fields != "frames"  # drawn with the other field of its frame, which ends 3 fields later
        return PictureTimes(
            fps=self.fps,
            latency=1e-3 * self.latency_ms,
            told=1e-3 * (self.latency_ms if told is None else told),
            jitter=1e-3 * conditions.jitter_ms,
            lost=conditions.frames_lost,
            seed=self.seed,
            exposed=(3 * FIELD if half else FIELD) + half_exposure(conditions.blur_ms, RATE),
            after=FIELD if half else 0,
        )

    @property
    def camera(self) -> CameraModel:
        """The camera model of all followers, as they are told it."""
        if self.model is not None:
            return self.model
        pinhole = CameraModel.from_fov(self.width, self.height, math.radians(self.fov_deg))
        return msgspec.structs.replace(pinhole, distortion=(self.distortion, 0.0, 0.0, 0.0, 0.0))


def parse_uri(uri: str) -> SimulationParameters:
    """Read the parameters in a URI.

    Raises
    ------
    ValueError
        If it does not begin with ``sim://chain``, or a parameter is unknown or out of range; with its name.
    """
    path, _, query = uri.partition("?")
    if path != SCHEME + "chain":
        real = "; real links do not fly yet: docs/radio.md has the way to a hover" if uri.startswith("serial:") else ""
        raise ValueError(f"a simulated world is named like sim://chain?vehicles=3&seed=7, got {uri!r}{real}")
    pairs = dict(parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query)))
    try:
        conditions = {name: pairs.pop(name) for name in list(pairs) if name in Conditions.__struct_fields__}
        nested: dict[str, object] = {"conditions": conditions} if conditions else {}
        return msgspec.convert(pairs | nested, SimulationParameters, strict=False)
    except msgspec.ValidationError as error:
        raise ValueError(f"{uri}: {error}") from None
