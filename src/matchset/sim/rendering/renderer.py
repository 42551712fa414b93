"""The ray-caster: draws a `Balloon` and an `Occluder` over a picture with exact coverage at every outline.

Pixels are blended in display values: half covered is half way between the two colors.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.occluder import Occluder
from matchset.sim.rendering.coverage import draw_bars, draw_sphere
from matchset.sim.rendering.shutter import ALL_ROWS, Rows

Picture = npt.NDArray[np.float32]
Array = npt.NDArray[np.float64]


class Light(msgspec.Struct, frozen=True, kw_only=True):
    """One soft light far away and the room's own.

    Parameters
    ----------
    direction : tuple of 3 floats
        Unit vector toward the light, camera frame.
    ambient : float
        Share of the surface color that shows without the light, 0 ... 1.
    highlight : float
        Brightness of the small highlight, display units (0 ... 255).
    """

    direction: tuple[float, float, float] = (-0.48, -0.72, -0.5)
    ambient: float = 0.45
    highlight: float = 150.0


def draw_balloon(
    picture: Picture,
    camera: CameraModel,
    balloon: Balloon,
    positions: npt.ArrayLike,
    light: Light | None = None,
    rows: Rows = ALL_ROWS,
) -> None:
    """Draw a balloon over a picture, in place.

    A pixel's coverage is the area of its unit square inside the sphere's outline (a straight edge there);
    the fitted radius is true to 0.01 px. The picture is the mean over `positions`: the sub-exposures of a
    moving balloon.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    camera : CameraModel
        Its size is the picture's.
    balloon : Balloon
        What to draw; its marker's direction is in the camera frame.
    positions : array_like of shape (n, 3)
        Centers of the balloon in the camera frame, m, equally spaced in time.
    light : Light, optional
        Where light comes from.
    rows : Rows
        Which rows to draw.

    Raises
    ------
    ValueError
        If the picture does not fit the camera, or a position is not wholly in front of it.
    """
    centers = np.atleast_2d(np.asarray(positions, dtype=np.float64))
    _check(picture, camera)
    if centers.ndim != 2 or centers.shape[1] != 3 or centers.shape[0] == 0:
        raise ValueError(f"positions must have shape (n, 3), got {centers.shape}")
    if not (np.isfinite(centers).all() and centers[:, 2].min() > balloon.radius):
        raise ValueError(f"a balloon must lie in front of the camera, got {centers.tolist()}")
    paint_balloon(picture, (camera.fx, camera.fy, camera.cx, camera.cy), balloon, centers, light, rows)


def paint_balloon(
    picture: Picture,
    window: tuple[float, float, float, float],
    balloon: Balloon,
    centers: Array,
    light: Light | None = None,
    rows: Rows = ALL_ROWS,
) -> None:
    """Draw a balloon over any part of a pinhole's picture: `window` is fx, fy, cx, cy; the rest as `draw_balloon`."""
    look = appearance(balloon, light if light is not None else Light(), centers.mean(axis=0))
    lens = np.array(window)
    square = (centers**2).sum(axis=1)
    tangent_sq = square - balloon.radius**2
    # Within this much of the outline (3 px or more on either side) a pixel may be covered in part.
    band = 4.0 * balloon.radius * np.sqrt(tangent_sq) / min(window[0], window[1])
    spheres = np.column_stack((centers, square, tangent_sq, band, balloon.radius / np.sqrt(tangent_sq)))
    more = np.array(balloon.more_markers, np.float64).reshape(-1, 3)
    draw_sphere(picture, lens, spheres, balloon.radius, look, more, rows.start, rows.step)


def draw_occluder(picture: Picture, occluders: list[Occluder], rows: Rows = ALL_ROWS) -> None:
    """Draw a bar or board over a picture, in place; several places of it are the sub-exposures of its motion.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    occluders : list of Occluder
        Where it is in each sub-exposure; the first one gives the color.
    rows : Rows
        Which rows to draw.
    """
    places = np.array(
        [[o.x, o.y, o.half_length, o.half_width, math.cos(o.angle), math.sin(o.angle)] for o in occluders]
    )
    draw_bars(picture, places, np.array(occluders[0].color, dtype=np.float64), rows.start, rows.step)


def appearance(balloon: Balloon, light: Light, center: Array) -> Array:
    """Pack what the kernels that draw a sphere need of its looks into one array: `center` is (3,), m, camera frame."""
    to_eye = -center / np.linalg.norm(center)
    to_light = np.array(light.direction) / math.hypot(*light.direction)
    between = to_light + to_eye
    marker = to_eye if balloon.marker is None else np.array(balloon.marker)
    half_angle = math.asin(balloon.marker_radius / balloon.radius)
    return np.array(
        [
            *balloon.color,
            *balloon.marker_color,
            *marker,
            half_angle,
            *to_light,
            light.ambient,
            light.highlight,
            math.cos(min(half_angle * 1.5 + 0.3, math.pi)),
            *(between / max(float(np.linalg.norm(between)), 1e-9)),
            -float(to_eye[2]),
        ]
    )


def _check(picture: Picture, camera: CameraModel) -> None:
    if picture.shape != (camera.height, camera.width, 3) or picture.dtype != np.float32:
        raise ValueError(
            f"a picture must be float32 of shape {(camera.height, camera.width, 3)}, "
            f"got {picture.dtype} of shape {picture.shape}"
        )
