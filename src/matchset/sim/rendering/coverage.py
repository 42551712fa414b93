"""The kernels that draw a sphere and a bar: a pixel is blended by its area inside the outline."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.sim.rendering.shutter import ALL_ROWS, Rows

Picture = npt.NDArray[np.float32]
Array = npt.NDArray[np.float64]
Words = npt.NDArray[np.uint32]


@kernel
def _half_plane(distance: float, nx: float, ny: float) -> float:
    """Area of a unit square on the inner side of a line: `distance` px inside, unit normal (nx, ny)."""
    p, q = max(abs(nx), abs(ny)), min(abs(nx), abs(ny))
    t = abs(distance)
    if t >= 0.5 * (p + q):
        area = 1.0
    elif t <= 0.5 * (p - q):
        area = 0.5 + t / p
    else:
        area = 1.0 - (0.5 * (p + q) - t) ** 2 / (2.0 * p * q)
    return area if distance >= 0.0 else 1.0 - area


@kernel
def _sphere_coverage(u: float, v: float, lens: Array, spheres: Array, i: int) -> float:
    """Share of the pixel with ray d = (u, v, 1) inside the outline of a sphere with center c.

    With theta the angle between ray and center, tan(theta) = |d x c| / d.c is linear in px on the axis; the
    signed distance to the outline is (tan(alpha) - tan(theta)) / |gradient|, where sin(alpha) = radius /
    |c|.
    """
    x, y, z, cc, tangent_sq = spheres[i, 0], spheres[i, 1], spheres[i, 2], spheres[i, 3], spheres[i, 4]
    dd = u * u + v * v + 1.0
    dc = u * x + v * y + z
    excess = dc * dc - dd * tangent_sq
    band = spheres[i, 5] * dd
    if excess > band:
        return 1.0
    if excess < -band or dc <= 0.0:
        return 0.0
    cross = math.sqrt(max(dd * cc - dc * dc, 1e-300))
    gx = ((cc * u - dc * x) / (cross * dc) - cross * x / (dc * dc)) / lens[0]
    gy = ((cc * v - dc * y) / (cross * dc) - cross * y / (dc * dc)) / lens[1]
    slope = math.sqrt(gx * gx + gy * gy)
    return _half_plane((spheres[i, 6] - cross / dc) / slope, gx / slope, gy / slope)


@kernel
def _shade(
    u: float, v: float, sphere: Array, radius: float, soften: float, look: Array, more: Array
) -> tuple[float, float, float]:
    """Color of the sphere where the ray (u, v, 1) meets it, or of its outline next to the ray.

    `more` holds the directions to all markers but the first; `soften` is the width of a marker's border, rad
    as seen from the center of the sphere. The directions to the eye and half way to the light are those at
    the center of the sphere.
    """
    dd = u * u + v * v + 1.0
    dc = u * sphere[0] + v * sphere[1] + sphere[2]
    depth = math.sqrt(max(dc * dc - dd * sphere[4], 0.0))
    t = (dc - depth) / dd
    unit = 1.0 / radius
    nx, ny, nz = (t * u - sphere[0]) * unit, (t * v - sphere[1]) * unit, (t - sphere[2]) * unit
    soft = max((nx * look[10] + ny * look[11] + nz * look[12] + 0.45) * (1.0 / 1.45), 0.0)
    diffuse = look[13] - 0.10 * ny + 0.75 * soft * soft
    rim = 1.0 - depth * look[19] * unit
    shine = 26.0 * rim * rim * rim
    glint = nx * look[16] + ny * look[17] + nz * look[18]
    if glint > 0.0:
        glint = glint * glint
        glint = glint * glint * glint * glint
        shine += 0.16 * look[14] * glint
        glint = glint * glint * glint * glint
        shine += look[14] * glint * glint * glint * glint
    marker = 0.0
    cosine = nx * look[6] + ny * look[7] + nz * look[8]
    if look[9] > 0.0 and cosine > look[15]:
        marker = min(max((look[9] - math.acos(min(cosine, 1.0))) / soften + 0.5, 0.0), 1.0)
    for k in range(more.shape[0]):
        cosine = nx * more[k, 0] + ny * more[k, 1] + nz * more[k, 2]
        if look[9] > 0.0 and cosine > look[15]:
            marker = max(marker, min(max((look[9] - math.acos(min(cosine, 1.0))) / soften + 0.5, 0.0), 1.0))
    return (
        min((look[0] + marker * (look[3] - look[0])) * diffuse + shine, 255.0),
        min((look[1] + marker * (look[4] - look[1])) * diffuse + shine, 255.0),
        min((look[2] + marker * (look[5] - look[2])) * diffuse + shine, 255.0),
    )


@kernel
def _sphere_box(
    lens: Array, centers: Array, radius: float, shape: Array, start: int, step: int
) -> npt.NDArray[np.int64]:
    """Rows and columns (left, right, top, bottom) that may hold a part of any sub-exposure of a sphere."""
    left, right, top, bottom = shape[1], -1.0, shape[0], -1.0
    for i in range(centers.shape[0]):
        x, y, z = centers[i, 0], centers[i, 1], centers[i, 2]
        # A point of the sphere has x +- R and z +- R: the quotients of the extremes bound its projection.
        left = min(left, lens[2] + lens[0] * min((x - radius) / (z - radius), (x - radius) / (z + radius)))
        right = max(right, lens[2] + lens[0] * max((x + radius) / (z - radius), (x + radius) / (z + radius)))
        top = min(top, lens[3] + lens[1] * min((y - radius) / (z - radius), (y - radius) / (z + radius)))
        bottom = max(bottom, lens[3] + lens[1] * max((y + radius) / (z - radius), (y + radius) / (z + radius)))
    box = np.empty(4, np.int64)
    box[0], box[1] = int(max(left - 1.0, 0.0)), int(min(right + 2.0, shape[1] - 1.0))
    box[2], box[3] = int(max(top - 1.0, 0.0)), int(min(bottom + 2.0, shape[0] - 1.0))
    box[2] += (start - box[2]) % step
    return box


@kernel
def draw_sphere(
    picture: Picture, lens: Array, spheres: Array, radius: float, look: Array, more: Array, start: int, step: int
) -> None:
    """Blend a sphere, its coverage averaged over the sub-exposures, over some rows of a picture."""
    n = spheres.shape[0]
    middle = 0.5 * (spheres[(n - 1) // 2] + spheres[n // 2])
    moved = (abs(spheres[n - 1, 0] - spheres[0, 0]) + abs(spheres[n - 1, 1] - spheres[0, 1])) / radius
    soften = middle[2] / (lens[0] * radius) + moved
    shape = np.array([float(picture.shape[0]), float(picture.shape[1])])
    box = _sphere_box(lens, spheres, radius, shape, start, step)
    per_pixel, share = 1.0 / lens[0], 1.0 / n
    for y in range(box[2], box[3] + 1, step):
        v = (y - lens[3]) / lens[1]
        for x in range(box[0], box[1] + 1):
            u = (x - lens[2]) * per_pixel
            alpha = 0.0
            for i in range(n):
                alpha += _sphere_coverage(u, v, lens, spheres, i)
            if alpha > 0.0:
                alpha *= share
                blue, green, red = _shade(u, v, middle, radius, soften, look, more)
                picture[y, x, 0] += alpha * (blue - picture[y, x, 0])
                picture[y, x, 1] += alpha * (green - picture[y, x, 1])
                picture[y, x, 2] += alpha * (red - picture[y, x, 2])


@kernel
def draw_sphere_on_words(picture: Words, lens: Array, center: Array, radius: float, look: Array) -> None:
    """Blend a sphere that does not move over a picture of words, B in the lowest byte, as `draw_sphere` would."""
    spheres, none = np.empty((1, 7)), np.empty((0, 3))
    square = center[0] ** 2 + center[1] ** 2 + center[2] ** 2
    tangent_sq = square - radius**2
    spheres[0, 0], spheres[0, 1], spheres[0, 2], spheres[0, 3] = center[0], center[1], center[2], square
    spheres[0, 4], spheres[0, 5] = tangent_sq, 4.0 * radius * math.sqrt(tangent_sq) / min(lens[0], lens[1])
    spheres[0, 6] = radius / math.sqrt(tangent_sq)
    soften = center[2] / (lens[0] * radius)
    shape = np.array([float(picture.shape[0]), float(picture.shape[1])])
    box = _sphere_box(lens, spheres, radius, shape, 0, 1)
    per_pixel, half, byte = 1.0 / lens[0], np.float32(0.5), np.uint32(255)
    for y in range(box[2], box[3] + 1):
        v = (y - lens[3]) / lens[1]
        for x in range(box[0], box[1] + 1):
            u = (x - lens[2]) * per_pixel
            alpha = _sphere_coverage(u, v, lens, spheres, 0)
            if alpha > 0.0:
                color = _shade(u, v, spheres[0], radius, soften, look, none)
                word, new = picture[y, x], np.uint32(0)
                for k in range(3):
                    shift = np.uint32(8 * k)
                    under = np.float32((word >> shift) & byte)
                    over = np.float32(under + alpha * (color[k] - under))
                    new |= np.uint32(np.uint32(np.int32(over + half)) << shift)
                picture[y, x] = new | (word & np.uint32(0xFF000000))


@kernel
def draw_bars(picture: Picture, places: Array, color: Array, start: int, step: int) -> None:
    """Blend the mean of the sub-exposures of an oriented rectangle, shaded like a stick, over some rows."""
    height, width = picture.shape[0], picture.shape[1]
    left, right, top, bottom = float(width), -1.0, float(height), -1.0
    for i in range(places.shape[0]):
        c, s = abs(places[i, 4]), abs(places[i, 5])
        half_x, half_y = places[i, 2] * c + places[i, 3] * s, places[i, 2] * s + places[i, 3] * c
        left, right = min(left, places[i, 0] - half_x), max(right, places[i, 0] + half_x)
        top, bottom = min(top, places[i, 1] - half_y), max(bottom, places[i, 1] + half_y)
    x0, x1 = int(max(left - 1.0, 0.0)), int(min(right + 2.0, width - 1.0))
    y0, y1 = int(max(top - 1.0, 0.0)), int(min(bottom + 2.0, height - 1.0))
    y0 += (start - y0) % step
    for y in range(y0, y1 + 1, step):
        for x in range(x0, x1 + 1):
            alpha, shade = 0.0, 0.0
            for i in range(places.shape[0]):
                c, s = places[i, 4], places[i, 5]
                along = c * (x - places[i, 0]) + s * (y - places[i, 1])
                across = c * (y - places[i, 1]) - s * (x - places[i, 0])
                if abs(along) < places[i, 2] + 1.0 and abs(across) < places[i, 3] + 1.0:
                    inside = _half_plane(places[i, 2] - abs(along), c, s)
                    inside *= _half_plane(places[i, 3] - abs(across), s, c)
                    bend = across / places[i, 3] + 0.3
                    alpha += inside
                    shade += inside * (1.0 - 0.3 * min(bend * bend, 1.5))
            if alpha > 0.0:
                shade /= alpha
                alpha /= places.shape[0]
                for k in range(3):
                    picture[y, x, k] += alpha * (color[k] * shade - picture[y, x, k])


FINE = 16  # lines by which a row of pixels is sampled


def coverage(corners: Array, left: int, right: int, rows: npt.NDArray[np.int64]) -> Array:
    """Share of each pixel that a convex polygon covers.

    Along each of 16 lines of a row the covered length is exact.

    Parameters
    ----------
    corners : ndarray of shape (k, 2), float64
        In order around it, px.
    left, right : int
        First column, and the one after the last.
    rows : ndarray of shape (m,), int64

    Returns
    -------
    ndarray of shape (m, right - left), float64
        0 ... 1.
    """
    y = (rows[:, None] + (np.arange(FINE) + 0.5) / FINE - 0.5).reshape(-1, 1)
    (x0, y0), (x1, y1) = corners.T, np.roll(corners, -1, axis=0).T
    crosses = (y0 <= y) != (y1 <= y)
    flat = y1 == y0
    x = x0 + (y - y0) * (x1 - x0) / np.where(flat, 1.0, y1 - y0)
    begin = np.where(crosses, x, np.inf).min(axis=1)[:, None]
    end = np.where(crosses, x, -np.inf).max(axis=1)[:, None]
    columns = np.arange(left, right, dtype=np.float64)
    length = np.clip(np.minimum(end, columns + 0.5) - np.maximum(begin, columns - 0.5), 0.0, 1.0)
    found: Array = length.reshape(len(rows), FINE, -1).mean(axis=1)
    return found


def draw_polygon(picture: Picture, outlines: list[Array], look: npt.ArrayLike, rows: Rows = ALL_ROWS) -> None:
    """Blend a convex thing over some rows of a picture, in place.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    outlines : list of ndarray of shape (k, 2)
        Its outline in each sub-exposure, px.
    look : array_like of shape (3,) or (h, w, 3)
        Its color, or the picture that shows inside it.
    rows : Rows
        Which rows to draw.
    """
    height, width = picture.shape[:2]
    every = np.concatenate(outlines)
    left, top = np.maximum(np.floor(every.min(axis=0)).astype(int) - 1, 0).tolist()
    right, bottom = np.minimum(np.ceil(every.max(axis=0)).astype(int) + 2, (width, height)).tolist()
    chosen = np.arange(top + (rows.start - top) % rows.step, bottom, rows.step)
    if left >= right or len(chosen) == 0:
        return
    cover = sum(coverage(outline, left, right, chosen) for outline in outlines) / len(outlines)
    color = np.asarray(look, np.float32)
    if color.ndim == 3:
        color = color[chosen, left:right]
    part = picture[chosen, left:right]
    picture[chosen, left:right] = part + np.asarray(cover, np.float32)[:, :, None] * (color - part)
