"""What a camera sees of a vehicle besides its ball: frame, arms, rotors and rope as `Surface`s."""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.sim.rendering.surface import Surface
from matchset.sim.vehicle import VehicleParameters

Floats = npt.NDArray[np.float64]

X, Y, Z = np.eye(3)  # geometry: axes of the body
BODY, ARM, BLADE, ROPE = (48, 44, 42), (70, 66, 64), (120, 118, 116), (150, 170, 180)  # format: BGR


def airframe(vehicle: VehicleParameters, rope: float = 0.0) -> list[Surface]:
    """Build the visible parts in the body frame: x right, y down, z forward, origin at the center of mass.

    Parameters
    ----------
    vehicle : VehicleParameters
        Gives the positions of the rotors.
    rope : float
        Length of a rope above the ball, m; 0 for none.

    Returns
    -------
    list of Surface
        The body first, then arms, motors and rotors, then the rope.
    """
    parts = _box(np.array((0.045, 0.018, 0.055)), BODY)
    reach = vehicle.arm / np.sqrt(2.0)
    for right, ahead in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        hub = reach * (right * X + ahead * Z) - 0.018 * Y
        across = 0.006 * (right * X - ahead * Z)
        parts.append(Surface(origin=-0.5 * across, u=hub, v=across, texture=_plain(ARM)))
        parts.append(Surface(origin=hub - 0.006 * X, u=0.012 * X, v=0.03 * Y, texture=_plain(ARM)))
        corner = hub - vehicle.rotor_radius * (X + Z)
        size = 2.0 * vehicle.rotor_radius
        parts.append(Surface(origin=corner, u=size * X, v=size * Z, texture=_disc()))
    if rope > 0.0:
        top = -(vehicle.ball_height + vehicle.ball_radius) * Y
        parts.append(Surface(origin=top - 0.004 * X, u=0.008 * X, v=-rope * Y, texture=_plain(ROPE)))
    return parts


def _plain(color: tuple[int, int, int]) -> npt.NDArray[np.uint8]:
    """Texture of one color."""
    return np.array([[(*color, 255)]], np.uint8)


def _disc() -> npt.NDArray[np.uint8]:
    """Picture of a turning rotor: a disc, every other texel of which is transparent."""
    square = np.zeros((33, 33, 4), np.uint8)
    square[..., :3] = BLADE
    cv2.circle(square, (16, 16), 16, (*BLADE, 255), -1)
    square[(np.indices((33, 33)).sum(axis=0) % 2) == 0, 3] = 0
    return square


def _box(half: Floats, color: tuple[int, int, int]) -> list[Surface]:
    """Six faces around the origin, shaded by the direction of their normal."""
    axes = half * np.eye(3)
    faces = []
    for k in range(3):
        for sign in (-1.0, 1.0):
            along, down = axes[(k + 1) % 3], axes[(k + 2) % 3]
            light = 1.3 if (k, sign) == (1, -1.0) else 0.8 + 0.1 * k
            shade = tuple(int(min(light * value, 255)) for value in color)
            corner = sign * axes[k] - along - down
            faces.append(Surface(origin=corner, u=2.0 * along, v=2.0 * down, texture=_plain((*shade,))))  # type: ignore[arg-type]
    return faces
