"""Axes: those of matchset, right, down, forward, and those of autopilots, forward, right, down.

The camera's axes are x right, y down, z forward. The ball's are z out of the ball through marker 0, y down, x = y cross
z: the same, if marker 0 shows where the ball's front is. A vehicle's, and a level reference's, are x forward, y right,
z down. Of a vehicle that is level and faces north these are north, east, down.

    v_FRD = A v_RDF,    A = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
"""

import math
from typing import TYPE_CHECKING

import msgspec
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Floats = npt.NDArray[np.float64]

# geometry: turns right, down, forward into forward, right, down
FRD_OF_RDF: Floats = np.array(((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))


class CameraAxes(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How a camera sits on a vehicle, or stands on the ground.

    Parameters
    ----------
    roll, pitch, yaw : float
        Of the camera in the vehicle, or to the level ground, rad: its right side down, its axis up, its axis to the
        right; turned in the order yaw, pitch, roll.
    forward, right, down : float
        Where it is, from the vehicle's center or from the origin on the ground, m.

    Raises
    ------
    ValueError
        If a number is not finite.
    """

    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0
    forward: float = 0.0
    right: float = 0.0
    down: float = 0.0

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not math.isfinite(getattr(self, name)):
                raise ValueError(f"{name} of a camera's mount must be finite, got {getattr(self, name)}")

    @property
    def turn(self) -> Floats:
        """Turns vectors of the camera into those of the vehicle, (3, 3)."""
        return np.asarray(self.rotation.as_matrix()) @ FRD_OF_RDF

    @property
    def rotation(self) -> "Rotation":
        """Turns the forward, right, down of the camera into those of the vehicle."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_euler("ZYX", (self.yaw, self.pitch, self.roll))

    @property
    def offset(self) -> Floats:
        """Where the camera is, forward, right, down, (3,), m."""
        return np.array((self.forward, self.right, self.down))


def quaternion(turn: Floats) -> tuple[float, float, float, float]:
    """Return the quaternion of a rotation matrix, (3, 3), as MAVLink has it: w, x, y, z, with w >= 0."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(turn).as_quat(canonical=True).tolist()
    return w, x, y, z


def level_turn(roll: float, pitch: float, yaw: float) -> Floats:
    """Turn vectors of a vehicle, forward, right, down, into north, east, down, by its attitude, rad; (3, 3)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_euler("ZYX", (yaw, pitch, roll)).as_matrix())
