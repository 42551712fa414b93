"""A ball with a pattern, or with a shadow on the side away from the light: `draw_painted_ball`.

A pixel of a ball is affine in the ball's color. So a pattern needs no drawing of its own: it mixes pictures of the ball
in either color, and a shadow mixes in a ball without any color, which shows its highlights only.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from matchset.sim.clips.balloon import Balloon
from matchset.sim.rendering.coverage import Pinhole
from matchset.sim.rendering.patterns import pattern_share
from matchset.sim.rendering.renderer import Array, Light, Picture, draw_at
from matchset.sim.rendering.shutter import ALL_ROWS, ShutterRows

BLACK = (0.0, 0.0, 0.0)  # format: BGR


class PaintParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a ball turns, and where its shadow is.

    Parameters
    ----------
    axis : tuple of 3 floats
        The axis about which its pattern turns, camera frame; any length.
    tilt : tuple of 3 floats
        Rotation vector of the pattern at rest, rad: so that no seam is straight in the picture.
    shadow : tuple of 3 floats
        Where the shadow is deepest: direction from the center of the ball, camera frame; any length. It is below, for
        light comes from above.
    border : tuple of 2 floats
        Cosines of the angles to that direction at which the shadow begins and is full. Chosen by hand: its border
        crosses the lower half, and is as soft as that of a lamp's.
    """

    axis: tuple[float, float, float] = (0.3, 1.0, 0.2)
    tilt: tuple[float, float, float] = (0.5, 0.3, 0.4)
    shadow: tuple[float, float, float] = (0.35, 0.9, -0.1)
    border: tuple[float, float] = (-0.15, 0.45)


PAINT = PaintParameters()


def draw_painted_ball(
    picture: Picture,
    window: Pinhole,
    balloon: Balloon,
    positions: Array,
    turn: float,
    look: tuple[Light, ShutterRows] = (Light(), ALL_ROWS),
) -> None:
    """Draw a ball with its pattern and its shadow over a picture, in place; without either as `draw_balloon`.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    window : Pinhole
        Where its pixels look.
    balloon : Balloon
    positions : ndarray of shape (n, 3)
        Centers in the camera frame, m, in each sub-exposure. The pattern is that at the middle one.
    turn : float
        By how much the pattern has turned, rad.
    look : (Light, Rows)
        Where light comes from, and which rows to draw.
    """
    light, rows = look
    if balloon.pattern == "plain" and light.shadow <= 0.0:
        draw_at(picture, window, balloon, positions, light, rows)
        return
    left, right, top, bottom = _box(picture.shape, window, balloon, positions)
    if left >= right or top >= bottom:
        return
    window = Pinhole(window.fx, window.fy, window.cx - left, window.cy - top)
    own = ShutterRows((rows.start - top) % rows.step, rows.step)
    part = picture[top:bottom, left:right]

    def drawn(color: tuple[float, float, float] | None) -> Picture:
        one = balloon
        if color is not None:
            one = msgspec.structs.replace(balloon, color=color, marker_color=color)
        copy = part.copy()
        draw_at(copy, window, one, positions, light, own)
        return copy

    normals = _normals(window, part.shape[:2], positions[len(positions) // 2], balloon.radius)
    if balloon.pattern == "plain":
        lit = drawn(None)
    else:
        moved = float(np.abs(positions[-1] - positions[0])[:2].sum()) / balloon.radius
        soft = float(positions[0, 2]) / (window.fx * balloon.radius) + moved
        turned = Rotation.from_rotvec(np.array(PAINT.tilt)) * Rotation.from_rotvec(turn * _unit(PAINT.axis))
        share = pattern_share(balloon.pattern, _rotated(turned, normals), soft)[..., None].astype(np.float32)
        lit = drawn(balloon.color)
        lit += share * (drawn(balloon.pattern_color) - lit)
    if light.shadow > 0.0:
        dark = drawn(BLACK)
        lit = dark + _light_share(normals, light.shadow)[..., None] * (lit - dark)
    part[...] = lit


def _box(shape: tuple[int, ...], lens: Pinhole, balloon: Balloon, positions: Array) -> tuple[int, int, int, int]:
    """Left, right, top and bottom of a part of the picture that holds a ball in all its sub-exposures."""
    near, far = positions[:, 2] - balloon.radius, positions[:, 2] + balloon.radius
    sides = []
    for axis, f, c, size in ((0, lens.fx, lens.cx, shape[1]), (1, lens.fy, lens.cy, shape[0])):
        ends = [(positions[:, axis] + s * balloon.radius) / z for s in (-1.0, 1.0) for z in (near, far)]
        sides += [max(math.floor(c + f * np.min(ends)) - 1, 0), min(math.ceil(c + f * np.max(ends)) + 2, size)]
    return sides[0], sides[1], sides[2], sides[3]


def _normals(window: Pinhole, shape: tuple[int, ...], center: Array, radius: float) -> Array:
    """Outward unit normals of a sphere, (h, w, 3), where the rays of a window meet it or pass it."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    u, v = (columns - window.cx) / window.fx, (rows - window.cy) / window.fy
    rays = np.stack((u, v, np.ones_like(u)), axis=-1)
    square, along = (rays * rays).sum(axis=-1), rays @ center
    depth = np.sqrt(np.maximum(along**2 - square * (center @ center - radius**2), 0.0))
    off: Array = ((along - depth) / square)[..., None] * rays - center
    found: Array = off / np.linalg.norm(off, axis=-1, keepdims=True)
    return found


def _light_share(normals: Array, shadow: float) -> npt.NDArray[np.float32]:
    """Share of the light that is left at each normal."""
    low, high = PAINT.border
    share = np.clip((normals @ _unit(PAINT.shadow) - low) / (high - low), 0.0, 1.0)
    return (1.0 - shadow * share * share * (3.0 - 2.0 * share)).astype(np.float32)


def _unit(vector: tuple[float, float, float]) -> Array:
    return np.array(vector) / math.hypot(*vector)


def _rotated(rotation: Rotation, vectors: Array) -> Array:
    """Turn vectors (..., 3)."""
    found: Array = vectors @ rotation.as_matrix().T
    return found
