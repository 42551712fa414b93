"""``sim://chain``: the simulated chain of vehicles, each with a link and a camera.

``sim://chain?vehicles=3&seed=7&pal=typical&latency_ms=67``: what stands after the question mark are the fields of
`SimulationParameters`. Time passes when a camera is read: to the moment at which its next picture has been worked on,
`latency_ms` after it was taken. Whoever sends then sends at that moment.
"""

import math
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType
from typing import Literal, Self
from urllib.parse import parse_qsl

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.control.follower import RelativeSetpoint
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.links.link import LinkStatus
from matchset.sim.analog_link import PRESETS
from matchset.sim.cameras import FIELD, WorldCameras
from matchset.sim.rope import RopeParameters
from matchset.sim.vehicle import VehicleParameters, VehiclePose, toy
from matchset.sim.world import RATE, ChainParameters, World

FPS, FRAME = 30, RATE // 30  # pictures a second, steps a picture
SCHEME = "sim://"
PLACE = RelativeSetpoint(height=-0.19)  # at the next one's height: its ball is above its frame, and its camera on it


class SimulationParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is simulated.

    Parameters
    ----------
    vehicles : int
        Length of the chain; the last one hangs on a rope.
    seed : int
        Decides everything that is left to chance.
    pal : str
        The analog link: "clean", "typical" or "bad".
    latency_ms : float
        From the middle of a picture's exposure to the moment its command leaves the laptop, ms, rounded to 1/480 s; the
        radio's delay comes on top. Never less than the 8.3 ms after which the second field is exposed.
    swing : float
        Amplitude of the last one's swing, m.
    yaw_deg : float
        Amplitude of its yaw, degree.
    bias_deg : float
        How far off the level of each vehicle is, degree.
    start_off : float
        How far off in every axis each begins, m.
    hidden : float
        How long the ball is hidden at a time, s.
    hidden_every : float
        How often, s.
    cable : float
        When the camera's cable is pulled, s.
    distortion : float
        k1 of the lenses.
    width, height : int
        Of the pictures, px.
    fov_deg : float
        Horizontal field of view of the lenses, without their distortion, degree.
    model : CameraModel, optional
        The cameras, in place of `distortion` and `fov_deg`; its size must be that of the pictures.
    vehicle : VehicleParameters, optional
        The vehicles; but for their bias, which is `bias_deg`.
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
    distortion: float = -0.08
    width: int = 640
    height: int = 480
    fov_deg: float = 90.0
    model: CameraModel | None = None
    vehicle: VehicleParameters = msgspec.field(default_factory=toy)

    def __post_init__(self) -> None:
        for name, low, high in (
            ("seed", 0, 2**31),
            ("latency_ms", 0.0, 700.0),
            ("start_off", 0.0, 2.0),
            ("hidden", 0.0, 60.0),
            ("hidden_every", 0.1, 1e6),
            ("cable", 0.0, math.inf),
            ("distortion", -0.3, 0.3),
            ("vehicles", 2, 20),
            ("width", 64, 1920),
            ("height", 64, 1080),
            ("fov_deg", 20.0, 120.0),
            ("swing", 0.0, 1.0),
            ("yaw_deg", 0.0, 180.0),
            ("bias_deg", 0.0, 30.0),
        ):
            if not low <= getattr(self, name) <= high:
                raise ValueError(f"{name} must be within {low:g} ... {high:g}, got {getattr(self, name)}")
        if self.pal not in PRESETS:
            raise ValueError(f"pal must be one of {', '.join(PRESETS)}, got {self.pal!r}")
        model, size = self.model, f"{self.width} x {self.height}"
        if model is not None and (model.width, model.height) != (self.width, self.height):
            raise ValueError(f"width and height are {size}, but the camera is for {model.width} x {model.height} px")

    def chain(self, place: RelativeSetpoint) -> ChainParameters:
        """Tell the world what is simulated."""
        return ChainParameters(
            vehicles=self.vehicles,
            place=place,
            start_off=(self.start_off,) * 3,
            rope=RopeParameters(swing=self.swing, yaw_deg=self.yaw_deg),
            vehicle=msgspec.structs.replace(self.vehicle, level_bias_deg=self.bias_deg),
        )

    @property
    def camera(self) -> CameraModel:
        """The cameras."""
        if self.model is not None:
            return self.model
        pinhole = CameraModel.from_fov(self.width, self.height, math.radians(self.fov_deg))
        return msgspec.structs.replace(pinhole, distortion=(self.distortion, 0.0, 0.0, 0.0, 0.0))


class SimulatedChain:
    """A world, and for each follower a camera and a link.

    Parameters
    ----------
    parameters : SimulationParameters, optional
    place : RelativeSetpoint, optional
        Where each begins beside the next, but for `SimulationParameters.start_off`.

    Attributes
    ----------
    world : World
    cameras : list of SimulatedCamera
    links : list of SimulatedLink
    """

    def __init__(self, parameters: SimulationParameters | None = None, place: RelativeSetpoint | None = None) -> None:
        self.parameters = parameters or SimulationParameters()
        self.world = World(self.parameters.chain(place or PLACE), self.parameters.seed)
        self._images = WorldCameras(self.world, self.parameters.camera, self.parameters.pal)
        self._images.hide_balls(self.parameters.hidden, self.parameters.hidden_every)
        self._pool = ThreadPoolExecutor(2)
        self._jobs: dict[tuple[int, int], Future[npt.NDArray[np.uint8]]] = {}
        count = self.parameters.vehicles - 1
        self.cameras = [SimulatedCamera(self, who) for who in range(count)]
        self.links = [SimulatedLink(self, who) for who in range(count)]

    def now(self) -> float:
        """Return the world's time, s."""
        return self.world.time

    def close(self) -> None:
        """Let go of the threads."""
        self._pool.shutdown(cancel_futures=True)

    def expose(self, who: int, index: int) -> Frame | None:
        """Let time pass until a picture has been worked on; the picture, None after the cable was pulled."""
        latency = max(round(1e-3 * self.parameters.latency_ms * RATE), FIELD)
        taken = FRAME * index
        self.world.advance(taken + latency)
        newest = (self.world.step - FIELD) // FRAME  # drawn ahead while this one is worked on
        for wanted in range(index, max(newest, index) + 1):
            if wanted * FRAME / RATE >= self.parameters.cable:
                break
            for other in range(len(self.cameras)):
                if (other, wanted) not in self._jobs:
                    self._jobs[other, wanted] = self._pool.submit(self._images.image, other, FRAME * wanted)
        if taken / RATE >= self.parameters.cable:
            return None
        image = self._jobs[who, index].result()
        self._jobs.pop((who, index - 2), None)
        return Frame(image, taken / RATE, index)

    def truth(self, index: int | None = None) -> tuple[VehiclePose, ...]:
        """Where everyone is now, or was when the pictures of an index were taken."""
        return tuple(self.world.poses(self.world.step if index is None else FRAME * index))

    def inside(self, who: int, index: int) -> bool:
        """Whether the middle of the neighbor's ball was in a camera's picture, and nothing was held before it."""
        return self._images.shows_ball(who, FRAME * index)

    def sample(self, who: int) -> Frame:
        """Take a picture of a ball that someone holds 1 m before a camera, to teach the colors."""
        return Frame(self._images.held_ball(who), 0.0, 0)


class SimulatedCamera:
    """The camera of one follower; reading it lets time pass.

    Attributes
    ----------
    model : CameraModel
    """

    def __init__(self, chain: SimulatedChain, who: int) -> None:
        self.model = chain.parameters.camera
        self._chain, self._who, self._index = chain, who, 0

    def read(self) -> Frame | None:
        """Return the next picture; None if none came for the time of one."""
        self._index += 1
        return self._chain.expose(self._who, self._index)

    def sample(self) -> Frame:
        """Take a picture of a ball held 1 m before the camera, its marker in the middle."""
        return self._chain.sample(self._who)

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return self._chain.now()


class SimulatedLink:
    """The radio to one simulated vehicle; implements `matchset.links.link.Link`."""

    def __init__(self, chain: SimulatedChain, who: int) -> None:
        self.uri = f"{SCHEME}chain#{who + 1}"
        self.chain, self._who = chain, who
        self._armed, self._open, self._sent = False, True, Command()

    def arm(self) -> None:
        """Make the vehicle take throttle."""
        self._check()
        self._armed = True

    def send(self, command: Command) -> Command:
        """Send the sticks of this moment; returns what the vehicle gets."""
        self._check()
        self._sent = self.chain.world.send(self._who, command if self._armed else Command())
        return self._sent

    def status(self) -> LinkStatus:
        """Return how things stand."""
        self._check()
        fallen = [what for _, who, what in self.chain.world.crashes if who == self._who]
        return LinkStatus("armed" if self._armed else "locked", "simulated", 0, 0.0, tuple(fallen))

    def land(self, duration: float = 1.5) -> None:
        """Bring the throttle to zero over so many seconds of the world's time, then disarm."""
        self._check()
        steps = max(round(duration * FPS), 1) if self._armed else 0
        for k in range(1, steps + 1):
            command = Command(throttle=self._sent.throttle * (1.0 - k / steps))
            self.chain.world.send(self._who, command, after=duration * k / steps)
        self._armed, self._sent = False, Command()

    def close(self) -> None:
        """Land and let go."""
        if self._open:
            self.land()
            self._open = False

    def __enter__(self) -> Self:
        """Return the link."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Land and let go."""
        self.close()

    def _check(self) -> None:
        if not self._open:
            raise LinkError(f"{self.uri} is closed")


def parse_uri(uri: str) -> SimulationParameters:
    """Read the parameters in a URI.

    Raises
    ------
    ValueError
        If it does not begin with ``sim://chain``, or a parameter is unknown or out of range; with its name.
    """
    path, _, query = uri.partition("?")
    if path != SCHEME + "chain":
        raise ValueError(f"a simulated world is named like sim://chain?vehicles=3&seed=7, got {uri!r}")
    pairs = dict(parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query)))
    try:
        return msgspec.convert(pairs, SimulationParameters, strict=False)
    except msgspec.ValidationError as error:
        raise ValueError(f"{uri}: {error}") from None
