"""Flat surfaces for a camera that moves: `FastScene`, the same surfaces as `Scene`, many times faster and less smooth.

One ray a pixel, no interpolation between texels, and a texel either hides what is behind it or does not: an analog
picture shows no more.
"""

import threading
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.sim.rendering.surface import Surface, span

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]
PackedPixels = npt.NDArray[np.uint32]
Depth = npt.NDArray[np.float32]

OPAQUE = np.uint32(0x80000000)  # little-endian: alpha, the last byte, is the highest
NEAR = 0.03  # m, nothing closer is drawn


class Pinhole(NamedTuple):
    """A part of a pinhole camera's picture: pixel (x, y) sees along ((x - cx) / fx, (y - cy) / fy, 1)."""

    fx: float
    fy: float
    cx: float
    cy: float


class FastScene:
    """Surfaces, packed for drawing.

    Parameters
    ----------
    surfaces : list of Surface
        In a frame of their own. The nearer hides the farther, so their order does not matter.
    """

    def __init__(self, surfaces: list[Surface]) -> None:
        self._kept = threading.local()
        # Small things mostly stand before large ones: drawn first, they spare the work of drawing what they hide.
        order = sorted(surfaces, key=lambda each: float(np.linalg.norm(np.cross(each.u, each.v))))
        self._corners = np.array([np.column_stack((each.u, each.v, each.origin)) for each in order])
        shapes = [each.texture.shape[:2] for each in order]
        starts = np.concatenate(([0], np.cumsum([h * w for h, w in shapes])[:-1]))
        self._sizes: Ints = np.column_stack((np.array(shapes), starts)).astype(np.int64)
        texels = [np.ascontiguousarray(each.texture).reshape(-1, 4) for each in order]
        self._texels: PackedPixels = np.concatenate(texels).view(np.uint32)[:, 0].copy()

    def draw(
        self, picture: PackedPixels, window: Pinhole, turn: Floats, place: Floats, columns: Ints | None = None
    ) -> None:
        """Draw what a camera sees over a picture, in place.

        Parameters
        ----------
        picture : ndarray of shape (h, w), uint32
            BGRA in one word, see `packed`; where nothing is it keeps what it shows.
        window : Pinhole
            Where its pixels look.
        turn : ndarray of shape (3, 3)
            Turns vectors of the surfaces' frame into that of the camera.
        place : ndarray of shape (3,)
            Origin of the surfaces' frame in that of the camera, m.
        columns : ndarray of shape (h, 2), int64, optional
            First and last column of each row that is wanted; all by default.
        """
        nearest = self._depth(picture.shape)
        turn = np.ascontiguousarray(turn)
        if columns is None:
            columns = np.zeros((picture.shape[0], 2), np.int64)
            columns[:, 1] = picture.shape[1] - 1
        draw_flat(picture, nearest, self._corners, turn, place, *window, self._sizes, self._texels, columns)

    def _depth(self, shape: tuple[int, ...]) -> Depth:
        """Depth buffer that each thread keeps: fresh pages cost more than drawing on them."""
        kept = self._kept.__dict__
        if kept.get("shape") != shape:
            kept["shape"], kept["depth"] = shape, np.zeros(shape, np.float32)
        depth: Depth = kept["depth"]
        depth[:] = 0.0
        return depth


def packed(picture: Bytes) -> PackedPixels:
    """See a picture of shape (h, w, 4), uint8, BGRA, as one of words, (h, w)."""
    return picture.view(np.uint32)[..., 0]


@kernel
def seen_from(corner: Floats, turn: Floats, place: Floats, m: Floats) -> None:
    """Write sides and origin of a surface as the camera sees them: the columns of m, (3, 3)."""
    for j in range(3):
        for k in range(3):
            total = 0.0
            for i in range(3):
                total += turn[j, i] * corner[i, k]
            m[j, k] = total
        m[j, 2] += place[j]


@kernel
def rows_of(m: Floats, lens: Floats, height: int, width: int) -> tuple[int, int]:
    """First row that may show a surface, and the one after the last; a pixel more on either side than need be."""
    left, right, top, bottom, before = width + 1.0, -2.0, height + 1.0, -2.0, 0
    for corner in range(4):
        s, t = float(corner % 2), float(corner // 2)
        z = m[2, 2] + s * m[2, 0] + t * m[2, 1]
        if z <= 0.0:
            continue
        before += 1
        z = max(z, 1e-9)
        x = lens[2] + lens[0] * (m[0, 2] + s * m[0, 0] + t * m[0, 1]) / z
        y = lens[3] + lens[1] * (m[1, 2] + s * m[1, 0] + t * m[1, 1]) / z
        left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    if before == 0:
        return 0, 0
    if before < 4:  # it reaches behind the camera
        return 0, height
    if right < -1.0 or left > width:
        return 0, 0
    return int(max(top - 1.0, 0.0)), int(min(bottom + 2.0, float(height)))


@kernel
def homography(m: Floats, lens: Floats, h: Floats) -> bool:
    """Write the map from pixels (x, y, 1) to (s, t, 1) / depth of a surface; False if it is seen from its edge.

    With u, v and o the surface's sides and origin seen from the camera, the columns of m, its rows are v x o, o x u and
    u x v over the determinant, times the inverse of the pinhole's matrix.
    """
    rows = np.empty((3, 3))
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        for j in range(3):
            p, q = (j + 1) % 3, (j + 2) % 3
            rows[k, j] = m[p, a] * m[q, b] - m[q, a] * m[p, b]
    det = m[0, 2] * rows[2, 0] + m[1, 2] * rows[2, 1] + m[2, 2] * rows[2, 2]
    if abs(det) < 1e-9:
        return False
    for k in range(3):
        h[k, 0] = rows[k, 0] / (det * lens[0])
        h[k, 1] = rows[k, 1] / (det * lens[1])
        h[k, 2] = (rows[k, 2] - rows[k, 0] * lens[2] / lens[0] - rows[k, 1] * lens[3] / lens[1]) / det
    return True


@kernel
def draw_flat(
    picture: PackedPixels,
    nearest: Depth,
    corners: Floats,
    turn: Floats,
    place: Floats,
    fx: float,
    fy: float,
    cx: float,
    cy: float,
    sizes: Ints,
    texels: PackedPixels,
    columns: Ints,
) -> None:
    """Draw surfaces into a picture and its depth buffer.

    Parameters
    ----------
    picture : (h, w), written
    nearest : (h, w), written
        1/depth of what is drawn already.
    corners : (n, 3, 3)
        Columns: sides u and v, and origin of each surface.
    turn, place : (3, 3), (3,)
        From their frame to the camera's.
    fx, fy, cx, cy : float
        See `Pinhole`.
    sizes : (n, 3)
        Rows and columns of its texture, and where that begins.
    texels : (m,)
        BGRA of all textures.
    columns : (h, 2)
        First and last column of each row that is wanted.
    """
    height, width = picture.shape[0], picture.shape[1]
    h, m, lens = np.empty((3, 3)), np.empty((3, 3)), np.array((fx, fy, cx, cy))
    places, inverse = np.empty(width, np.int32), np.empty(width)
    for k in range(corners.shape[0]):
        seen_from(corners[k], turn, place, m)
        top, bottom = rows_of(m, lens, height, width)
        if top >= bottom or not homography(m, lens, h):
            continue
        tall, wide = np.int32(sizes[k, 0]), np.int32(sizes[k, 1])
        texture = texels[sizes[k, 2] : sizes[k, 2] + sizes[k, 0] * sizes[k, 1]]
        slope_s, slope_t, slope_w = h[0, 0] * wide, h[1, 0] * tall, h[2, 0]
        for y in range(top, bottom):
            first, last = span(h, float(y), width)
            first, last = max(first, columns[y, 0]), min(last, columns[y, 1])
            if first > last:
                continue
            start_s, start_t = (h[0, 1] * y + h[0, 2]) * wide, (h[1, 1] * y + h[1, 2]) * tall
            start_w = h[2, 1] * y + h[2, 2]
            line, depth = picture[y, first : last + 1], nearest[y, first : last + 1]
            for x in range(line.shape[0]):  # several pixels at a time
                at = float(first + x)
                w = slope_w * at + start_w
                unit = 1.0 / w
                i = max(min(np.int32((slope_t * at + start_t) * unit), tall - np.int32(1)), np.int32(0))
                j = max(min(np.int32((slope_s * at + start_s) * unit), wide - np.int32(1)), np.int32(0))
                places[x], inverse[x] = np.int32(i * wide) + j, w
            for x in range(line.shape[0]):
                w = inverse[x]
                if w <= depth[x] or w > 1.0 / NEAR:
                    continue
                texel = texture[np.uint32(places[x])]
                if texel >= OPAQUE:
                    depth[x] = w
                    line[x] = texel
