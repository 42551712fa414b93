"""What a room is made of: `Surface`, a flat picture in space, and the ray-caster that draws many of them."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.numeric.jit import kernel

Array = npt.NDArray[np.float64]
Picture = npt.NDArray[np.float32]
Texture = npt.NDArray[np.uint8]


class Surface(msgspec.Struct, frozen=True, kw_only=True):
    """A parallelogram with a picture on it: the points origin + s u + t v with 0 <= s, t <= 1.

    Parameters
    ----------
    origin : ndarray of shape (3,)
        Where the upper left corner of the picture is, room frame, m.
    u, v : ndarray of shape (3,)
        Along the picture's upper edge and down its left edge, m.
    texture : ndarray of shape (h, w, 4), uint8
        BGRA; A is opacity.
    """

    origin: Array
    u: Array
    v: Array
    texture: Texture

    @property
    def opaque(self) -> bool:
        """Nothing can be seen through it."""
        return bool(self.texture[..., 3].min() == 255)


def draw_surfaces(
    surfaces: list[Surface], camera: CameraModel, rotation: Array, position: Array, samples: int
) -> Picture:
    """Draw surfaces as a camera sees them; the nearer hides the farther.

    With M = (u, v, origin - position), a ray d of the room meets a surface where (s, t, 1) ~ M^-1 d, at
    1/depth = the third component: the surface's picture is a homography, drawn row by row.

    Parameters
    ----------
    surfaces : list of Surface
        In any order, but the ones that are not opaque last, from far to near.
    camera : CameraModel
        The camera.
    rotation : ndarray of shape (3, 3)
        Turns camera-frame vectors into the room frame.
    position : ndarray of shape (3,)
        Where the camera is in the room frame, m.
    samples : int
        Rays per pixel along x and along y.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; black where nothing is.
    """
    lens = np.array(
        [
            [1.0 / camera.fx, 0.0, -camera.cx / camera.fx],
            [0.0, 1.0 / camera.fy, -camera.cy / camera.fy],
            [0, 0, 1.0],
        ]
    )
    total = np.zeros((camera.height, camera.width, 3), np.float32)
    for i in range(samples * samples):
        across, down = (i % samples + 0.5) / samples - 0.5, (i // samples + 0.5) / samples - 0.5
        shift = np.array([[1.0, 0.0, across], [0.0, 1.0, down], [0.0, 0.0, 1.0]])
        rays = rotation @ lens @ shift
        picture = total if samples == 1 else np.zeros_like(total)
        nearest = np.zeros((camera.height, camera.width), np.float32)
        for surface in surfaces:
            corner = np.column_stack((surface.u, surface.v, surface.origin - position))
            if abs(np.linalg.det(corner)) > 1e-9:
                _draw_surface(picture, nearest, np.linalg.solve(corner, rays), surface.texture)
        if samples > 1:
            total += picture * np.float32(1.0 / samples**2)
    return total


@kernel
def span(h: Array, y: float, width: int) -> tuple[int, int]:
    """First and last x of a row with w > 0, 0 <= s <= w, 0 <= t <= w, where (s, t, w) = h (x, y, 1)."""
    low, high = 0.0, width - 1.0
    for i in range(5):
        row = min(i // 2, 2)
        slope, value = h[row, 0], h[row, 1] * y + h[row, 2]
        if i == 1 or i == 3:
            slope, value = h[2, 0] - slope, h[2, 1] * y + h[2, 2] - value
        if slope > 0.0:
            low = max(low, -value / slope)
        elif slope < 0.0:
            high = min(high, -value / slope)
        elif value <= 0.0:
            high = -1.0
    return math.ceil(min(low, float(width))), math.floor(max(high, -1.0))  # within what an integer holds


@kernel
def _draw_surface(picture: Picture, nearest: Picture, h: Array, texture: Texture) -> None:
    """Draw one surface, bilinear, where it is nearer than what `nearest` (1/depth) holds."""
    rows, columns = texture.shape[0], texture.shape[1]
    one, opacity = np.float32(1.0), np.float32(1.0 / 255.0)
    for y in range(picture.shape[0]):
        first, last = span(h, float(y), picture.shape[1])
        for x in range(first, last + 1):
            w = h[2, 0] * x + h[2, 1] * y + h[2, 2]
            if w <= nearest[y, x]:
                continue
            s = min(max((h[0, 0] * x + h[0, 1] * y + h[0, 2]) / w * columns - 0.5, 0.0), columns - 1.0)
            t = min(max((h[1, 0] * x + h[1, 1] * y + h[1, 2]) / w * rows - 0.5, 0.0), rows - 1.0)
            i, j = int(t), int(s)
            below, right = min(i + 1, rows - 1), min(j + 1, columns - 1)
            p, q = np.float32(s - j), np.float32(t - i)
            a, b = (one - p) * (one - q), p * (one - q)
            c, d = (one - p) * q, p * q
            alpha = opacity * (
                a * texture[i, j, 3]
                + b * texture[i, right, 3]
                + c * texture[below, j, 3]
                + d * texture[below, right, 3]
            )
            if alpha >= one - np.float32(1e-4):
                nearest[y, x] = w
            for k in range(3):
                color = (
                    a * texture[i, j, k]
                    + b * texture[i, right, k]
                    + c * texture[below, j, k]
                    + d * texture[below, right, k]
                )
                picture[y, x, k] += alpha * (color - picture[y, x, k])
