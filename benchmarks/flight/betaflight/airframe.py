"""A quadcopter of four motors with a balloon, as one rigid body: `Airframe`. Nothing of `matchset/sim` is used.

Axes of room and body: x right, y down, z forward. The air in the balloon, and half as much around it, is moved without
weight: a point mass at the balloon's center, coupled to the rotation, so that six equations are solved at once.
Estimates: a toy of 100 g with thrust twice its weight, thrust by the square of the motors' speed.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
GRAVITY = 9.80665  # m/s^2
PLACES = np.array(((1, 1), (-1, -1), (-1, 1), (1, -1)))  # right, forward: of the motors as Betaflight sends them
SPINS = np.array((1.0, 1.0, -1.0, -1.0))  # of their torque on the frame, clockwise seen from above


class AirframeParameters(NamedTuple):
    """Constants of the airframe, SI units."""

    mass: float = 0.100
    inertia: tuple[float, float, float] = (1.1e-4, 1.9e-4, 1.0e-4)  # about right, down, forward
    arm: float = 0.064  # of a motor to the right and forward
    thrust_to_weight: float = 2.0
    motor_lag: float = 0.025
    torque_per_thrust: float = 0.012  # m
    air: float = 1.20  # kg/m^3
    ball_radius: float = 0.14
    ball_height: float = 0.19
    ball_drag: float = 0.47
    frame_drag: float = 0.015  # N s/m
    release: float = 0.5  # share of the weight at which the hand lets go


class Airframe:
    """The state of the vehicle, advanced by `step`.

    Parameters
    ----------
    position : (3,)
        m.
    yaw : float
        Clockwise seen from above, rad.
    parameters : AirframeParameters, optional

    Attributes
    ----------
    position, velocity : (3,)
        Of its center of mass, in the room.
    rotation : (3, 3)
        From body to room.
    rates : (3,)
        Angular velocity in the body, rad/s.
    acceleration : (3,)
        In the room, of the last step.
    motors : (4,)
        Speeds as a share of the largest.
    held : bool
        A hand holds it until its motors pull.
    """

    def __init__(self, position: Floats, yaw: float, parameters: AirframeParameters | None = None) -> None:
        self.parameters = p = parameters or AirframeParameters()
        self.position, self.velocity = np.array(position, float), np.zeros(3)
        sin, cos = np.sin(yaw), np.cos(yaw)
        self.rotation = np.array(((cos, 0.0, sin), (0.0, 1.0, 0.0), (-sin, 0.0, cos)))
        self.rates, self.acceleration, self.motors, self.held = np.zeros(3), np.zeros(3), np.zeros(4), True
        volume = 4.0 / 3.0 * np.pi * p.ball_radius**3
        self._added, self._ball = 1.5 * p.air * volume, np.array((0.0, -p.ball_height, 0.0))
        self._area = 0.5 * p.air * p.ball_drag * np.pi * p.ball_radius**2
        self._inertia = np.diag(p.inertia)
        lever = _cross_matrix(self._ball)
        left, right = (p.mass + self._added) * np.eye(3), -self._added * lever
        matrix = np.block([[left, right], [self._added * lever, self._inertia - self._added * lever @ lever]])
        self._inverse = np.linalg.inv(matrix)

    @property
    def ball(self) -> Floats:
        """Center of its balloon in the room, m."""
        ball: Floats = self.position + self.rotation @ self._ball
        return ball

    @property
    def felt(self) -> Floats:
        """What an accelerometer feels, in the body, m/s^2."""
        felt: Floats = self.rotation.T @ (self.acceleration - np.array((0.0, GRAVITY, 0.0)))
        return felt

    def step(self, wanted: Floats, step: float) -> None:
        """Let time pass under motor commands 0 ... 1: semi-implicit Euler, for steps of a millisecond.

        Parameters
        ----------
        wanted : (4,)
            Of front right, rear left, front left, rear right.
        step : float
            s.
        """
        p = self.parameters
        self.motors += (1.0 - np.exp(-step / p.motor_lag)) * (wanted - self.motors)
        thrusts = 0.25 * p.thrust_to_weight * p.mass * GRAVITY * self.motors**2
        if self.held:
            self.held = thrusts.sum() < p.release * p.mass * GRAVITY
            return
        linear, angular = self._accelerations(thrusts)
        self.acceleration = self.rotation @ linear
        self.velocity += step * self.acceleration
        self.rates += step * angular
        self.position += step * self.velocity
        self.rotation = _orthonormal(self.rotation @ turn(step * self.rates))

    def _accelerations(self, thrusts: Floats) -> tuple[Floats, Floats]:
        """Linear and angular acceleration in the body."""
        p, w = self.parameters, self.rates
        air = self.rotation.T @ self.velocity
        at_ball = air + np.cross(w, self._ball)
        drag = -self._area * np.linalg.norm(at_ball) * at_ball
        weight = self.rotation.T @ np.array((0.0, p.mass * GRAVITY, 0.0))
        force = weight + drag - p.frame_drag * air - np.array((0.0, thrusts.sum(), 0.0))
        torque = np.cross(self._ball, drag)
        torque += p.arm * np.array((PLACES[:, 1] @ thrusts, 0.0, -(PLACES[:, 0] @ thrusts)))
        torque[1] += p.torque_per_thrust * (SPINS @ thrusts)
        turning = self._added * np.cross(w, np.cross(w, self._ball))  # of the added mass
        force, torque = force - turning, torque - np.cross(w, self._inertia @ w) - np.cross(self._ball, turning)
        both = self._inverse @ np.concatenate((force, torque))
        return both[:3], both[3:]


def quaternion(rotation: Floats) -> Floats:
    """Quaternion of a rotation, w first, with axes forward, right, down for both frames."""
    order = np.array(((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    m = order @ rotation @ order.T
    w = 0.5 * np.sqrt(max(1.0 + np.trace(m), 0.0))
    if w > 0.1:
        return np.array((w, *((m[[2, 0, 1], [1, 2, 0]] - m[[1, 2, 0], [2, 0, 1]]) / (4.0 * w))))
    values, vectors = np.linalg.eigh(0.5 * (m + m.T))  # about half a turn: the axis is not turned
    axis = vectors[:, np.argmax(values)]
    return np.array((w, *(np.sqrt(1.0 - w * w) * axis)))


def turn(angles: Floats) -> Floats:
    """Rotation by a vector of angles, rad (Rodrigues)."""
    angle = np.linalg.norm(angles)
    if angle < 1e-12:
        return np.eye(3)
    k = _cross_matrix(angles / angle)
    turned: Floats = np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k)
    return turned


def _orthonormal(m: Floats) -> Floats:
    nearer: Floats = m @ (1.5 * np.eye(3) - 0.5 * m.T @ m)
    return nearer


def _cross_matrix(v: Floats) -> Floats:
    return np.array(((0.0, -v[2], v[1]), (v[2], 0.0, -v[0]), (-v[1], v[0], 0.0)))
