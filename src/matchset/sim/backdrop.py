"""A room behind a camera that moves: `Backdrop`, the same surfaces as `Scene`, several times faster and less smooth.

One ray a pixel, no interpolation between texels, and a texel either hides what is behind it or does not: an analog
picture shows no more.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.camera_model import CameraModel
from matchset.shapes.jit import kernel
from matchset.sim.renderer import ALL_ROWS, Picture, Rows
from matchset.sim.surface import Surface

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Texels = npt.NDArray[np.uint8]

NEAR = 0.03  # m, nothing closer is drawn


class Backdrop:
    """Surfaces, packed for drawing.

    Parameters
    ----------
    surfaces : list of Surface
        In the room frame. The nearer hides the farther, so their order does not matter.
    """

    def __init__(self, surfaces: list[Surface]) -> None:
        # Small things mostly stand before large ones: drawn first, they spare the work of drawing what they hide.
        order = sorted(surfaces, key=lambda each: float(np.linalg.norm(np.cross(each.u, each.v))))
        self._corners = np.array([np.column_stack((each.u, each.v, each.origin)) for each in order])
        shapes = [each.texture.shape[:2] for each in order]
        starts = np.concatenate(([0], np.cumsum([h * w for h, w in shapes])[:-1]))
        self._sizes: Ints = np.column_stack((np.array(shapes), starts)).astype(np.int64)
        self._texels = np.concatenate([each.texture.reshape(-1, 4) for each in order])

    def draw(
        self, picture: Picture, camera: CameraModel, rotation: Floats, position: Floats, rows: Rows = ALL_ROWS
    ) -> None:
        """Draw what a camera sees over a picture, in place.

        Parameters
        ----------
        picture : ndarray of shape (h, w, 3), float32
            BGR, 0 ... 255; rows where nothing is keep what they show.
        camera : CameraModel
            A pinhole of the picture's size.
        rotation : ndarray of shape (3, 3)
            Turns camera-frame vectors into the room frame.
        position : ndarray of shape (3,)
            The camera in the room, m.
        rows : Rows
            Which rows to draw.
        """
        corners = self._corners.copy()
        corners[:, :, 2] -= position
        seen = np.abs(np.linalg.det(corners)) > 1e-9
        lens = np.array(
            ((1 / camera.fx, 0.0, -camera.cx / camera.fx), (0.0, 1 / camera.fy, -camera.cy / camera.fy), (0, 0, 1.0))
        )
        maps = np.linalg.solve(corners[seen], np.broadcast_to(rotation @ lens, (int(seen.sum()), 3, 3)))
        nearest = np.zeros(picture.shape[:2], np.float32)
        draw_flat(picture, nearest, np.ascontiguousarray(maps), self._sizes[seen], self._texels, rows.start, rows.step)


@kernel
def draw_flat(
    picture: Picture, nearest: Picture, maps: Floats, sizes: Ints, texels: Texels, start: int, step: int
) -> None:
    """Draw surfaces into a picture and its depth buffer.

    Parameters
    ----------
    picture : (h, w, 3), written
    nearest : (h, w), written
        1/depth of what is drawn already.
    maps : (n, 3, 3)
        From pixels (x, y, 1) to (s, t, 1) / depth of each surface.
    sizes : (n, 3)
        Rows and columns of its texture, and where that begins.
    texels : (m, 4)
        BGRA of all textures.
    start, step : int
        Rows start, start + step, ... are drawn.
    """
    width = picture.shape[1]
    for k in range(maps.shape[0]):
        h = maps[k]
        tall, wide, first_texel = sizes[k, 0], sizes[k, 1], sizes[k, 2]
        for y in range(start, picture.shape[0], step):
            s0, t0, w0 = h[0, 1] * y + h[0, 2], h[1, 1] * y + h[1, 2], h[2, 1] * y + h[2, 2]
            low, high = 0.0, width - 1.0
            for i in range(5):  # s >= 0, t >= 0, w >= 0, s <= w, t <= w
                if i == 0:
                    slope, value = h[0, 0], s0
                elif i == 1:
                    slope, value = h[1, 0], t0
                elif i == 2:
                    slope, value = h[2, 0], w0
                elif i == 3:
                    slope, value = h[2, 0] - h[0, 0], w0 - s0
                else:
                    slope, value = h[2, 0] - h[1, 0], w0 - t0
                if slope > 0.0:
                    low = max(low, -value / slope)
                elif slope < 0.0:
                    high = min(high, -value / slope)
                elif value <= 0.0:
                    high = -1.0
            for x in range(math.ceil(low), math.floor(max(high, -1.0)) + 1):
                w = h[2, 0] * x + w0
                if w <= nearest[y, x] or w > 1.0 / NEAR:
                    continue
                unit = 1.0 / w
                i = min(max(int((h[1, 0] * x + t0) * unit * tall), 0), tall - 1)
                j = min(max(int((h[0, 0] * x + s0) * unit * wide), 0), wide - 1)
                texel = first_texel + i * wide + j
                if texels[texel, 3] >= 128:
                    nearest[y, x] = w
                    picture[y, x, 0] = texels[texel, 0]
                    picture[y, x, 1] = texels[texel, 1]
                    picture[y, x, 2] = texels[texel, 2]
