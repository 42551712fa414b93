"""Vehicles in a room that watch each other: `World`, in lock-step time, deterministic, with the truth of everything."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.follower import RelativeSetpoint
from matchset.sim import chain_motion
from matchset.sim.chain_motion import HIT_CEILING, HIT_FLOOR, HIT_VEHICLE, HIT_WALL, NOTHING
from matchset.sim.quadrotor import GRAVITY, PLACE, SIZE, SPEED, constants, resting, rotation
from matchset.sim.rope import Rope, RopeParameters
from matchset.sim.scene.furniture import FLOOR
from matchset.sim.scene.room import BACK, BEHIND, HALF_WIDTH
from matchset.sim.vehicle import BACKWARD, VehicleParameters, VehiclePose, toy

Floats = npt.NDArray[np.float64]

RATE = 480  # steps per s: 16 a frame, and fields 4 steps before and after its middle
STEP = 1.0 / RATE
KEPT = 1 * RATE  # steps that are remembered
UP = np.array((0.0, -1.0, 0.0))
LOOK = 4  # steps from one look for crashes to the next
ROOM_LENGTH = 3.0  # m of chain that fits into the room as it is; for a longer one the room grows
FRAME_RADIUS = 0.11  # m, of the sphere that a frame with its rotors fills
CAMERA_AHEAD = 0.05  # m, the camera before the center of mass


class ChainParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A chain of vehicles: each watches the next, the last hangs on a rope.

    Parameters
    ----------
    vehicles : int
        How many, 2 or more.
    place : RelativeSetpoint
        Where the camera of each is to be, beside the next one's ball.
    start_off : tuple of 3 floats
        How far off that each begins: to the right, up, and ahead, m.
    rope : RopeParameters
    vehicle : VehicleParameters, optional
        The toy by default.
    """

    vehicles: int = 3
    place: RelativeSetpoint = RelativeSetpoint(height=-0.19)
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
        self._sent: list[list[tuple[int, Command]]] = [[] for _ in range(count)]
        self._active = [Command()] * count
        self._sticks, self._heard = np.zeros((count, 4)), np.zeros(count, np.int64)
        self._held = np.ones(count, np.bool_)  # each begins in a hand, which lets go when the motors pull
        self._ended, self._hits = np.zeros(count, np.bool_), np.zeros(count, np.int64)
        length = parameters.place.heading * (count - 1)
        self.room_scale = max(length / ROOM_LENGTH, 1.0)
        self.states = self._begin(rng)
        self._chain = _chain_constants(parameters, self.room_scale)
        self._past, self._past_arms = np.empty((KEPT, count, SIZE)), np.empty((KEPT, 3))
        self._past[0], self._past_arms[0] = self.states, self.rope.arm

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
            due = self._hear(self.step + 1)
            self._fly(min([step, *(when - 1 for when in due)]))

    def poses(self, step: int) -> list[VehiclePose]:
        """Where everyone was at a step of the last second."""
        step = max(step, 0)
        if not self.step - KEPT < step <= self.step:
            raise ValueError(f"step {step} is not among the last {KEPT} before step {self.step}")
        count = self.parameters.vehicles
        places, turns, balls = np.empty((count, 3)), np.empty((count, 3, 3)), np.empty((count, 3))
        states, arm, yaw = self._past[step % KEPT], self._past_arms[step % KEPT], self.rope.yaw(step * STEP)
        height, length = self.parameters.vehicle.ball_height, self.rope.parameters.length
        chain_motion.seen(states, arm, yaw, length, height, places, turns, balls)
        return [VehiclePose(*each) for each in zip(places, turns, balls, strict=True)]

    def place(self, who: int, step: int | None = None) -> Floats:
        """Side, height and heading of a follower's camera in the level frame of its neighbor's ball: the truth, m."""
        poses = self.poses(self.step if step is None else step)
        return relative_position(poses[who], poses[who + 1])

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
            there = ball + matrix @ ((set_place.heading + CAMERA_AHEAD) * BACKWARD - set_place.side * np.eye(3)[0])
            there = there + set_place.height * UP
            off = np.array(parameters.start_off) * rng.choice((-1.0, 1.0), 3) * (1.0, -1.0, 1.0)
            thrust = toy.mass * GRAVITY
            states[who] = resting(there + matrix @ off, yaw, thrust)
        return states

    def _hear(self, step: int) -> list[int]:
        """Let commands act that have arrived by a step; tells when the next of each arrives."""
        due = []
        for who, queue in enumerate(self._sent):
            while queue and queue[0][0] <= step:
                self._heard[who], self._active[who] = queue.pop(0)
                heard = self._active[who]
                self._sticks[who] = heard.roll, heard.pitch, heard.yaw, heard.throttle
            if queue:
                due.append(queue[0][0])
        return due

    def _fly(self, until: int) -> None:
        """Let steps pass under the same sticks."""
        kicks = self._rng.standard_normal((until - self.step, *self._wander.shape))
        while self.step < until:
            before = self.step
            self.step = chain_motion.fly(
                self.states,
                self.rope.arm,
                self.rope.velocity,
                self.rope.anchor,
                self._wander,
                kicks,
                self._sticks,
                self._heard,
                self._held,
                self._ended,
                self._bias,
                self._age,
                self._constants,
                self._chain,
                self.rope.waves,
                self._past,
                self._past_arms,
                before,
                until,
                LOOK,
                self._hits,
            )
            kicks = kicks[self.step - before :]
            if self.step % LOOK == 0:
                self._note_crashes()

    def _note_crashes(self) -> None:
        """End the flight of whoever hit something."""
        for who, hit in enumerate(self._hits.tolist()):
            if hit != NOTHING:
                self._ended[who] = True
                self.states[who, SPEED : SPEED + 3] = 0.0
                self.crashes.append((self.time, who, _what(hit)))
        self._hits[:] = NOTHING


def _what(hit: int) -> str:
    """Say what a vehicle hit; vehicles count from 1."""
    fixed = {HIT_FLOOR: "hit the floor", HIT_CEILING: "hit the ceiling", HIT_WALL: "hit a wall"}
    return fixed.get(hit, f"hit vehicle {hit - HIT_VEHICLE + 1}")


def _chain_constants(parameters: ChainParameters, room_scale: float) -> Floats:
    """Pack what the kernels of `chain_motion` need, in their order."""
    toy, rope = parameters.vehicle, parameters.rope
    fade = STEP / toy.level_wander_time
    wide, near, far = (room_scale * edge for edge in (HALF_WIDTH, BEHIND, BACK))
    return np.array(
        [
            STEP,
            math.radians(toy.full_tilt_deg),
            math.radians(toy.full_yaw_rate_deg),
            toy.thrust_to_weight * toy.mass * GRAVITY,
            toy.battery_sag,
            toy.flight_time,
            toy.failsafe,
            fade,
            math.radians(toy.level_wander_deg) * math.sqrt(2.0 * fade),
            4.0 * math.pi * toy.rotor_radius**2,
            toy.air_density,
            toy.mass * GRAVITY,
            rope.length,
            rope.damping,
            toy.ball_height,
            toy.ball_radius,
            wide,
            near,
            far,
            FLOOR,
            FRAME_RADIUS,
        ]
    )


def camera_position(me: VehiclePose) -> Floats:
    """Tell where a vehicle's camera is, (3,), m."""
    where: Floats = me.position + CAMERA_AHEAD * me.rotation[:, 2]
    return where


def relative_position(me: VehiclePose, neighbor: VehiclePose) -> Floats:
    """Side, height and heading of a camera in the level frame of a ball, (3,), m (Epstein & Feldman, Eq. 6-8)."""
    out = neighbor.rotation @ BACKWARD
    length = math.hypot(out[0], out[2])
    away = camera_position(me) - neighbor.ball
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
