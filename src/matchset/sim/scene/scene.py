"""The room behind the ball: `Scene`, the exact one of two renderers of a room; `FastScene` is the fast one."""

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.sim.rendering.surface import Picture, Surface, draw_surfaces
from matchset.sim.scene.clutter import clutter as blue_things
from matchset.sim.scene.room import room as furnished_room

Array = npt.NDArray[np.float64]
SMOOTH_WIDTH = 1280  # geometry: px; up to this width a pixel gets four rays


class Scene(msgspec.Struct, frozen=True):
    """Surfaces in the room frame: x right, y down, z forward (m), origin at a camera at rest.

    Parameters
    ----------
    surfaces : list of Surface
        The surfaces.
    """

    surfaces: list[Surface]

    @classmethod
    def room(cls, seed: int, clutter: bool = False) -> "Scene":
        """Furnish a room.

        Parameters
        ----------
        seed : int
            Decides everything; not negative.
        clutter : bool
            Hang up blue posters, bars and rims. Without them nothing is as blue as the balloon.

        Returns
        -------
        Scene
        """
        surfaces = furnished_room(np.random.default_rng((seed, 0x0B0E)))
        if clutter:
            surfaces += blue_things(np.random.default_rng((seed, 0xB1E)))
        return cls(surfaces)

    def render(
        self,
        camera: CameraModel,
        rotation: Array | None = None,
        position: Array | None = None,
        samples: int | None = None,
    ) -> Picture:
        """Render what a camera sees.

        Parameters
        ----------
        camera : CameraModel
            The camera.
        rotation : ndarray of shape (3, 3), optional
            Turns camera-frame vectors into the room frame. Default: the camera looks along +z.
        position : ndarray of shape (3,), optional
            Where it is in the room frame, m. Default: the origin.
        samples : int, optional
            Rays per pixel along x and along y; more: smoother edges, slower. Default: 2, or 1 above 1280 px
            of width.

        Returns
        -------
        ndarray of shape (h, w, 3), float32
            BGR, 0 ... 255.
        """
        if samples is None:
            samples = 2 if camera.width <= SMOOTH_WIDTH else 1
        if samples < 1:
            raise ValueError(f"a pixel needs at least one ray, got {samples}")
        turned = np.eye(3) if rotation is None else np.asarray(rotation, dtype=np.float64)
        at = np.zeros(3) if position is None else np.asarray(position, dtype=np.float64)
        if turned.shape != (3, 3) or at.shape != (3,):
            raise ValueError(
                f"a camera's pose is a (3, 3) rotation and a (3,) position, got {turned.shape}, {at.shape}"
            )
        # Small things stand before large ones: drawn first, they save the work of drawing what they hide.
        solid = sorted((s for s in self.surfaces if s.opaque), key=_area)
        clear = [s for s in self.surfaces if not s.opaque]
        clear.sort(key=lambda s: -float(np.linalg.norm(s.origin + 0.5 * (s.u + s.v) - at)))
        return draw_surfaces(solid + clear, camera, turned, at, samples)


def _area(surface: Surface) -> float:
    """Area of a surface, m^2."""
    return float(np.linalg.norm(np.cross(surface.u, surface.v)))


def viewpoint(seed: int) -> tuple[Array, Array]:
    """Choose the pose of a camera at rest in a room.

    Parameters
    ----------
    seed : int
        Decides both; not negative.

    Returns
    -------
    rotation : ndarray of shape (3, 3)
        Turns camera-frame vectors into the room frame: up to 0.3 rad to a side, 0.06 rad up or down.
    position : ndarray of shape (3,)
        Room frame, m: up to half a meter from its origin.
    """
    rng = np.random.default_rng((seed, 0xE7E))
    yaw, pitch = rng.uniform(-0.3, 0.3), rng.uniform(-0.06, 0.06)
    turn = np.array([[np.cos(yaw), 0.0, np.sin(yaw)], [0.0, 1.0, 0.0], [-np.sin(yaw), 0.0, np.cos(yaw)]])
    nod = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(pitch), -np.sin(pitch)], [0.0, np.sin(pitch), np.cos(pitch)]])
    return turn @ nod, rng.uniform((-0.5, -0.3, -0.5), (0.5, 0.3, 0.3))
