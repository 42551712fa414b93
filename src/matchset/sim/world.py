"""A chain of vehicles in a room: `World`, deterministic, in steps of 1/480 s, with the true pose of every vehicle."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.follower import RelativeSetpoint
from matchset.numeric.arguments import require_within
from matchset.numeric.copies import Copied
from matchset.numeric.record import fields, new_block
from matchset.sim import chain_motion
from matchset.sim.chain_motion import CHAIN, HIT_CEILING, HIT_FLOOR, HIT_VEHICLE, HIT_WALL, MOST_VEHICLES, NOTHING
from matchset.sim.conditions.conditions import Conditions
from matchset.sim.conditions.gusts import Gusts
from matchset.sim.on_board.radio import quantized
from matchset.sim.on_board.speed_control import SpeedControlParameters, store_speed_control
from matchset.sim.quadrotor import (
    GRAVITY,
    STATE,
    STATE_SIZE,
    VEHICLE,
    WAKE,
    WakeParameters,
    rotation_matrix,
    state_at_rest,
    vehicle_constants,
    wake_constants,
)
from matchset.sim.rope import ROPE, Rope, RopeParameters
from matchset.sim.scene.furniture import FLOOR
from matchset.sim.scene.room import BACK, BEHIND, HALF_WIDTH
from matchset.sim.vehicle import BACKWARD, VehicleParameters, VehiclePose, toy

Floats = npt.NDArray[np.float64]

RATE = 480  # format: steps a second: 16 a frame, and fields 4 steps before and after its middle
STEP = 1.0 / RATE  # format: s
KEPT = 1 * RATE  # format: capacity, steps that are remembered
UP = np.array((0.0, -1.0, 0.0))  # geometry: world frame
MINUTE = 60.0  # format: s
CAMERA_AHEAD = 0.05  # geometry: m, from the center of mass forward to the camera


class WorldParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What counts as a crash, when a flight begins, and how large the room is.

    Parameters
    ----------
    check_period : int
        Steps from one test for crashes to the next. Fewer: crashes are noticed earlier, flights take longer to compute.
        Chosen by hand: at 4 steps, 8 ms, a vehicle moves less than 2 cm between tests; `test_world` shows a change.
    frame_radius : float
        Radius of the sphere that a frame with its rotors fills, m: an arm and a rotor of ``vehicle.toml`` reach 0.12 m.
    clearance : float
        Height of the center of mass above the floor at which a vehicle has hit it, m. Chosen by hand: half the height
        of the frame; `test_world` shows a change.
    release : float
        Share of a vehicle's weight that its thrust must reach before the hand that holds it lets go. Chosen by hand;
        `test_world` shows a change.
    room_length : float
        Length of a chain, first to last camera, that fits into the room as it is, m; for a longer one the room grows.
    ceiling_anchor : float
        Height, below the origin, of a rope's vehicle at rest, m: the chain flies at about the camera's height.
    """

    check_period: int = 4
    frame_radius: float = 0.11
    clearance: float = 0.03
    release: float = 0.5
    room_length: float = 3.0
    ceiling_anchor: float = 0.2


class ChainParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A chain of vehicles: each watches the next, the last hangs on a rope.

    Parameters
    ----------
    vehicles : int
        How many, 2 to 20.
    place : RelativeSetpoint
        Where the camera of each is to be, relative to the next one's ball.
    start_off : tuple of 3 floats
        Distance from there at which each begins: to the right, up, and ahead, m; the signs follow from the seed.
    rope : RopeParameters
    vehicle : VehicleParameters, optional
        The toy by default.
    world : WorldParameters
    wake : WakeParameters
    speed_control : SpeedControlParameters
        Whether vehicles are told speeds, and how they hold them.
    conditions : Conditions
        How vehicles, rope and air differ from that; nobody is told.
    """

    vehicles: int = 3
    place: RelativeSetpoint = RelativeSetpoint(height=-0.19)
    start_off: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rope: RopeParameters = RopeParameters()
    vehicle: VehicleParameters = msgspec.field(default_factory=toy)
    world: WorldParameters = WorldParameters()
    wake: WakeParameters = WakeParameters()
    speed_control: SpeedControlParameters = SpeedControlParameters()
    conditions: Conditions = Conditions()

    def __post_init__(self) -> None:
        require_within(self, {"vehicles": (2, MOST_VEHICLES)}, "must be")
        if not all(abs(value) <= 2.0 for value in self.start_off):
            raise ValueError(f"start_off must be within 2 m, got {self.start_off}")


class World(Copied):
    """The chain; time passes only in `advance`.

    Parameters
    ----------
    parameters : ChainParameters, optional
        Three vehicles by default.
    seed : int
        Decides biases, the state of the batteries, the swing of the rope and the start positions; not negative.

    Raises
    ------
    ValueError
        If the parameters or the seed are no such things.

    Attributes
    ----------
    vehicle : VehicleParameters
        The vehicles as they are: those of the parameters under their conditions.
    step : int
        Steps of 1/480 s since the beginning.
    states : ndarray of shape (n, 17)
        `matchset.sim.quadrotor.VehicleState` of each, now.
    motion : record
        `matchset.sim.chain_motion.ChainState`, now; the first n of its arrays' rows are used.
    rope : Rope
    room_scale : float
        Factor on length and width of the room.
    crashes : list of (float, int, str)
        Time, vehicle, and what happened. A vehicle that crashed stays where it is.
    """

    def __init__(self, parameters: ChainParameters | None = None, seed: int = 0) -> None:
        parameters = ChainParameters() if parameters is None else parameters
        if not isinstance(parameters, ChainParameters):
            raise ValueError(f"parameters must be a ChainParameters, got {parameters!r}")
        if not (isinstance(seed, int | np.integer) and seed >= 0):
            raise ValueError(f"seed must be a whole number, 0 or more, got {seed!r}")
        self.parameters, self.seed, self.step = parameters, int(seed), 0
        self.crashes: list[tuple[float, int, str]] = []
        self.vehicle, count = parameters.conditions.vehicle(parameters.vehicle), parameters.vehicles
        vehicle, rope = self.vehicle, parameters.conditions.rope(parameters.rope)
        self._block = new_block(CHAIN)
        self._make_derived()
        motion = self.motion
        self.room_scale = max(parameters.place.heading * (count - 1) / parameters.world.room_length, 1.0)
        self._store_constants()
        rng = np.random.default_rng((seed, 0xC4A1))
        directions = rng.uniform(0.0, 2.0 * math.pi, count)
        bias = math.radians(vehicle.level_bias_deg) * np.column_stack((np.cos(directions), np.sin(directions)))
        motion.level_bias[:count] = bias + np.radians(parameters.conditions.level_trim_deg)
        motion.battery_age[:count] = rng.uniform(0.0, 0.3, count) * vehicle.flight_time
        motion.level_wander[:count] = math.radians(vehicle.level_wander_deg) * rng.standard_normal((count, 2))
        motion.held[:] = 1  # each begins in a hand, which lets go when the motors pull
        anchor = (0.0, parameters.world.ceiling_anchor - rope.length, _far_end(parameters))
        self.rope = Rope(rope, anchor, rng, self._part("rope", ROPE))
        self._rng = np.random.default_rng((seed, 0xF117))
        self._gusts = Gusts(parameters.conditions, seed, motion.air, STEP)
        self._sent: list[list[tuple[int, Command]]] = [[] for _ in range(count)]
        self._active = [Command()] * count
        self.states = self._begin(rng)
        self._past, self._past_offsets = np.empty((KEPT, count, STATE_SIZE)), np.empty((KEPT, 3))
        self._past[0], self._past_offsets[0] = self.states, self.rope.state.offset
        self._compile()

    def _derive(self) -> None:
        self.motion = fields(self._block, CHAIN)
        if hasattr(self, "rope"):  # a copy
            self.rope.share(self._part("rope", ROPE))

    @property
    def time(self) -> float:
        """Since the beginning, s."""
        return self.step * STEP

    def send(self, who: int, command: Command, after: float = 0.0) -> Command:
        """Send sticks to a vehicle by its radio, to leave so many s from now; they act `radio_delay` later.

        Parameters
        ----------
        who : int
            Which, from 0; the last one hangs on a rope and hears nothing.
        command : Command
        after : float
            s, 0 or more.

        Returns
        -------
        Command
            The sticks as they arrive, quantized.

        Raises
        ------
        ValueError
            If there is no such follower.
        """
        self._check_follower(who)
        arriving = quantized(command, self.vehicle.stick_levels)
        delay = after + self.vehicle.radio_delay
        self._sent[who].append((self.step + round(delay * RATE), arriving))
        return arriving

    def let_go(self, who: int) -> None:
        """Let go of a follower now, whatever its motors do; otherwise the hand that holds it waits for them to pull.

        Parameters
        ----------
        who : int
            Which, from 0.

        Raises
        ------
        ValueError
            If there is no such follower.
        """
        self._check_follower(who)
        self.motion.held[who] = 0

    def advance(self, step: int) -> None:
        """Let time pass until a step: a number of steps of 1/480 s since the beginning, no time if it is past."""
        while self.step < step:
            due = self._receive(self.step + 1)
            self._fly(min([step, *(when - 1 for when in due)]))

    def poses(self, step: int) -> list[VehiclePose]:
        """Poses of all vehicles at a step of the last second.

        Raises
        ------
        ValueError
            If the step is not remembered.
        """
        step = max(step, 0)
        if not self.step - KEPT < step <= self.step:
            raise ValueError(f"step {step} is not among the last {KEPT} before step {self.step}")
        count = self.parameters.vehicles
        poses = np.empty((count, 3)), np.empty((count, 3, 3)), np.empty((count, 3))
        states, offset = self._past[step % KEPT], self._past_offsets[step % KEPT]
        chain_motion.write_poses(self._block, states, offset, step * STEP, poses)
        return [VehiclePose(*each) for each in zip(*poses, strict=True)]

    def place(self, who: int, step: int | None = None) -> Floats:
        """Side, height and heading of a follower's camera in the level frame of its neighbor's ball: the truth, m.

        Parameters
        ----------
        who : int
            Which, from 0.
        step : int, optional
            One of the last second; now by default.

        Returns
        -------
        ndarray of shape (3,), float64
            Epstein & Feldman, Eq. 6-8.

        Raises
        ------
        ValueError
            If there is no such follower, or the step is not remembered.
        """
        self._check_follower(who)
        poses = self.poses(self.step if step is None else step)
        return relative_position(poses[who], poses[who + 1])

    def _check_follower(self, who: int) -> None:
        """Refuse what is no follower: negative numbers would count from the end."""
        last = self.parameters.vehicles - 2
        if not 0 <= who <= last:
            raise ValueError(f"the followers of this chain are 0 ... {last}, got {who!r}")

    def _store_constants(self) -> None:
        """Write what stays the same into the block."""
        parameters, motion = self.parameters, self.motion
        conditions, told = parameters.conditions, parameters.vehicle
        vehicle, world, weight = self.vehicle, parameters.world, self.vehicle.mass * GRAVITY
        decay = STEP / vehicle.level_wander_time
        motion.time_step, motion.check_period = STEP, world.check_period
        self._part("vehicle", VEHICLE)[:] = vehicle_constants(vehicle)
        self._part("wake", WAKE)[:] = wake_constants(vehicle, parameters.wake)
        electronics, room = motion.electronics, motion.room
        store_speed_control(motion.speed_control, parameters.speed_control, vehicle, STEP)
        electronics.full_tilt = math.radians(vehicle.full_tilt_deg)
        electronics.full_yaw_rate = math.radians(vehicle.full_yaw_rate_deg)
        electronics.full_thrust = conditions.full_thrust(told) * GRAVITY
        electronics.battery_sag, electronics.flight_time = vehicle.battery_sag, vehicle.flight_time
        electronics.failsafe, electronics.wander_decay = vehicle.failsafe, decay
        electronics.wander_noise = math.radians(vehicle.level_wander_deg) * math.sqrt(2.0 * decay)
        electronics.release_thrust = world.release * weight
        electronics.battery_loss = conditions.battery_loss_per_min / MINUTE
        electronics.yaw_trim = math.radians(conditions.yaw_trim_deg_s)
        electronics.thrust_exponent, electronics.hover_throttle = conditions.thrust_exponent, told.hover_throttle
        motion.vehicle.yaw_gain = told.rate_gain / conditions.yaw_lag
        room.half_width, room.near, room.far = (self.room_scale * edge for edge in (HALF_WIDTH, BEHIND, BACK))
        room.floor, room.clearance, room.frame_radius = FLOOR, world.clearance, world.frame_radius
        room.ball_radius, room.ball_height = vehicle.ball_radius, vehicle.ball_height

    def _part(self, name: str, layout: "np.dtype[np.void]") -> Floats:
        """Floats of a record in the block."""
        start = CHAIN.fields[name][1] // self._block.itemsize  # type: ignore[index]
        return self._block[start : start + layout.itemsize // self._block.itemsize]

    def _begin(self, rng: np.random.Generator) -> Floats:
        """Put every vehicle at its setpoint, but for `start_off` with signs from the seed."""
        parameters, vehicle = self.parameters, self.vehicle
        states, yaw = np.zeros((parameters.vehicles, STATE_SIZE)), self.rope.yaw(0.0)
        states[-1] = state_at_rest(self.rope.position, yaw, 0.0)
        level = np.empty((3, 3))
        rotation_matrix(state_at_rest((0.0, 0.0, 0.0), yaw, 0.0), level)
        for who in range(parameters.vehicles - 2, -1, -1):
            ball = fields(states[who + 1], STATE).position + vehicle.ball_height * UP
            goal = parameters.place
            there = ball + level @ ((goal.heading + CAMERA_AHEAD) * BACKWARD - goal.side * np.eye(3)[0])
            there = there + goal.height * UP
            off = np.array(parameters.start_off) * rng.choice((-1.0, 1.0), 3) * (1.0, -1.0, 1.0)
            states[who] = state_at_rest(there + level @ off, yaw, vehicle.mass * GRAVITY)
        return states

    def _compile(self) -> None:
        """Compile what `advance` and `poses` call, by letting no time pass."""
        no_kicks = np.empty((0, self.parameters.vehicles, 2))  # of the same type with gusts
        chain_motion.fly(self._block, self.states, no_kicks, self._past, self._past_offsets, self.step)
        self.poses(self.step)

    def _receive(self, step: int) -> list[int]:
        """Let commands act that have arrived by a step; return the steps at which further ones arrive."""
        due = []
        for who, queue in enumerate(self._sent):
            while queue and queue[0][0] <= step:
                self.motion.heard[who], self._active[who] = queue.pop(0)
                heard = self._active[who]
                self.motion.sticks[who] = heard.roll, heard.pitch, heard.yaw, heard.throttle
            if queue:
                due.append(queue[0][0])
        return due

    def _fly(self, until: int) -> None:
        """Let steps pass under the same sticks."""
        kicks = self._rng.standard_normal((until - self.step, self.parameters.vehicles, 2))
        kicks = self._gusts.added_to(kicks)
        while self.step < until:
            before = self.step
            self.step = chain_motion.fly(self._block, self.states, kicks, self._past, self._past_offsets, until)
            kicks = kicks[self.step - before :]
            if self.step % self.parameters.world.check_period == 0:
                self._note_crashes()

    def _note_crashes(self) -> None:
        """End the flight of vehicles that hit something."""
        for who, hit in enumerate(self.motion.hits[: self.parameters.vehicles].tolist()):
            if hit != NOTHING:
                self.motion.crashed[who] = 1
                fields(self.states[who], STATE).velocity[:] = 0.0
                self.crashes.append((self.time, who, _what(hit)))
        self.motion.hits[:] = NOTHING


def _what(hit: int) -> str:
    """Say what a vehicle hit; vehicles count from 1."""
    fixed = {HIT_FLOOR: "hit the floor", HIT_CEILING: "hit the ceiling", HIT_WALL: "hit a wall"}
    return fixed.get(hit, f"hit vehicle {hit - HIT_VEHICLE + 1}")


def camera_position(vehicle: VehiclePose) -> Floats:
    """Position of a vehicle's camera, (3,), room frame, m."""
    position: Floats = vehicle.position + CAMERA_AHEAD * vehicle.rotation[:, 2]
    return position


def relative_position(me: VehiclePose, neighbor: VehiclePose) -> Floats:
    """Side, height and heading of a camera in the level frame of a ball, (3,), m (Epstein & Feldman, Eq. 6-8)."""
    out = neighbor.rotation @ BACKWARD
    length = math.hypot(out[0], out[2])
    away = camera_position(me) - neighbor.ball
    across = (out[2] / length, -out[0] / length)
    side, heading = away[0] * across[0] + away[2] * across[1], (away[0] * out[0] + away[2] * out[2]) / length
    return np.array((side, -away[1], heading))


def _far_end(parameters: ChainParameters) -> float:
    """Where the last one hangs in the room, z, m: the chain is around the middle of the room's free part."""
    return 0.9 + 0.5 * parameters.place.heading * (parameters.vehicles - 1)
