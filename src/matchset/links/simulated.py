"""``sim://chain``: the simulated chain of vehicles, each with a camera and a link.

Reading a camera advances the simulated time to the moment at which its next picture has been processed, `latency_ms`
after it was taken. A command that is sent then is sent at that moment.
"""

import math
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.follower import RelativeSetpoint
from matchset.image.errors import LinkError
from matchset.image.frame import Frame, Rows
from matchset.links.link import Link, LinkStatus, State
from matchset.links.simulation_parameters import SCHEME, STEPS_PER_FRAME, SimulationParameters
from matchset.media.fields.half_frames import woven
from matchset.shapes.circle import Circle
from matchset.sim.cameras import FIELD, WorldCameras
from matchset.sim.conditions.exposures import half_exposure
from matchset.sim.conditions.outlines import BallOutline, OutlineCameras
from matchset.sim.on_board.radio import quantized
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import RATE, World
from matchset.tracking.track import Lost, Track

Seen = npt.NDArray[np.uint8] | BallOutline | Lost[Circle]  # a picture, or what is in it
START = RelativeSetpoint(height=-0.19)  # geometry: at the height of the next vehicle, whose ball is above its frame
LANDING_RATE = 30  # format: commands a second while it lands
NEUTRAL = 0.104  # format: s without a command after which the firmware makes the sticks neutral: 26 ticks of 4 ms


class SimulatedChain:
    """A simulated world, and for each follower a camera and a link.

    Parameters
    ----------
    parameters : SimulationParameters, optional
    start : RelativeSetpoint, optional
        Where each vehicle begins beside the next, up to `SimulationParameters.start_off`.

    Attributes
    ----------
    world : World
    images : WorldCameras or OutlineCameras
        The latter of a quick chain.
    cameras : list of SimulatedCamera
    links : list of SimulatedLink
    outlines : dict
        Of a quick chain: what each camera's newest picture shows, by follower.
    """

    def __init__(self, parameters: SimulationParameters | None = None, start: RelativeSetpoint | None = None) -> None:
        self.parameters = parameters or SimulationParameters()
        self.world = World(self.parameters.chain(start or START), self.parameters.seed)
        self.images = self._make_images()
        self.images.hide_balls(self.parameters.hidden, self.parameters.hidden_every)
        self._faults, self._times = self.parameters.picture_faults, self.parameters.picture_times
        self._exposed = FIELD + half_exposure(self.parameters.conditions.blur_ms, RATE)  # from the middle to the end
        self._pool = ThreadPoolExecutor(2)
        self._jobs: dict[tuple[int, int], Future[Seen]] = {}
        self.outlines: dict[int, BallOutline | Lost[Circle]] = {}
        count = self.parameters.vehicles - 1
        self.cameras = [SimulatedCamera(self, who) for who in range(count)]
        self.links = [SimulatedLink(self, who) for who in range(count)]

    def now(self) -> float:
        """Return the world's time, s."""
        return self.world.time

    def close(self) -> None:
        """Stop the threads."""
        self._pool.shutdown(cancel_futures=True)

    def expose(self, who: int, index: int) -> Frame | None:
        """Advance the time until a picture has been processed, and return it.

        Parameters
        ----------
        who : int
            Which follower, from 0.
        index : int
            Of the picture, from 1.

        Returns
        -------
        Frame or None
            None after the cable was pulled, and if the picture was lost.
        """
        self.world.advance(self._times.delivered(index))
        newest = (self.world.step - self._exposed) // STEPS_PER_FRAME  # drawn ahead by the threads
        first = self._frame(index)
        for wanted in range(first, max(newest, first) + 1):
            if wanted * STEPS_PER_FRAME / RATE >= self.parameters.cable:
                break
            for other in range(len(self.cameras)):
                if (other, wanted) not in self._jobs:
                    self._jobs[other, wanted] = self._take(other, STEPS_PER_FRAME * wanted)
        if first * STEPS_PER_FRAME / RATE >= self.parameters.cable:
            return None
        shown = self._faults.shown(index)
        seen, rows = self._seen(who, shown)
        oldest = self._frame(self._faults.oldest(index - 1)) - (rows != "all")
        for key in [key for key in self._jobs if key[0] == who and key[1] < oldest]:
            del self._jobs[key]
        if self._times.is_lost(who, index):
            return None
        if isinstance(seen, np.ndarray):
            return Frame(seen, self._times.stamp(index), index, rows=rows)
        self.outlines[who] = seen
        return Frame(number_plate(shown), self._times.stamp(index), index)

    def _frame(self, index: int) -> int:
        """Return the number of the whole frame that a picture is, or that a half-frame is of."""
        return index if self.parameters.fields == "frames" else (index + 1) // 2

    def _seen(self, who: int, index: int) -> tuple[Seen, Rows]:
        """Return what a picture shows, and which of its rows are new."""
        frame = self._frame(index)
        seen = self._jobs[who, frame].result()
        if self.parameters.fields == "frames" or not isinstance(seen, np.ndarray):
            return seen, "all"
        if index % 2 == 0:
            return seen, "bottom"
        before = self._jobs[who, frame - 1].result() if (who, frame - 1) in self._jobs else seen
        return woven(before, seen, 0) if isinstance(before, np.ndarray) else seen, "top"

    def beyond(self, who: int, index: int) -> BallOutline | Lost[Circle]:
        """Find the next-but-one ball in a picture of a quick chain."""
        if isinstance(self.images, WorldCameras):
            raise ValueError("the next-but-one ball is found without pictures only")
        return self.images.outline_beyond(who, self.parameters.exposed(self._faults.shown(index)))

    def truth(self, index: int | None = None) -> tuple[VehiclePose, ...]:
        """Return the poses of all vehicles now, or when the pictures of an index were taken."""
        return tuple(self.world.poses(self.world.step if index is None else self.parameters.exposed(index)))

    def inside(self, who: int, index: int) -> bool:
        """Whether the center of the neighbor's ball was in a camera's picture and not hidden on purpose."""
        return self.images.shows_ball(who, self.parameters.exposed(index))

    def sample(self, who: int) -> Frame:
        """Return a picture of a ball held 1 m before a camera, to learn the colors from."""
        if isinstance(self.images, WorldCameras):
            return Frame(self.images.held_ball(who), 0.0, 0)
        return Frame(np.zeros((self.parameters.height, self.parameters.width, 3), np.uint8), 0.0, 0)

    def _make_images(self) -> WorldCameras | OutlineCameras:
        parameters = self.parameters
        if parameters.quick:
            return OutlineCameras(self.world, parameters.camera, parameters.noise)
        return WorldCameras(self.world, parameters.camera, parameters.pal)

    def _take(self, who: int, step: int) -> "Future[Seen]":
        """Begin to draw a picture in a thread; an outline is found at once."""
        if isinstance(self.images, WorldCameras):
            return self._pool.submit(self.images.image, who, step)
        found: Future[Seen] = Future()
        found.set_result(self.images.outline(who, step))
        return found


class SimulatedCamera:
    """The camera of one follower; reading it advances the time.

    Attributes
    ----------
    model : CameraModel
    """

    def __init__(self, chain: SimulatedChain, who: int) -> None:
        self.model = chain.parameters.camera
        self._chain, self._who, self._index = chain, who, 0

    def read(self) -> Frame | None:
        """Return the next picture; None after the cable was pulled."""
        self._index += 1
        return self._chain.expose(self._who, self._index)

    def sample(self) -> Frame:
        """Return a picture of a ball held 1 m before the camera, its marker in the middle."""
        return self._chain.sample(self._who)

    def outlines(self, frame: Frame) -> tuple[Track[Circle] | Lost[Circle], tuple[Track[Circle], ...]]:
        """Return the ball and the markers of the newest picture, of a chain that is flown without pictures."""
        seen = self._chain.outlines[self._who]
        if isinstance(seen, Lost):
            return Lost(seen.reason, frame.time), ()
        return seen.tracks(frame.time, self._chain.parameters.noise)

    def ball_beyond(self, frame: Frame) -> Track[Circle] | Lost[Circle]:
        """Return the next-but-one ball of the newest picture, of a chain that is flown without pictures."""
        seen = self._chain.beyond(self._who, frame.index)
        return (
            Lost(seen.reason, frame.time)
            if isinstance(seen, Lost)
            else seen.tracks(frame.time, self._chain.parameters.noise)[0]
        )

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return self._chain.now()


def number_plate(number: int) -> npt.NDArray[np.uint8]:
    """Make a tiny picture that is another for every number: what is delivered where nothing is drawn."""
    return np.tile(np.frombuffer(number.to_bytes(8, "little"), np.uint8), (4, 1))


class SimulatedLink(Link):
    """The radio to one simulated vehicle; implements `matchset.links.link.Link`.

    Like the firmware it disarms when it has heard nothing for `VehicleParameters.failsafe`, and stays so until `arm`.
    Unlike there, the time begins with the first command after `arm`: before it the simulated time stands still, or
    jumps by the latency of the first picture.

    Parameters
    ----------
    chain : SimulatedChain
    who : int
        Which follower, from 0.

    Attributes
    ----------
    uri : str
    chain : SimulatedChain
    """

    def __init__(self, chain: SimulatedChain, who: int) -> None:
        self.uri = f"{SCHEME}chain#{who + 1}"
        self.chain, self._who = chain, who
        self._losses = np.random.default_rng((chain.parameters.seed, 0x1057, who))
        self._state: State = "locked"
        self._heard = math.inf  # when a command was last heard, s
        self._open, self._cut, self._sent = True, False, Command()

    def arm(self) -> None:
        """Enable the throttle."""
        self._check()
        self._state, self._heard, self._cut = "armed", math.inf, False

    def send(self, command: Command) -> Command:
        """Send a command; returns what the vehicle receives, all zero once the transmitter has refused."""
        self._check()
        self._pass()
        command, parameters = command if self._armed else Command(), self.chain.parameters
        if 0.0 <= self.chain.now() - parameters.silent < parameters.silent_for:
            self._sent = quantized(command, parameters.vehicle.stick_levels)
        else:
            self._sent = self._transmit(command)
            self._heard = self.chain.now()
            self._state = "armed" if self._armed else self._state
        return self._sent

    def _transmit(self, command: Command) -> Command:
        """Send by radio, which loses some; the transmitter does not notice."""
        share, parameters = self.chain.parameters.conditions.commands_lost, self.chain.parameters
        if share > 0.0 and self._losses.random() < share:
            return quantized(command, parameters.vehicle.stick_levels)
        return self.chain.world.send(self._who, command)

    def status(self) -> LinkStatus:
        """Return the state, with crashes as warnings."""
        self._check()
        self._pass()
        fallen = [what for _, who, what in self.chain.world.crashes if who == self._who]
        return LinkStatus(self._state, "simulated", 0, max(self._age, 0.0), tuple(fallen))

    def land(self, duration: float = 1.5) -> None:
        """Lower the throttle to zero over so many seconds of simulated time, then disarm."""
        self._check()
        self._pass()
        steps = max(round(duration * LANDING_RATE), 1) if self._armed else 0
        for k in range(1, steps + 1):
            command = Command(throttle=self._sent.throttle * (1.0 - k / steps))
            self.chain.world.send(self._who, command, after=duration * k / steps)
        self._state, self._sent = "locked", Command()

    def cut(self) -> None:
        """Disarm; the next command is the first that stops the motors."""
        self._cut = True

    def close(self) -> None:
        """Land and close the link."""
        if self._open:
            self.land()
            self._open = False

    @property
    def _armed(self) -> bool:
        return self._state in ("armed", "holding")

    @property
    def _age(self) -> float:
        """Age of the last command that was heard, s; -inf before the first."""
        return self.chain.now() - self._heard

    def _pass(self) -> None:
        """Let the transmitter's failsafe act."""
        if self._cut:
            self._state = "locked"
        elif self._armed and self._age >= self.chain.parameters.vehicle.failsafe:
            self._state = "failsafe"
        elif self._state == "armed" and self._age >= NEUTRAL:
            self._state = "holding"

    def _check(self) -> None:
        if not self._open:
            raise LinkError(f"{self.uri} is closed")
