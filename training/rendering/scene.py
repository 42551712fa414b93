"""A picture of a ball, or of something else, before a photograph: `render`.

Scenes of small balls are drawn at twice the size, and reduced by the camera.
"""

import copy
import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np

from matchset.image.disc_network.patch_format import Circle3, Image
from training.rendering.ball import BallParameters, ball_colors, surface_normal
from training.rendering.camera import CameraParameters, VideoParameters, taken, through_video
from training.rendering.covers import CoverParameters, with_covers
from training.rendering.hands import HandParameters, any_hand, with_fingers, with_grip, with_palm
from training.rendering.layers import (
    FINE,
    FULL,
    SHIFT,
    BlobParameters,
    Counts,
    MaterialParameters,
    Random,
    Range,
    Singles,
    blob,
    blurred,
    count_within,
    darkened,
    disc,
    happens,
    log_within,
    offsets,
    over,
    pixel_at,
    surface,
    within,
)
from training.rendering.light import LightParameters, lit
from training.rendering.other_shapes import OtherShapeParameters, other_shape
from training.rendering.photographs import Photographs

STILL = 0.0, 0.0


class BackgroundParameters(msgspec.Struct, frozen=True):
    """What is done to a photograph, and what lies before it beside a ball; chosen by hand.

    Parameters
    ----------
    blurs : float
        Share of photographs that are blurred.
    blur : (float, float)
        Standard deviation of that, radii of the ball.
    faded : float
        Share that is faded toward its mean color.
    contrast : (float, float)
        What contrast that leaves, as a share.
    shadows : float
        Share of scenes with a cast shadow: an ellipse.
    shadow_right : float
        Standard deviation of its center from the ball's along x, radii.
    shadow_below : (float, float)
        How far its center is below the ball's, radii.
    shadow_width, shadow_height : (float, float)
        Its half axes, radii.
    shadow_soft : (float, float)
        Standard deviation by which it is blurred, radii.
    shadow : (float, float)
        How dark it is, as a share.
    alike : float
        Share of scenes of a ball with things of its color around it.
    things : (int, int)
        Least and largest number of those.
    thing : BlobParameters
    thing_light : (float, float)
        Their brightness as a share of the ball's at its center.
    thing_differs : float
        Standard deviation of a channel of their color beside that, of 255.
    material : MaterialParameters
        Of those.
    """

    blurs: float = 0.35
    blur: Range = (0.02, 0.3)
    faded: float = 0.15
    contrast: Range = (0.0, 0.3)
    shadows: float = 0.3
    shadow_right: float = 0.5
    shadow_below: Range = (0.2, 1.2)
    shadow_width: Range = (0.8, 1.3)
    shadow_height: Range = (0.3, 1.0)
    shadow_soft: Range = (0.05, 0.4)
    shadow: Range = (0.2, 0.8)
    alike: float = 0.2
    things: Counts = (1, 6)
    thing: BlobParameters = BlobParameters(apart=(1.0, 2.2), corners=(4, 8), size=(0.15, 0.8), uneven=0.4)
    thing_light: Range = (0.4, 1.3)
    thing_differs: float = 12.0
    material: MaterialParameters = MaterialParameters()


class SceneParameters(msgspec.Struct, frozen=True):
    """What scenes are rendered; chosen by hand.

    Parameters
    ----------
    radius : (float, float)
        Of the ball, px.
    small : float
        Radius below which a scene is drawn at a larger size, px.
    oversampling : int
        How much larger.
    side, margin : float
        Side of the picture, radii, and what is added to it, px.
    offset : float
        Farthest that the ball is from the middle of the picture along an axis, radii.
    hands : float
        Share of scenes with a hand.
    palms : float
        Share of those in which the palm is seen behind the ball.
    moving : float
        Share of scenes in which the ball moves while the picture is taken.
    fast : float
        Share of those in which it does so by more than its diameter, about.
    sweep, fast_sweep : (float, float)
        How far it moves, radii.
    gamma : (float, float)
        Light adds up in a camera, not what is written of it: what is seen during the exposure is summed to this power.
    shaken : float
        Share of the other scenes in which all moves: the ball with its hand, or the camera.
    shake : (float, float)
        How far, radii.
    moving_hidden : float
        Share of moving balls that something is in front of; of others it is all, which `covers` may leave free.
    cut : float
        Share of pictures whose border is moved into the ball.
    cut_at : (float, float)
        Distance of the border from the ball's center then, radii.
    videos : float
        Share of pictures that are the last one of a coded video.
    background : BackgroundParameters
    ball : BallParameters
    light : LightParameters
    hand : HandParameters
    covers : CoverParameters
    others : OtherShapeParameters
    camera : CameraParameters
    video : VideoParameters
    """

    radius: Range = (4.0, 60.0)
    small: float = 14.0
    oversampling: int = 2
    side: float = 5.2
    margin: int = 12
    offset: float = 0.6
    hands: float = 0.35
    palms: float = 0.7
    moving: float = 0.35
    fast: float = 0.25
    sweep: Range = (0.1, 1.3)
    fast_sweep: Range = (1.3, 2.6)
    gamma: Range = (1.0, 2.2)
    shaken: float = 0.3
    shake: Range = (0.1, 0.9)
    moving_hidden: float = 0.4
    cut: float = 0.12
    cut_at: Range = (0.2, 0.95)
    videos: float = 0.4
    background: BackgroundParameters = BackgroundParameters()
    ball: BallParameters = BallParameters()
    light: LightParameters = LightParameters()
    hand: HandParameters = HandParameters()
    covers: CoverParameters = CoverParameters()
    others: OtherShapeParameters = OtherShapeParameters()
    camera: CameraParameters = CameraParameters()
    video: VideoParameters = VideoParameters()


class Scene(NamedTuple):
    """A picture and what is in it.

    Attributes
    ----------
    image : ndarray of shape (h, w, 3), uint8
        BGR.
    circle : (x, y, radius)
        Of the ball in the middle of its movement, px, or of the other shape.
    sweep : (float, float)
        Half of that movement, px along x and y.
    is_ball : bool
    earlier : ndarray of shape (h', w', 3), uint8
        The same camera's picture of it with nothing in front, at rest.
    earlier_circle : (x, y, radius)
        Where it is in that, px.
    """

    image: Image
    circle: Circle3
    sweep: tuple[float, float]
    is_ball: bool
    earlier: Image
    earlier_circle: Circle3


def render(random: Random, photographs: Photographs, is_ball: bool, limits: SceneParameters | None = None) -> Scene:
    """Render a scene.

    Parameters
    ----------
    random : Generator
    photographs : Photographs
        What is behind.
    is_ball : bool
        Whether there is a ball in it, rather than another shape or nothing.
    limits : SceneParameters, optional

    Returns
    -------
    Scene
    """
    limits = limits or SceneParameters()
    radius = log_within(random, limits.radius)
    scale = limits.oversampling if radius < limits.small else 1
    side = scale * (int(limits.side * radius) + limits.margin)  # whole pixels of the picture, or it would be stretched
    radius *= scale
    x, y = (0.5 * side + within(random, (-limits.offset, limits.offset)) * radius for _ in range(2))
    circle = x, y, radius
    drawn = _drawn(random, photographs.crop(random, (side, side)), circle, photographs, (is_ball, limits))
    # by the same camera, and without a change of what is drawn for the picture itself
    earlier = taken(copy.deepcopy(random), np.clip(drawn.earlier, 0.0, FULL), radius, scale, limits.camera)
    image = taken(random, np.clip(drawn.picture, 0.0, FULL), radius, scale, limits.camera)
    x, y, radius = (x + 0.5) / scale - 0.5, (y + 0.5) / scale - 0.5, radius / scale
    before, sweep = (x, y, radius), (drawn.sweep[0] / scale, drawn.sweep[1] / scale)
    if happens(random, limits.videos):
        image = through_video(random, image, (x, y, radius), limits.video)
    if happens(random, limits.cut):
        image, left, top = _cut(random, image, (x, y, radius), limits.cut_at)
        x, y = x - left, y - top
    return Scene(np.ascontiguousarray(image), (x, y, radius), sweep, is_ball, earlier, before)


class _Drawn(NamedTuple):
    """A picture, half the movement of the ball in it along x and y, px, and the ball at rest with nothing in front."""

    picture: Singles
    sweep: tuple[float, float]
    earlier: Singles


def _drawn(
    random: Random,
    photograph: Singles,
    circle: Circle3,
    photographs: Photographs,
    chosen: tuple[bool, SceneParameters],
) -> _Drawn:
    """Draw all before a photograph."""
    is_ball, limits = chosen
    around = _prepared(random, photograph, circle[2], limits.background)
    picture = _shadowed(random, around, circle, limits.background)
    hand = any_hand(random, limits.hand) if happens(random, limits.hands) else None
    if hand is not None:
        if happens(random, limits.palms):
            picture = with_palm(random, picture, circle, hand, limits.hand)
        if happens(random, limits.hand.grips):
            picture = with_grip(random, picture, circle, hand, (limits.hand.grip_behind, limits.hand))
        around = picture
    size = picture.shape[:2]
    normal = surface_normal(offsets(size, circle))
    colors = lit(random, ball_colors(random, around, circle, normal, limits.ball), normal, limits.light)
    if is_ball and happens(random, limits.background.alike):
        picture = _with_things(random, picture, circle, pixel_at(colors, *circle[:2]), limits.background)
    mask = disc(size, circle) if is_ball else other_shape(random, size, circle, limits.others)
    sweep, hidden, earlier = STILL, True, over(picture, mask, colors)
    if happens(random, limits.moving):
        reach = limits.fast_sweep if happens(random, limits.fast) else limits.sweep
        way, sweep = _any_way(random, within(random, reach) * circle[2])
        picture = _with_moving(picture, mask, colors, way, within(random, limits.gamma))
        hidden = happens(random, limits.moving_hidden)
    else:
        picture = earlier
    if hidden and hand is not None:
        picture = with_fingers(random, picture, circle, hand, limits.hand)
        if happens(random, limits.hand.grips):
            picture = with_grip(random, picture, circle, hand, (limits.hand.grip_before, limits.hand))
    elif hidden:
        picture = with_covers(random, picture, circle, photographs, limits.covers)
    if sweep == STILL and happens(random, limits.shaken):
        way, sweep = _any_way(random, within(random, limits.shake) * circle[2])
        picture = _shaken(picture, way, within(random, limits.gamma))
    return _Drawn(picture, sweep, earlier)


def _prepared(random: Random, photograph: Singles, radius: float, limits: BackgroundParameters) -> Singles:
    """Blur or fade a photograph, or neither."""
    if happens(random, limits.blurs):
        photograph = blurred(photograph, within(random, limits.blur) * radius)
    if happens(random, limits.faded):
        mean = photograph.mean(axis=(0, 1))
        photograph = mean + (photograph - mean) * np.float32(within(random, limits.contrast))
    return photograph


def _shadowed(random: Random, picture: Singles, circle: Circle3, limits: BackgroundParameters) -> Singles:
    """Cast a shadow below where the ball will be, or none."""
    if not happens(random, limits.shadows):
        return picture
    x, y = offsets(picture.shape[:2], circle)
    right, below = random.normal(0.0, limits.shadow_right), within(random, limits.shadow_below)
    across = (x - np.float32(right)) / np.float32(within(random, limits.shadow_width))
    down = (y - np.float32(below)) / np.float32(within(random, limits.shadow_height))
    mask = blurred((across**2 + down**2 < 1.0).astype(np.float32), within(random, limits.shadow_soft) * circle[2])
    return darkened(picture, mask, within(random, limits.shadow))


def _with_things(
    random: Random, picture: Singles, circle: Circle3, color: Singles, limits: BackgroundParameters
) -> Singles:
    """Draw things of nearly a ball's color around it."""
    for _ in range(count_within(random, limits.things)):
        mask = blob(random, picture.shape[:2], circle, limits.thing)
        alike = color * within(random, limits.thing_light) + random.normal(0.0, limits.thing_differs, 3)
        colors = surface(random, mask, np.clip(alike, 0.0, FULL), circle[2], limits.material)
        picture = over(picture, mask, colors)
    return picture


def _with_moving(picture: Singles, mask: Singles, colors: Singles, way: Singles, gamma: float) -> Singles:
    """Draw a shape that moves along a way while light is summed."""
    smeared = cv2.filter2D(mask, -1, way)[..., np.newaxis]
    moving = cv2.filter2D(_as_light(colors, gamma) * mask[..., np.newaxis], -1, way)
    summed = _as_light(picture, gamma) * (1.0 - smeared) + moving
    return _as_written(np.asarray(summed, np.float32), gamma)


def _shaken(picture: Singles, way: Singles, gamma: float) -> Singles:
    """Smear a whole picture along a way while light is summed."""
    smeared = cv2.filter2D(_as_light(picture, gamma), -1, way, borderType=cv2.BORDER_REPLICATE)
    return _as_written(np.asarray(smeared, np.float32), gamma)


def _as_light(written: Singles, gamma: float) -> Singles:
    """Read a picture as light, a share of the brightest: that is a power of what is written of it."""
    return np.asarray(np.clip(written / FULL, 0.0, 1.0) ** np.float32(gamma), np.float32)


def _as_written(light: Singles, gamma: float) -> Singles:
    """Write light as a picture, see `_as_light`."""
    return np.asarray(FULL * np.clip(light, 0.0, 1.0) ** np.float32(1.0 / gamma), np.float32)


def _any_way(random: Random, length: float) -> tuple[Singles, tuple[float, float]]:
    """Kernel that smears along a line of a length, px, in a random direction; with half of that line along x and y."""
    angle = within(random, (0.0, math.pi))
    half = 0.5 * length * math.cos(angle), 0.5 * length * math.sin(angle)
    side = (int(max(length, 1.0)) | 1) + 2  # odd, so that it has a middle
    middle = 0.5 * (side - 1)
    start, end = (tuple(round((middle + sign * part) * FINE) for part in half) for sign in (-1, 1))
    way = np.zeros((side, side), np.float32)
    cv2.line(way, start, end, (1.0,), 1, cv2.LINE_AA, SHIFT)
    way /= way.sum()
    return way, half


def _cut(random: Random, image: Image, circle: Circle3, limits: Range) -> tuple[Image, int, int]:
    """Cut a picture through the ball at one of its sides; with the columns and rows that are lost at left and top."""
    x, y, radius = circle
    distance = within(random, limits) * radius
    left, top = max(int(x - distance), 0), max(int(y - distance), 0)
    right, bottom = int(x + distance) + 1, int(y + distance) + 1
    side = int(random.integers(4))
    if side == 0:
        return image[:, left:], left, 0
    if side == 1:
        return image[top:], 0, top
    return (image[:, :right], 0, 0) if side == 2 else (image[:bottom], 0, 0)
