"""The kernels that draw spheres, bars and convex polygons: a pixel is blended by the share of its area they cover.

Spheres are drawn in two ways: `draw_sphere` (exact: floating-point colors, the mean of several sub-exposures) and
`draw_sphere_fast` (one exposure, rounded to bytes). Both take the outline as straight within a pixel. Polygons
(`draw_polygon`) are sampled along 16 lines a row, exactly along each.
"""

import math
from typing import Annotated, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, record_dtype
from matchset.sim.rendering.shutter import ALL_ROWS, ShutterRows

Picture = npt.NDArray[np.float32]
Array = npt.NDArray[np.float64]
PackedPixels = npt.NDArray[np.uint32]
"""Pixels of one word each: B in the lowest byte, then G, R and opacity."""

FINE = 16  # geometry: lines along which a row of pixels is sampled


class Pinhole(NamedTuple):
    """A part of a pinhole camera's picture: pixel (x, y) sees along ((x - cx) / fx, (y - cy) / fy, 1)."""

    fx: float
    fy: float
    cx: float
    cy: float


class Sphere:
    """Layout of a sphere before a camera."""

    center: Annotated[Array, (3,), "f8"]  # camera frame, m
    distance_square: float  # of the center, m^2
    tangent_square: float  # of the length of a tangent from the camera, m^2
    band: float  # half the width of the outline's surroundings in which a pixel may be covered in part
    slope: float  # tangent of the half angle of the tangent cone


class BallShading:
    """Layout of what decides the colors of a ball; directions are unit vectors of the camera frame."""

    radius: float  # m
    color: Annotated[Array, (3,), "f8"]  # BGR, 0 ... 255
    marker_color: Annotated[Array, (3,), "f8"]
    marker: Annotated[Array, (3,), "f8"]  # direction to the first marker
    half_angle: float  # of a marker, as seen from the center of the sphere, rad; 0: no markers
    near_cosine: float  # of the largest angle to a marker's direction at which its border may be
    light: Annotated[Array, (3,), "f8"]  # direction to the light
    ambient: float
    highlight: float
    halfway: Annotated[Array, (3,), "f8"]  # direction half way between camera and light
    facing: float  # cosine of the angle between the view of the ball and the optical axis


class Bar:
    """Layout of an oriented rectangle in the picture, px."""

    x: float
    y: float
    half_length: float
    half_width: float
    cos: float  # of the angle from +x toward +y to its long axis
    sin: float


SPHERE, SHADING, BAR = record_dtype(Sphere), record_dtype(BallShading), record_dtype(Bar)


@kernel(refcount=False)
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


@kernel(refcount=False)
def _sphere_coverage(u: float, v: float, lens: Pinhole, sphere: Any) -> float:
    """Share of the pixel with ray d = (u, v, 1) inside the outline of a sphere with center c.

    With theta the angle between ray and center, tan(theta) = |d x c| / d.c is linear in px on the axis; the signed
    distance to the outline is (tan(alpha) - tan(theta)) / |gradient|, where sin(alpha) = radius / |c|.
    """
    x, y, z = sphere.center[0], sphere.center[1], sphere.center[2]
    cc, tangent_square = sphere.distance_square, sphere.tangent_square
    dd = u * u + v * v + 1.0
    dc = u * x + v * y + z
    excess = dc * dc - dd * tangent_square
    band = sphere.band * dd
    if excess > band:
        return 1.0
    if excess < -band or dc <= 0.0:
        return 0.0
    cross = math.sqrt(max(dd * cc - dc * dc, 1e-300))
    gx = ((cc * u - dc * x) / (cross * dc) - cross * x / (dc * dc)) / lens.fx
    gy = ((cc * v - dc * y) / (cross * dc) - cross * y / (dc * dc)) / lens.fy
    slope = math.sqrt(gx * gx + gy * gy)
    return _half_plane((sphere.slope - cross / dc) / slope, gx / slope, gy / slope)


@kernel(refcount=False)
def _marker_share(cosine: float, half_angle: float, soften: float) -> float:
    """Share of a marker's color where the normal makes an angle with its direction; 1/2 on its border."""
    return min(max((half_angle - math.acos(min(cosine, 1.0))) / soften + 0.5, 0.0), 1.0)


@kernel(refcount=False)
def _markers(nx: float, ny: float, nz: float, soften: float, ball: Any, more: Array) -> float:
    """Share of the markers' color at a normal; `more` holds the directions to all markers but the first."""
    marker = 0.0
    cosine = nx * ball.marker[0] + ny * ball.marker[1] + nz * ball.marker[2]
    if ball.half_angle > 0.0 and cosine > ball.near_cosine:
        marker = _marker_share(cosine, ball.half_angle, soften)
    for k in range(more.shape[0]):
        cosine = nx * more[k, 0] + ny * more[k, 1] + nz * more[k, 2]
        if ball.half_angle > 0.0 and cosine > ball.near_cosine:
            marker = max(marker, _marker_share(cosine, ball.half_angle, soften))
    return marker


@kernel(refcount=False)
def _shade(u: float, v: float, sphere: Any, soften: float, ball: Any, more: Array) -> tuple[float, float, float]:
    """Color of the sphere where the ray (u, v, 1) meets it, or of its outline next to the ray.

    `more` holds the directions to all markers but the first; `soften` is the width of a marker's border, rad as seen
    from the center of the sphere. The directions to the camera and half way to the light are those at the center of
    the sphere.
    """
    center, light = sphere.center, ball.light
    dd = u * u + v * v + 1.0
    dc = u * center[0] + v * center[1] + center[2]
    depth = math.sqrt(max(dc * dc - dd * sphere.tangent_square, 0.0))
    t = (dc - depth) / dd
    unit = 1.0 / ball.radius
    nx, ny, nz = (t * u - center[0]) * unit, (t * v - center[1]) * unit, (t - center[2]) * unit
    soft = max((nx * light[0] + ny * light[1] + nz * light[2] + 0.45) * (1.0 / 1.45), 0.0)
    diffuse = ball.ambient - 0.10 * ny + 0.75 * soft * soft
    rim = 1.0 - depth * ball.facing * unit
    shine = 26.0 * rim * rim * rim
    glint = nx * ball.halfway[0] + ny * ball.halfway[1] + nz * ball.halfway[2]
    if glint > 0.0:
        glint = glint * glint
        glint = glint * glint * glint * glint
        shine += 0.16 * ball.highlight * glint
        glint = glint * glint * glint * glint
        shine += ball.highlight * glint * glint * glint * glint
    marker, color, other = _markers(nx, ny, nz, soften, ball, more), ball.color, ball.marker_color
    return (
        min((color[0] + marker * (other[0] - color[0])) * diffuse + shine, 255.0),
        min((color[1] + marker * (other[1] - color[1])) * diffuse + shine, 255.0),
        min((color[2] + marker * (other[2] - color[2])) * diffuse + shine, 255.0),
    )


@kernel(refcount=False)
def _sphere_box(
    lens: Pinhole, spheres: Any, radius: float, shape: tuple[int, int], rows: tuple[int, int]
) -> tuple[int, int, int, int]:
    """Left, right, top, bottom of the rows and columns that may hold a part of any sub-exposure of a sphere."""
    height, width = float(shape[0]), float(shape[1])
    left, right, top, bottom = width, -1.0, height, -1.0
    for i in range(spheres.shape[0]):
        x, y, z = spheres[i].center[0], spheres[i].center[1], spheres[i].center[2]
        # A point of the sphere has x +- R and z +- R: the quotients of the extremes bound its projection.
        left = min(left, lens.cx + lens.fx * min((x - radius) / (z - radius), (x - radius) / (z + radius)))
        right = max(right, lens.cx + lens.fx * max((x + radius) / (z - radius), (x + radius) / (z + radius)))
        top = min(top, lens.cy + lens.fy * min((y - radius) / (z - radius), (y - radius) / (z + radius)))
        bottom = max(bottom, lens.cy + lens.fy * max((y + radius) / (z - radius), (y + radius) / (z + radius)))
    first = int(max(top - 1.0, 0.0))
    first += (rows[0] - first) % rows[1]
    return (
        int(max(left - 1.0, 0.0)),
        int(min(right + 2.0, width - 1.0)),
        first,
        int(min(bottom + 2.0, height - 1.0)),
    )


@kernel
def draw_sphere(
    picture: Picture, rows: tuple[int, int], lens: Pinhole, spheres: Any, shading: Block, more: Array
) -> None:
    """Blend a sphere over some rows of a picture, its coverage averaged over the sub-exposures.

    Parameters
    ----------
    picture : (h, w, 3), written
        BGR, 0 ... 255.
    rows : (int, int)
        The first, and the distance from one to the next, see `ShutterRows`.
    lens : Pinhole
    spheres : (n,) of `Sphere`
        One for each sub-exposure.
    shading : block
        `BallShading`.
    more : (m, 3)
        Directions to all markers but the first.
    """
    ball, n = shading.view(SHADING)[0], spheres.shape[0]
    first, last, before, after = spheres[0], spheres[n - 1], spheres[(n - 1) // 2], spheres[n // 2]
    middle = np.empty(1, SPHERE)[0]
    for k in range(3):
        middle.center[k] = 0.5 * (before.center[k] + after.center[k])
    middle.tangent_square = 0.5 * (before.tangent_square + after.tangent_square)
    moved = (abs(last.center[0] - first.center[0]) + abs(last.center[1] - first.center[1])) / ball.radius
    soften = middle.center[2] / (lens.fx * ball.radius) + moved
    left, right, top, bottom = _sphere_box(lens, spheres, ball.radius, picture.shape[:2], rows)
    per_pixel, share = 1.0 / lens.fx, 1.0 / n
    for y in range(top, bottom + 1, rows[1]):
        v = (y - lens.cy) / lens.fy
        for x in range(left, right + 1):
            u = (x - lens.cx) * per_pixel
            alpha = 0.0
            for i in range(n):
                alpha += _sphere_coverage(u, v, lens, spheres[i])
            if alpha > 0.0:
                alpha *= share
                blue, green, red = _shade(u, v, middle, soften, ball, more)
                picture[y, x, 0] += alpha * (blue - picture[y, x, 0])
                picture[y, x, 1] += alpha * (green - picture[y, x, 1])
                picture[y, x, 2] += alpha * (red - picture[y, x, 2])


@kernel
def draw_sphere_fast(picture: PackedPixels, lens: Pinhole, center: Array, shading: Any) -> None:
    """Blend a sphere that does not move over packed pixels, as `draw_sphere` would over a picture.

    `center` is (3,), camera frame, m; `shading` a record `BallShading` with one marker.
    """
    spheres, none, radius = np.empty(1, SPHERE), np.empty((0, 3)), shading.radius
    sphere = spheres[0]
    square = center[0] ** 2 + center[1] ** 2 + center[2] ** 2
    tangent_square = square - radius**2
    sphere.center[0], sphere.center[1], sphere.center[2] = center[0], center[1], center[2]
    sphere.distance_square, sphere.tangent_square = square, tangent_square
    sphere.band = 4.0 * radius * math.sqrt(tangent_square) / min(lens.fx, lens.fy)
    sphere.slope = radius / math.sqrt(tangent_square)
    soften = center[2] / (lens.fx * radius)
    left, right, top, bottom = _sphere_box(lens, spheres, radius, picture.shape, (0, 1))
    per_pixel = 1.0 / lens.fx
    for y in range(top, bottom + 1):
        v = (y - lens.cy) / lens.fy
        for x in range(left, right + 1):
            u = (x - lens.cx) * per_pixel
            alpha = _sphere_coverage(u, v, lens, sphere)
            if alpha > 0.0:
                picture[y, x] = _blended(picture[y, x], alpha, _shade(u, v, sphere, soften, shading, none))


@kernel(refcount=False)
def _blended(word: np.uint32, alpha: float, color: tuple[float, float, float]) -> np.uint32:
    """Blend a color over a packed pixel; its opacity stays."""
    new, half, byte = np.uint32(0), np.float32(0.5), np.uint32(255)
    for k in range(3):
        shift = np.uint32(8 * k)
        under = np.float32((word >> shift) & byte)
        over = np.float32(under + alpha * (color[k] - under))
        new |= np.uint32(np.uint32(np.int32(over + half)) << shift)
    return np.uint32(new | (word & np.uint32(0xFF000000)))


@kernel(refcount=False)
def _bar_box(bars: Any, shape: tuple[int, int], rows: tuple[int, int]) -> tuple[int, int, int, int]:
    """Left, right, top, bottom of the rows and columns that may hold a part of any sub-exposure of a bar."""
    height, width = float(shape[0]), float(shape[1])
    left, right, top, bottom = width, -1.0, height, -1.0
    for i in range(bars.shape[0]):
        bar = bars[i]
        c, s = abs(bar.cos), abs(bar.sin)
        half_x, half_y = bar.half_length * c + bar.half_width * s, bar.half_length * s + bar.half_width * c
        left, right = min(left, bar.x - half_x), max(right, bar.x + half_x)
        top, bottom = min(top, bar.y - half_y), max(bottom, bar.y + half_y)
    x0, x1 = int(max(left - 1.0, 0.0)), int(min(right + 2.0, width - 1.0))
    y0, y1 = int(max(top - 1.0, 0.0)), int(min(bottom + 2.0, height - 1.0))
    y0 += (rows[0] - y0) % rows[1]
    return x0, x1, y0, y1


@kernel
def draw_bars(picture: Picture, bars: Any, color: Array, rows: tuple[int, int]) -> None:
    """Blend the mean of the sub-exposures of an oriented rectangle, (n,) of `Bar`, shaded like a stick, over rows."""
    left, right, top, bottom = _bar_box(bars, picture.shape[:2], rows)
    for y in range(top, bottom + 1, rows[1]):
        for x in range(left, right + 1):
            alpha, shade = 0.0, 0.0
            for i in range(bars.shape[0]):
                bar = bars[i]
                along = bar.cos * (x - bar.x) + bar.sin * (y - bar.y)
                across = bar.cos * (y - bar.y) - bar.sin * (x - bar.x)
                if abs(along) < bar.half_length + 1.0 and abs(across) < bar.half_width + 1.0:
                    inside = _half_plane(bar.half_length - abs(along), bar.cos, bar.sin)
                    inside *= _half_plane(bar.half_width - abs(across), bar.sin, bar.cos)
                    bend = across / bar.half_width + 0.3
                    alpha += inside
                    shade += inside * (1.0 - 0.3 * min(bend * bend, 1.5))
            if alpha > 0.0:
                shade /= alpha
                alpha /= bars.shape[0]
                for k in range(3):
                    picture[y, x, k] += alpha * (color[k] * shade - picture[y, x, k])


def polygon_coverage(corners: Array, left: int, right: int, rows: npt.NDArray[np.int64]) -> Array:
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


def draw_polygon(picture: Picture, outlines: list[Array], color: npt.ArrayLike, rows: ShutterRows = ALL_ROWS) -> None:
    """Blend a convex polygon over some rows of a picture, in place.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    outlines : list of ndarray of shape (k, 2)
        Its corners in each sub-exposure, px.
    color : array_like of shape (3,) or (h, w, 3)
        Its color, or the picture that shows inside it.
    rows : ShutterRows
        Which rows to draw.
    """
    height, width = picture.shape[:2]
    every = np.concatenate(outlines)
    left, top = np.maximum(np.floor(every.min(axis=0)).astype(int) - 1, 0).tolist()
    right, bottom = np.minimum(np.ceil(every.max(axis=0)).astype(int) + 2, (width, height)).tolist()
    chosen = np.arange(top + (rows.start - top) % rows.step, bottom, rows.step)
    if left >= right or len(chosen) == 0:
        return
    cover = sum(polygon_coverage(outline, left, right, chosen) for outline in outlines) / len(outlines)
    inside = np.asarray(color, np.float32)
    if inside.ndim == 3:
        inside = inside[chosen, left:right]
    part = picture[chosen, left:right]
    picture[chosen, left:right] = part + np.asarray(cover, np.float32)[:, :, None] * (inside - part)
