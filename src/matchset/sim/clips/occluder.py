"""What hides a part of the ball: `Occluder`, a bar or a board in front of it."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
from scipy.optimize import brentq

from matchset.camera.camera_model import CameraModel
from matchset.sim.clips.truth import SphereOutline
from matchset.sim.rendering.capsules import Capsule


class Occluder(msgspec.Struct, frozen=True, kw_only=True):
    """An opaque oriented rectangle in the picture, nearer than the ball.

    Parameters
    ----------
    x, y : float
        Center, px.
    half_length, half_width : float
        Half its extent along and across its axis, px.
    angle : float
        From +x toward +y to its axis, rad.
    color : tuple of 3 floats
        BGR, 0 ... 255.
    """

    x: float
    y: float
    half_length: float
    half_width: float
    angle: float
    color: tuple[float, float, float] = (128.0, 132.0, 136.0)


def bar_width(share: float, offset: float) -> float:
    """Half width of a bar that covers a given share of the unit disc.

    The bar is the strip offset - w < t < offset + w; the disc's share below t is (t sqrt(1 - t^2) + asin
    t)/pi + 1/2.

    Parameters
    ----------
    share : float
        Share of the disc's area to be covered, 0 < share < 1.
    offset : float
        Distance of the bar's axis from the center, in radii, -1 ... 1.

    Returns
    -------
    float
        w, in radii.
    """
    if not 0.0 < share < 1.0:
        raise ValueError(f"an occluder's share of the disc must lie between 0 and 1, got {share}")

    def below(t: float) -> float:
        t = min(max(t, -1.0), 1.0)
        return (t * math.sqrt(1.0 - t * t) + math.asin(t)) / math.pi + 0.5

    return float(brentq(lambda w: below(offset + w) - below(offset - w) - share, 0.0, 2.0))


def bar_over(outline: SphereOutline, share: float, angle: float, offset: float = -0.3) -> Occluder:
    """Build a stick that covers a given share of the disc, taken as the circle of equal area.

    Parameters
    ----------
    outline : SphereOutline
        The ball.
    share : float
        Share of the disc that the stick covers, 0 < share < 1.
    angle : float
        Direction of the stick in the picture, rad.
    offset : float
        Distance of the stick's axis from the disc's center, radii; with the default and a steep stick a
        click at (x - r/2, y) hits the ball.

    Returns
    -------
    Occluder
        A stick that sticks out of the disc by half a radius at one end and by three radii at the other.
    """
    radius = math.sqrt(outline.a * outline.b)
    c, s = math.cos(angle), math.sin(angle)
    ahead = 1.25 * radius
    return Occluder(
        x=outline.x + c * ahead - s * offset * radius,
        y=outline.y + s * ahead + c * offset * radius,
        half_length=2.75 * radius,
        half_width=bar_width(share, offset) * radius,
        angle=angle,
    )


def board_over(outline: SphereOutline) -> Occluder:
    """Build a board that hides the whole ball.

    Parameters
    ----------
    outline : SphereOutline
        The ball.

    Returns
    -------
    Occluder
        A square board, a quarter larger than the disc.
    """
    half = 1.25 * outline.a + 3.0
    return Occluder(
        x=outline.x,
        y=outline.y,
        half_length=1.15 * half,
        half_width=half,
        angle=0.06,
        color=(108.0, 134.0, 158.0),
    )


def visible_share(
    outline: SphereOutline, camera: CameraModel, occluders: list[Occluder], fingers: Sequence[Capsule] = ()
) -> float:
    """Share of the ball's disc that lies in the picture and behind nothing.

    Counted on about 3200 points of the disc: good to 0.01.

    Parameters
    ----------
    outline : SphereOutline
        The ball.
    camera : CameraModel
        Gives the size of the picture.
    occluders : list of Occluder
        What stands in front.
    fingers : sequence of Capsule
        What else does.

    Returns
    -------
    float
        0 ... 1.
    """
    axis = (np.arange(64) + 0.5) / 32.0 - 1.0
    p, q = np.meshgrid(axis, axis)
    disc = p * p + q * q <= 1.0
    p, q = outline.a * p[disc], outline.b * q[disc]
    c, s = math.cos(outline.angle), math.sin(outline.angle)
    x, y = outline.x + c * p - s * q, outline.y + s * p + c * q
    seen = (x > -0.5) & (x < camera.width - 0.5) & (y > -0.5) & (y < camera.height - 0.5)
    for o in occluders:
        c, s = math.cos(o.angle), math.sin(o.angle)
        along, across = c * (x - o.x) + s * (y - o.y), -s * (x - o.x) + c * (y - o.y)
        seen &= (np.abs(along) > o.half_length) | (np.abs(across) > o.half_width)
    for finger in fingers:
        seen &= ~finger.covers(x, y)
    return float(seen.mean())
