"""Furniture: `cuboid`, a shaded box made of surfaces."""

import math

import numpy as np
import numpy.typing as npt

from matchset.sim.rendering.surface import Surface
from matchset.sim.scene.textures import Picture, texture

Array = npt.NDArray[np.float64]
_TO_LIGHT = np.array([-0.48, -0.72, -0.5])


def shade(normal: Array) -> float:
    """Brightness of a face under the room's soft light, 0.45 ... 1.1, from its unit normal."""
    return 0.58 + 0.52 * max(float(normal @ _TO_LIGHT), -0.25)


def cuboid(
    center: tuple[float, float, float],
    size: tuple[float, float, float],
    turn: float,
    skin: Picture,
    front: Picture | None = None,
) -> list[Surface]:
    """Build a box that stands upright.

    Parameters
    ----------
    center : tuple of 3 floats
        Middle of its bottom, room frame (y down), m.
    size : tuple of 3 floats
        Width, height and depth, m.
    turn : float
        Rotation about the vertical axis, rad.
    skin : ndarray of shape (h, w, 3), float32
        Picture on all faces.
    front : ndarray of shape (h, w, 3), float32, optional
        Another picture on the face toward -z.

    Returns
    -------
    list of Surface
        Front, back, left, right, top.
    """
    right = np.array([math.cos(turn), 0.0, math.sin(turn)])
    deep = np.array([-math.sin(turn), 0.0, math.cos(turn)])
    down = np.array([0.0, 1.0, 0.0])
    half_x, height, half_z = 0.5 * size[0], size[1], 0.5 * size[2]
    top = np.array(center) - height * down
    faces: list[Surface] = []
    for normal, along, reach, half in (
        (-deep, right, half_z, half_x),
        (deep, -right, half_z, half_x),
        (-right, -deep, half_x, half_z),
        (right, deep, half_x, half_z),
    ):
        picture = front if front is not None and not faces else skin
        fade = np.linspace(1.04, 0.86, picture.shape[0], dtype=np.float32)[:, None, None]
        faces.append(
            Surface(
                origin=top + reach * normal - half * along,
                u=2.0 * half * along,
                v=height * down,
                texture=texture(picture * (fade * np.float32(shade(normal)))),
            )
        )
    lid = texture(skin * np.float32(shade(-down)))
    faces.append(
        Surface(origin=top - half_x * right + half_z * deep, u=size[0] * right, v=-size[2] * deep, texture=lid)
    )
    return faces
