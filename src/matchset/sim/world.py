"""Vehicles in a room that watch each other: `World`, in lock-step time, deterministic, with the truth of everything."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.follower import SetPlace
from matchset.sim.eye import BACKWARD, Sight
from matchset.sim.furniture import FLOOR
from matchset.sim.quadrotor import GRAVITY, PLACE, SPEED, TURN, constants, downwash, resting, rotation, step_vehicle
from matchset.sim.room import BACK, BEHIND, HALF_WIDTH
from matchset.sim.rope import Rope, RopeParameters
from matchset.sim.vehicle import VehicleParameters, toy

Floats = npt.NDArray[np.float64]

RATE = 480  # steps per s: 16 a frame, and fields 4 steps before and after its middle
STEP = 1.0 / RATE
KEPT = 1 * RATE  # steps that are remembered
UP = np.array((0.0, -1.0, 0.0))
LOOK = 4  # steps from one look for crashes to the next
ROOM_LENGTH = 3.0  # m of chain that fits into the room as it is; for a longer one the room grows
FRAME_RADIUS = 0.11  # m, of the sphere that a frame with its rotors fills
LENS = 0.05  # m, the camera before the center of mass


class ChainParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A chain of vehicles: each watches the next, the last hangs on a rope.

    Parameters
    ----------
    vehicles : int
        How many, 2 or more.
    place : SetPlace
        Where the camera of each is to be, beside the next one's ball.
    start_off : tuple of 3 floats
        How far off that each begins: to the right, up, and ahead, m.
    rope : RopeParameters
    vehicle : VehicleParameters, optional
        The toy by default.
    """

    vehicles: int = 3
    place: SetPlace = SetPlace(height=-0.19)
    start_off: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rope: RopeParameters = RopeParameters()
    vehicle: VehicleParameters = msgspec.field(default_factory=toy)

    def __post_init__(self) -> None:
        if not 2 <= self.vehicles <= 20:
            raise ValueError(f"vehicles must be 2 ... 20, got {self.vehicles}")
        if not all(abs(value) <= 2.0 for value in self.start_off):
            raise ValueError(f"start_off must be within 2 m, got {self.start_off}")


class World:
    """The chain; time passes only in `advance`.

    Parameters
    ----------
    parameters : ChainParameters
    seed : int
        Decides biases, the battery, the swing, where each begins.

    Attributes
    ----------
    step : int
        Steps of 1/480 s since the beginning.
    crashes : list of (float, int, str)
        Time, vehicle, and what happened. A vehicle that crashed stays where it is.
    """

    def __init__(self, parameters: ChainParameters, seed: int = 0) -> None:
        self.parameters, self.seed, self.step = parameters, seed, 0
        self.crashes: list[tuple[float, int, str]] = []
        toy, count = parameters.vehicle, parameters.vehicles
        rng = np.random.default_rng((seed, 0xC4A1))
        ways = rng.uniform(0.0, 2.0 * math.pi, count)
        self._bias = math.radians(toy.level_bias_deg) * np.column_stack((np.cos(ways), np.sin(ways)))
        self._age = rng.uniform(0.0, 0.3, count) * toy.flight_time  # of the battery at the beginning
        self._wander = math.radians(toy.level_wander_deg) * rng.standard_normal((count, 2))
        self.rope = Rope(parameters.rope, (0.0, 0.2 - parameters.rope.length, _far_end(parameters)), rng)
        self._rng = np.random.default_rng((seed, 0xF117))
        self._constants = constants(toy)
        self._disc = 4.0 * math.pi * toy.rotor_radius**2
        self._sent: list[list[tuple[int, Command]]] = [[] for _ in range(count)]
        self._active = [Command()] * count
        self._heard = [0] * count
        self._held = [True] * count  # each begins in a hand, which lets go when the motors pull
        self._ended = [False] * count
        self._goal, self._wind = np.zeros(4), np.zeros(3)
        length = parameters.place.heading * (count - 1)
        self.room_scale = max(length / ROOM_LENGTH, 1.0)
        self.states = self._begin(rng)
        self._history: dict[int, tuple[Floats, Floats]] = {}
        self._remember()

    @property
    def time(self) -> float:
        """Since the beginning, s."""
        return self.step * STEP

    def send(self, who: int, command: Command, after: float = 0.0) -> Command:
        """Send sticks to a vehicle by its radio, s from now; returns them as they arrive, quantized."""
        arriving = quantized(command, self.parameters.vehicle.stick_levels)
        delay = after + self.parameters.vehicle.radio_delay
        self._sent[who].append((self.step + round(delay * RATE), arriving))
        return arriving

    def advance(self, step: int) -> None:
        """Let time pass until a step."""
        while self.step < step:
            self._step()

    def sights(self, step: int) -> list[Sight]:
        """Where everyone was at a step of the last second."""
        states, arm = self._history[max(step, 0)]
        up = self.parameters.vehicle.ball_height * UP
        sights = []
        for who, state in enumerate(states):
            turn = np.empty((3, 3))
            rotation(state, turn)
            if who == self.parameters.vehicles - 1:
                turn = self.rope.turn(max(step, 0) * STEP, arm)
            place = state[PLACE : PLACE + 3].copy()
            sights.append(Sight(place, turn, place + turn @ up))
        return sights

    def place(self, who: int, step: int | None = None) -> Floats:
        """Side, height and heading of a follower's camera in the level frame of its neighbor's ball: the truth, m."""
        sights = self.sights(self.step if step is None else step)
        return place_beside(sights[who], sights[who + 1])

    def _begin(self, rng: np.random.Generator) -> Floats:
        """Put everyone at the set place, but for `start_off` with signs from the seed."""
        parameters, toy = self.parameters, self.parameters.vehicle
        states = np.zeros((parameters.vehicles, 17))
        states[-1] = resting(self.rope.place, self.rope.yaw(0.0), 0.0)
        for who in range(parameters.vehicles - 2, -1, -1):
            yaw = self.rope.yaw(0.0)
            turn = resting((0.0, 0.0, 0.0), yaw, 0.0)
            matrix = np.empty((3, 3))
            rotation(turn, matrix)
            ball = states[who + 1, PLACE : PLACE + 3] + toy.ball_height * UP
            set_place = parameters.place
            there = ball + matrix @ ((set_place.heading + LENS) * BACKWARD - set_place.side * np.eye(3)[0])
            there = there + set_place.height * UP
            off = np.array(parameters.start_off) * rng.choice((-1.0, 1.0), 3) * (1.0, -1.0, 1.0)
            thrust = toy.mass * GRAVITY
            states[who] = resting(there + matrix @ off, yaw, thrust)
        return states

    def _step(self) -> None:
        toy = self.parameters.vehicle
        self.rope.step(STEP)
        self.step += 1
        fade = STEP / toy.level_wander_time
        kick = math.radians(toy.level_wander_deg) * math.sqrt(2.0 * fade)
        self._wander += -fade * self._wander + kick * self._rng.standard_normal(self._wander.shape)
        for who in range(self.parameters.vehicles - 1):
            self._wanted(who)
            self._held[who] = self._held[who] and self._goal[3] < 0.5 * toy.mass * GRAVITY
            if not (self._ended[who] or self._held[who]):
                downwash(self.states, who, self._disc, toy.air_density, self._wind)
                step_vehicle(self.states[who], self._goal, self._wind, self._constants, STEP)
        self._hang()
        self._remember()
        if self.step % LOOK == 0:
            self._look_for_crashes()

    def _wanted(self, who: int) -> None:
        """Tell what a vehicle's electronics make of its sticks: roll, pitch, yaw rate and thrust."""
        toy, queue = self.parameters.vehicle, self._sent[who]
        while queue and queue[0][0] <= self.step:
            self._heard[who], self._active[who] = queue.pop(0)
        sticks = self._active[who]
        if (self.step - self._heard[who]) * STEP > toy.failsafe:
            sticks = Command()
        used = min((self._age[who] + self.time) / toy.flight_time, 1.0)
        most = toy.thrust_to_weight * toy.mass * GRAVITY * (1.0 - toy.battery_sag * used)
        tilt = math.radians(toy.full_tilt_deg)
        goal, bias, wander = self._goal, self._bias[who], self._wander[who]
        goal[0] = tilt * sticks.roll + bias[0] + wander[0]
        goal[1] = tilt * sticks.pitch + bias[1] + wander[1]
        goal[2] = math.radians(toy.full_yaw_rate_deg) * sticks.yaw
        goal[3] = most * sticks.throttle

    def _hang(self) -> None:
        """Put the last one where its rope has it."""
        state, half = self.states[-1], 0.5 * self.rope.yaw(self.time)
        state[PLACE : PLACE + 3] = self.rope.anchor
        state[PLACE : PLACE + 3] += self.rope.arm
        state[SPEED : SPEED + 3] = self.rope.velocity
        state[TURN], state[TURN + 2] = math.cos(half), math.sin(half)

    def _remember(self) -> None:
        self._history[self.step] = (self.states.copy(), self.rope.arm.copy())
        self._history.pop(self.step - KEPT, None)

    def _look_for_crashes(self) -> None:
        sights = self.sights(self.step)
        ball = self.parameters.vehicle.ball_radius
        wide, near, far = (self.room_scale * edge for edge in (HALF_WIDTH, BEHIND, BACK))
        for who, sight in enumerate(sights[:-1]):
            if self._ended[who]:
                continue
            x, y, z = sight.place
            what = ""
            if y > FLOOR - 0.03:
                what = "hit the floor"
            elif sight.ball[1] < -FLOOR + ball:
                what = "hit the ceiling"
            elif abs(x) > wide - ball or not near + ball < z < far - ball:
                what = "hit a wall"
            for other, neighbor in enumerate(sights):
                if other != who and _touch(sight, neighbor, ball):
                    what = f"hit vehicle {other + 1}"
            if what:
                self._ended[who] = True
                self.states[who, SPEED : SPEED + 3] = 0.0
                self.crashes.append((self.time, who, what))


def _touch(one: Sight, two: Sight, ball: float) -> bool:
    """Whether two vehicles touch: their balls, or a frame, which fills a sphere around its place, anything."""
    parts = ((one.ball, ball), (one.place, FRAME_RADIUS)), ((two.ball, ball), (two.place, FRAME_RADIUS))
    return any(math.dist(here, there) < a + b for here, a in parts[0] for there, b in parts[1])


def lens_of(me: Sight) -> Floats:
    """Tell where a vehicle's camera is, (3,), m."""
    where: Floats = me.place + LENS * me.turn[:, 2]
    return where


def place_beside(me: Sight, neighbor: Sight) -> Floats:
    """Side, height and heading of a camera in the level frame of a ball, (3,), m (Epstein & Feldman, Eq. 6-8)."""
    out = neighbor.turn @ BACKWARD
    length = math.hypot(out[0], out[2])
    away = lens_of(me) - neighbor.ball
    across = (out[2] / length, -out[0] / length)
    side, heading = away[0] * across[0] + away[2] * across[1], (away[0] * out[0] + away[2] * out[2]) / length
    return np.array((side, -away[1], heading))


def quantized(command: Command, levels: float) -> Command:
    """Round sticks to the steps of the radio: `levels` from end to end."""
    half = 0.5 * levels
    roll, pitch, yaw = (
        min(max(round(value * half) / half, -1.0), 1.0) for value in (command.roll, command.pitch, command.yaw)
    )
    return Command(roll, pitch, yaw, round(command.throttle * levels) / levels)


def _far_end(parameters: ChainParameters) -> float:
    """Where the last one hangs in the room, z, m: the chain is around the middle of the room's free part."""
    return 0.9 + 0.5 * parameters.place.heading * (parameters.vehicles - 1)
