"""Draw a `Balloon` and an `Occluder` over a picture, with exact coverage at every outline.

Pixels are blended in display values: half covered is half way between the two colors.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.numeric.arguments import require_within
from matchset.numeric.record import Block, fields, new_block
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.occluder import Occluder
from matchset.sim.rendering.coverage import BAR, SHADING, SPHERE, Pinhole, draw_bars, draw_sphere
from matchset.sim.rendering.shutter import ALL_ROWS, ShutterRows

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
        Brightness of the small highlight, display units, 0 ... 2000. From 200 on it saturates, and the more the larger
        the white spot is.
    shadow : float
        Share of the light that the side away from it loses, 0 ... 1: a shadow of the ball on itself. 0: only `ambient`
        decides. `draw_painted_ball` draws it.
    """

    direction: tuple[float, float, float] = (-0.48, -0.72, -0.5)
    ambient: float = 0.45
    highlight: float = 150.0
    shadow: float = 0.0

    def __post_init__(self) -> None:
        limits = {"ambient": (0.0, 1.0), "highlight": (0.0, 2000.0), "shadow": (0.0, 1.0)}
        require_within(self, limits, "of a light lies in")


def draw_balloon(
    picture: Picture,
    camera: CameraModel,
    balloon: Balloon,
    positions: npt.ArrayLike,
    light: Light | None = None,
    rows: ShutterRows = ALL_ROWS,
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
    rows : ShutterRows
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
    draw_at(picture, Pinhole(camera.fx, camera.fy, camera.cx, camera.cy), balloon, centers, light, rows)


def draw_at(
    picture: Picture,
    window: Pinhole,
    balloon: Balloon,
    centers: Array,
    light: Light | None = None,
    rows: ShutterRows = ALL_ROWS,
) -> None:
    """Draw a balloon over a part of a pinhole camera's picture; otherwise as `draw_balloon`."""
    shading = ball_shading(balloon, light if light is not None else Light(), centers.mean(axis=0))
    square = (centers**2).sum(axis=1)
    tangent_square = square - balloon.radius**2
    spheres = np.empty(len(centers), SPHERE)
    spheres["center"], spheres["distance_square"], spheres["tangent_square"] = centers, square, tangent_square
    # Within this much of the outline (3 px or more on either side) a pixel may be covered in part.
    spheres["band"] = 4.0 * balloon.radius * np.sqrt(tangent_square) / min(window.fx, window.fy)
    spheres["slope"] = balloon.radius / np.sqrt(tangent_square)
    more = np.array(balloon.more_markers, np.float64).reshape(-1, 3)
    draw_sphere(picture, (rows.start, rows.step), window, spheres, shading, more)


def draw_occluder(picture: Picture, occluders: list[Occluder], rows: ShutterRows = ALL_ROWS) -> None:
    """Draw a bar or board over a picture, in place; several places of it are the sub-exposures of its motion.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    occluders : list of Occluder
        Where it is in each sub-exposure; the first one gives the color.
    rows : ShutterRows
        Which rows to draw.
    """
    bars = np.array(
        [(o.x, o.y, o.half_length, o.half_width, math.cos(o.angle), math.sin(o.angle)) for o in occluders], BAR
    )
    draw_bars(picture, bars, np.array(occluders[0].color, dtype=np.float64), (rows.start, rows.step))


def ball_shading(balloon: Balloon, light: Light, center: Array) -> Block:
    """Make the block of `BallShading` of a balloon; `center` is (3,), camera frame, m."""
    block = new_block(SHADING)
    shading = fields(block, SHADING)
    to_camera = -center / np.linalg.norm(center)
    to_light = np.array(light.direction) / math.hypot(*light.direction)
    between = to_light + to_camera
    shading.radius, shading.color[:], shading.marker_color[:] = balloon.radius, balloon.color, balloon.marker_color
    shading.marker[:] = to_camera if balloon.marker is None else np.array(balloon.marker)
    shading.half_angle = math.asin(balloon.marker_radius / balloon.radius)
    shading.near_cosine = math.cos(min(shading.half_angle * 1.5 + 0.3, math.pi))
    shading.light[:], shading.ambient, shading.highlight = to_light, light.ambient, light.highlight
    shading.halfway[:] = between / max(float(np.linalg.norm(between)), 1e-9)
    shading.facing = -float(to_camera[2])
    return block


def _check(picture: Picture, camera: CameraModel) -> None:
    if picture.shape != (camera.height, camera.width, 3) or picture.dtype != np.float32:
        raise ValueError(
            f"a picture must be float32 of shape {(camera.height, camera.width, 3)}, "
            f"got {picture.dtype} of shape {picture.shape}"
        )
