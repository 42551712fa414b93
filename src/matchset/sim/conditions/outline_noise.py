"""How far a tracker is off in pictures, as in rendered flights: `OutlineNoise`, and `slip` of one picture.

Everything follows from seed, follower and picture alone: each picture has its deviates, and what lasts for several
pictures is a sum over those of the last ones. So nothing depends on how often, or in which order, one asks.
"""

import functools
import math
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import require_within
from matchset.sim.world import RATE

Floats = npt.NDArray[np.float64]

PICTURE = RATE // 30  # format: steps from one picture to the next
CACHED = 4096  # format: capacity, pictures whose deviates are kept: more than any chain's memory
LASTING = 3  # format: deviates that last: of center x, y and of the size
POINTS = 64  # format: most points of an outline
BEFORE = 4096  # format: steps added to that of a picture, so that those before the first one have a number too
MEMORY = 2.0  # format: times `OutlineNoise.memory` after which a deviate is forgotten


class OutlineNoise(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far outlines and markers are off.

    Chosen by: what the tracker did in rendered nominal flights, seeds 910 to 912, 30 s each
    (docs/log/flights.md#outline-noise).
    The *way* is that of the ball's center in the picture since the last picture, px; what is said of a way of 1 px
    grows with the root of the way. Errors of center and size have a part that lasts, and one that is new in every
    picture: that of the points. More of any of them is harsher on who flies by it; 0 leaves it out, and `EXACT` has
    none.

    Parameters
    ----------
    point_px : float
        Standard deviation of each point across the outline, new in every picture, px. A localizer estimates from it
        how sure it is: less makes it claim too much, and a gate after it closes too early.
    point_way_px : float
        The same besides after a way of 1 px, px: what moves is blurred.
    size : float
        Standard deviation of the size besides, as a share: as much is the range off.
    center_px : float
        Standard deviation of the center along each axis besides, px.
    marker_deg : float
        Standard deviation of the marker's direction on the ball, about each axis, degree; new in every picture, and
        not moved with the outline: a wrong outline turns the ball.
    center_way_px : float
        Standard deviation of the center along an axis after a way of 1 px along it, px.
    size_way_px : float
        The same of the radius, for a way in any direction.
    raised_way_px : float
        By how much a ball's center is found too high, always, after a way of 1 px, px.
    shrunk_px : float
        By how much the radius is found too small, always, px.
    shrunk_way_px : float
        By how much it is so besides after a way of 1 px, px.
    memory : float
        How long errors of center and size last, pictures: their correlation falls by a factor e in that time.
    burst_rate : float
        Probability that a picture begins a burst, in which what lasts is larger.
    burst_pictures : int
        How long one lasts.
    burst_factor : float
        Times larger.
    wrong_rate : float
        Probability, for each pixel of the way beyond `wrong_way`, that a picture begins a wrong outline: a larger one
        that has one side in common with the ball's.
    wrong_way : float
        Way from which on there are any, px.
    wrong_pictures : int
        How long one is followed, while the ball is as fast.
    wrong_size : float
        Standard deviation of how much larger it is, as a share; its center is off sideways by as much.
    marker_missed : float
        Probability, for each pixel of the way, that the marker is not found.
    claimed : float
        Standard deviation that a tracker claims along the motion besides, as a share of the offset of a picture's
        fields, which is half the way: as `QualityParameters.field_share`. It moves nothing.
    points : int
        Points of an outline. More are slower, and need more noise each.
    marker_cosine : float
        Least cosine between the marker's direction and that to the camera at which it is found.
    inside : float
        Least share of an outline that must be in the picture.
    inside_beyond : float
        The same of the next-but-one ball, which the neighbor's hides in part.
    marker_diameter : float
        Across a marker, as a share of the ball's diameter; its size decides nothing.
    """

    point_px: float = 0.29
    point_way_px: float = 0.11
    size: float = 0.0016
    center_px: float = 0.05
    marker_deg: float = 0.45
    center_way_px: float = 0.1
    size_way_px: float = 0.038
    raised_way_px: float = 0.09
    shrunk_px: float = 0.085
    shrunk_way_px: float = 0.068
    memory: float = 8.0
    burst_rate: float = 0.015
    burst_pictures: int = 4
    burst_factor: float = 4.0
    wrong_rate: float = 0.004
    wrong_way: float = 14.0
    wrong_pictures: int = 6
    wrong_size: float = 0.14
    marker_missed: float = 0.00025
    claimed: float = 0.05
    points: int = 24
    marker_cosine: float = 0.3
    inside: float = 0.5
    inside_beyond: float = 0.3
    marker_diameter: float = 0.2

    def __post_init__(self) -> None:
        require_within(
            self,
            {
                **dict.fromkeys((*IN_PIXELS, "burst_factor", "wrong_way", "marker_deg"), (0.0, 1e6)),
                **dict.fromkeys(SHARES, (0.0, 1.0)),
                "memory": (0.1, 30.0),
                "burst_pictures": (1, 60),
                "wrong_pictures": (1, 60),
                "points": (5, POINTS),
            },
        )

    def point_deviation(self, way: float) -> float:
        """Return that of each point across the outline after a way, px."""
        return math.sqrt(self.point_px**2 + self.point_way_px**2 * way)

    def lasting_weights(self) -> Floats:
        """Weights of the last pictures' deviates in what lasts, newest first; their squares have the sum 1."""
        weights = np.exp(-np.arange(math.ceil(MEMORY * self.memory)) / self.memory)
        return weights / math.sqrt(float(weights @ weights))


IN_PIXELS = (
    *("point_px", "point_way_px", "center_px", "center_way_px", "size_way_px"),
    *("raised_way_px", "shrunk_px", "shrunk_way_px"),
)
SHARES = ("size", "burst_rate", "wrong_rate", "wrong_size", "marker_missed", "claimed")
EXACT = OutlineNoise(
    **dict.fromkeys((*IN_PIXELS, *SHARES, "marker_deg"), 0.0)  # type: ignore[arg-type] # those of floats alone
)


class Deviates(NamedTuple):
    """What is drawn for a picture; see `deviates`.

    Attributes
    ----------
    lasting : tuple of floats
        Normal: of center x, y and of the size, which count in the following pictures too.
    burst, wrong : float
        Uniform, 0 to 1: whether such a thing begins.
    wrong_size : float
        Normal: how much larger a wrong outline is, and to which side.
    missed : float
        Uniform: whether the marker is.
    marker : (3,)
        Normal: its direction, about each axis.
    points : (64,)
        Normal: of each point.
    """

    lasting: tuple[float, ...]
    burst: float
    wrong: float
    wrong_size: float
    missed: float
    marker: Floats
    points: Floats


class OutlineSlip(NamedTuple):
    """How far an outline is off.

    Attributes
    ----------
    center : (2,)
        px
    radius : float
        px
    """

    center: Floats
    radius: float


@functools.lru_cache(maxsize=CACHED)
def deviates(seed: int, what: int, who: int, step: int) -> Deviates:
    """Draw the deviates of a picture: the same at every call.

    Parameters
    ----------
    seed, what, who : int
        Of the world, a number for which of the balls, and the follower.
    step : int
        Of the picture.
    """
    rng = np.random.default_rng((seed, what, who, BEFORE + step))
    burst, wrong, missed = rng.random(3).tolist()
    normal = rng.standard_normal(LASTING + 4 + POINTS)
    normal.flags.writeable = False
    lasting = tuple(normal[:LASTING].tolist())
    return Deviates(lasting, burst, wrong, float(normal[LASTING]), missed, normal[LASTING + 1 :][:3], normal[-POINTS:])


def slip(noise: OutlineNoise, history: list[Deviates], weights: Floats, way: Floats, radius: float) -> OutlineSlip:
    """How far center and size of an outline are off, without its points' own noise.

    Parameters
    ----------
    noise : OutlineNoise
    history : list of Deviates
        Of the last pictures, newest first: as many as there are weights, or as a burst or a wrong outline lasts.
    weights : ndarray
        `OutlineNoise.lasting_weights`.
    way : ndarray of shape (2,)
        px
    radius : float
        px
    """
    x, y, size = (weights @ np.array([drawn.lasting for drawn in history[: len(weights)]])).tolist()
    across, down = np.abs(way).tolist()
    length = math.hypot(across, down)
    if any(drawn.burst < noise.burst_rate for drawn in history[: noise.burst_pictures]):
        x, y, size = noise.burst_factor * x, noise.burst_factor * y, noise.burst_factor * size
    x *= math.sqrt(noise.center_px**2 + noise.center_way_px**2 * across)
    y *= math.sqrt(noise.center_px**2 + noise.center_way_px**2 * down)
    size *= math.sqrt((noise.size * radius) ** 2 + noise.size_way_px**2 * length)
    chance = noise.wrong_rate * max(length - noise.wrong_way, 0.0)
    larger = next((drawn.wrong_size for drawn in history[: noise.wrong_pictures] if drawn.wrong < chance), 0.0)
    larger *= noise.wrong_size * radius
    root = math.sqrt(length)
    center = np.array((x + larger, y - noise.raised_way_px * root))
    return OutlineSlip(center, size + abs(larger) - noise.shrunk_px - noise.shrunk_way_px * root)
