"""The room as a moving camera sees it: `FastScene`, the fast one of two renderers; `Scene` is the exact one.

One ray a pixel, no interpolation between texels, and a texel either hides what is behind it or does not: an analog
picture shows no more.
"""

import threading
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.sim.rendering.coverage import PackedPixels, Pinhole
from matchset.sim.rendering.surface import Surface, span

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]
Depth = npt.NDArray[np.float32]

# format: least word of a pixel with an opacity of 128: little-endian, opacity is the highest byte
OPAQUE = np.uint32(0x80000000)
NEAR = 0.03  # geometry: m, nothing nearer to the camera is drawn


class PackedSurfaces(NamedTuple):
    """Surfaces in three arrays.

    Parameters
    ----------
    corners : (n, 3, 3)
        Columns: sides u and v, and origin of each surface.
    sizes : (n, 3)
        Rows and columns of its texture, and where that begins.
    texels : (m,)
        BGRA of all textures.
    """

    corners: Floats
    sizes: Ints
    texels: PackedPixels


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
        corners = np.array([np.column_stack((each.u, each.v, each.origin)) for each in order])
        shapes = [each.texture.shape[:2] for each in order]
        starts = np.concatenate(([0], np.cumsum([h * w for h, w in shapes])[:-1]))
        sizes: Ints = np.column_stack((np.array(shapes), starts)).astype(np.int64)
        texels = [np.ascontiguousarray(each.texture).reshape(-1, 4) for each in order]
        packed_texels: PackedPixels = np.concatenate(texels).view(np.uint32)[:, 0].copy()
        self._surfaces = PackedSurfaces(corners, sizes, packed_texels)

    def draw(
        self,
        picture: PackedPixels,
        pinhole: Pinhole,
        rotation: Floats,
        translation: Floats,
        columns: Ints | None = None,
        nearest: Depth | None = None,
    ) -> Depth:
        """Draw what a camera sees over a picture, in place.

        Parameters
        ----------
        picture : ndarray of shape (h, w), uint32
            BGRA in one word, see `packed`; where nothing is it keeps what it shows.
        pinhole : Pinhole
            Where its pixels look.
        rotation : ndarray of shape (3, 3)
            Turns vectors of the surfaces' frame into that of the camera.
        translation : ndarray of shape (3,)
            Origin of the surfaces' frame in that of the camera, m.
        columns : ndarray of shape (h, 2), int64, optional
            First and last column of each row that is wanted; all by default.
        nearest : ndarray of shape (h, w), float32, optional
            1/depth of what the picture shows already, changed; nothing by default.

        Returns
        -------
        ndarray of shape (h, w), float32
            1/depth of what it shows now; valid until the next picture of this thread.
        """
        nearest = self._depth(picture.shape) if nearest is None else nearest
        pose = np.ascontiguousarray(rotation), translation
        if columns is None:
            columns = np.zeros((picture.shape[0], 2), np.int64)
            columns[:, 1] = picture.shape[1] - 1
        draw_surfaces_fast(picture, nearest, self._surfaces, pose, pinhole, columns)
        return nearest

    def _depth(self, shape: tuple[int, ...]) -> Depth:
        """Depth buffer that each thread keeps: fresh pages cost more than drawing on them."""
        kept = self._kept.__dict__
        if kept.get("shape") != shape:
            kept["shape"], kept["depth"] = shape, np.zeros(shape, np.float32)
        depth: Depth = kept["depth"]
        depth[:] = 0.0
        return depth


def packed(picture: Bytes) -> PackedPixels:
    """View a picture of shape (h, w, 4), uint8, BGRA, as packed pixels, (h, w)."""
    return picture.view(np.uint32)[..., 0]


@kernel
def _to_camera(corner: Floats, pose: tuple[Floats, Floats], m: Floats) -> None:
    """Write sides and origin of a surface in the camera's frame: the columns of m, (3, 3)."""
    rotation, translation = pose
    for j in range(3):
        for k in range(3):
            total = 0.0
            for i in range(3):
                total += rotation[j, i] * corner[i, k]
            m[j, k] = total
        m[j, 2] += translation[j]


@kernel
def _rows_of(m: Floats, lens: Pinhole, height: int, width: int) -> tuple[int, int]:
    """First row that may show a surface, and the one after the last; a pixel more on either side than need be."""
    left, right, top, bottom, before = width + 1.0, -2.0, height + 1.0, -2.0, 0
    for corner in range(4):
        s, t = float(corner % 2), float(corner // 2)
        z = m[2, 2] + s * m[2, 0] + t * m[2, 1]
        if z <= 0.0:
            continue
        before += 1
        z = max(z, 1e-9)
        x = lens.cx + lens.fx * (m[0, 2] + s * m[0, 0] + t * m[0, 1]) / z
        y = lens.cy + lens.fy * (m[1, 2] + s * m[1, 0] + t * m[1, 1]) / z
        left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    if before == 0:
        return 0, 0
    if before < 4:  # it reaches behind the camera
        return 0, height
    if right < -1.0 or left > width:
        return 0, 0
    return int(max(top - 1.0, 0.0)), int(min(bottom + 2.0, float(height)))


@kernel
def _homography(m: Floats, lens: Pinhole, h: Floats) -> bool:
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
        h[k, 0] = rows[k, 0] / (det * lens.fx)
        h[k, 1] = rows[k, 1] / (det * lens.fy)
        h[k, 2] = (rows[k, 2] - rows[k, 0] * lens.cx / lens.fx - rows[k, 1] * lens.cy / lens.fy) / det
    return True


@kernel
def draw_surfaces_fast(
    picture: PackedPixels,
    nearest: Depth,
    surfaces: PackedSurfaces,
    pose: tuple[Floats, Floats],
    lens: Pinhole,
    columns: Ints,
) -> None:
    """Draw surfaces into a picture and its depth buffer.

    Parameters
    ----------
    picture : (h, w), written
    nearest : (h, w), written
        1/depth of what is drawn already.
    surfaces : PackedSurfaces
    pose : (3, 3), (3,)
        Rotation and translation from their frame to the camera's.
    lens : Pinhole
    columns : (h, 2)
        First and last column of each row that is wanted.
    """
    height, width, corners, sizes = picture.shape[0], picture.shape[1], surfaces.corners, surfaces.sizes
    h, m = np.empty((3, 3)), np.empty((3, 3))
    places, inverse, shown = np.empty(width, np.int32), np.empty(width), np.empty(width, np.uint32)
    for k in range(corners.shape[0]):
        _to_camera(corners[k], pose, m)
        top, bottom = _rows_of(m, lens, height, width)
        if top >= bottom or not _homography(m, lens, h):
            continue
        tall, wide = np.int32(sizes[k, 0]), np.int32(sizes[k, 1])
        texels = surfaces.texels[sizes[k, 2] : sizes[k, 2] + sizes[k, 0] * sizes[k, 1]]
        for y in range(top, bottom):
            first, last = span(h, float(y), width)
            first, last = max(first, columns[y, 0]), min(last, columns[y, 1])
            if first > last:
                continue
            where, seen = places[: last + 1 - first], shown[: last + 1 - first]
            _find_texels(h, (first, y), (tall, wide), where, inverse)
            _fetch(texels, where, seen)
            _show(seen, inverse, picture[y, first : last + 1], nearest[y, first : last + 1])


@kernel(refcount=False)
def _find_texels(
    h: Floats, start: tuple[int, int], size: tuple[np.int32, np.int32], places: npt.NDArray[np.int32], inverse: Floats
) -> None:
    """Write which texel each pixel of a row shows, counted through, and 1/depth there; several pixels at a time.

    `start` is the first pixel, (x, y); `size` are rows and columns of the texture.
    """
    first, y = start
    tall, wide = size
    slope_s, slope_t, slope_w = h[0, 0] * wide, h[1, 0] * tall, h[2, 0]
    start_s, start_t = (h[0, 1] * y + h[0, 2]) * wide, (h[1, 1] * y + h[1, 2]) * tall
    start_w = h[2, 1] * y + h[2, 2]
    for x in range(places.shape[0]):
        at = float(first + x)
        w = slope_w * at + start_w
        unit = 1.0 / w
        i = max(min(np.int32((slope_t * at + start_t) * unit), tall - np.int32(1)), np.int32(0))
        j = max(min(np.int32((slope_s * at + start_s) * unit), wide - np.int32(1)), np.int32(0))
        places[x], inverse[x] = np.int32(i * wide) + j, w


@kernel(refcount=False)
def _fetch(texels: PackedPixels, places: npt.NDArray[np.int32], shown: PackedPixels) -> None:
    """Write the texels at places; alone in its loop, so that many are fetched at the same time."""
    for x in range(places.shape[0]):
        shown[x] = texels[np.uint32(places[x])]


@kernel(refcount=False)
def _show(shown: PackedPixels, inverse: Floats, line: PackedPixels, depth: Depth) -> None:
    """Draw a row of texels with their 1/depth where they are opaque and nearer than what is drawn."""
    farthest = 1.0 / NEAR
    for x in range(shown.shape[0]):
        w, texel, before, under = inverse[x], shown[x], depth[x], line[x]
        nearer = (w > before) & (w <= farthest) & (texel >= OPAQUE)
        depth[x] = np.float32(w) if nearer else before
        line[x] = texel if nearer else under
