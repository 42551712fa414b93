"""From a rough state to the shape: trace the outline, find its match-set, fit, again until nothing moves."""

import math
from typing import Generic, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.shapes.shape import Shape
from matchset.tracking.match_set import Lines
from matchset.tracking.measure import measure

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
S = TypeVar("S", bound=Shape)

INNER = 0.88  # how far out the inside is looked at, in half-widths: beyond it blur mixes with the background
NEAR = 0.04  # px: a square move below so much of the half-width leaves the lines where they are
FIRST_GRAIN = 2.0  # noise that is assumed before the first look, gray levels
GOLDEN = 0.6180339887  # spreads the places inside evenly


class MatchParameters(msgspec.Struct, frozen=True):
    """What makes an edge point and a fit; all else follows from the size of the shape and the noise of the picture.

    Parameters
    ----------
    margin : int
        Most pixels that Eq. 1 counts on each side of an edge. Noisy pictures use them all, sharp ones two, small shapes
        a quarter of their half-width: more is steadier in noise and blur, less is more exact and tells stripes apart.
    threshold : float
        The paper's nabla, as a share of a step from surely background to surely target: below it there is no edge.
        Slightly negative, since a pale stripe of the target may look more like background than what it lies before.
    enough : float
        Share beyond which a larger step is no better, and the contrast alone decides where the edge is.
    clear : float
        Contrast, in standard deviations of the noise, that an edge point without a step in color must have.
    floor : float
        Least noise of an edge point that is believed, px: smaller, and a chance agreement of few points wins.
    tolerance : float
        How near an edge point must be to the outline to confirm it, in half-widths, between 1.2 and 3 px.
    turns : int
        How often the outline is traced anew at most.
    """

    margin: int = 4
    threshold: float = -0.05
    enough: float = 0.6
    clear: float = 5.0
    floor: float = 0.4
    tolerance: float = 0.06
    turns: int = 4


class Matcher(Generic[S]):
    """Fits shapes of one family to pictures; the working memory of a tracker.

    Parameters
    ----------
    family : type
        The family of shapes, `Circle` for one.
    points : int
        Number of lines across the outline: the size of the match-set.
    parameters : MatchParameters

    Attributes
    ----------
    state : ndarray of shape (s,), float64
        The state that the last `settle` reached.
    noise : float
        Standard deviation of an edge point there, px; 0 where nothing was fitted.
    grain : float
        Standard deviation of the pixels' noise, gray levels, over the last frames.
    seen, confirmed, agreement, evidence, wave, corners
        What the last fit rests on, see `review_lines`.
    inside, core, hollow : float
        What the pixels inside look like, see `count_inside`.
    """

    def __init__(self, family: type[S], points: int, parameters: MatchParameters | None = None) -> None:
        self.family, self.points = family, points
        self.parameters = parameters or MatchParameters()
        self.count = len(family.__struct_fields__)
        self.state = family.from_coarse(0.0, 0.0, 1.0).state
        angles = 2.0 * math.pi * (np.arange(points) + 0.5) / points
        shares = INNER * np.sqrt((np.arange(points) * GOLDEN) % 1.0)
        self.rays = np.column_stack((np.cos(angles), np.sin(angles), shares))
        self.limits = np.array(msgspec.structs.astuple(self.parameters)[:6], np.float64)
        self.lines = Lines(points, len(self.state))
        self.found = np.zeros((points, 3))
        self.full_covariance = np.zeros((self.count, len(self.state) + 2))
        self.free = np.zeros(self.count)
        self.noise, self.grain = 0.0, FIRST_GRAIN
        self.seen, self.confirmed = 0, 0
        self.agreement, self.evidence, self.wave, self.corners = 0.0, 0.0, 0.0, 0.0
        self.inside, self.core, self.hollow = 0.0, 0.0, 0.0

    def settle(
        self,
        image: Image,
        color: ColorModel,
        start: Floats,
        reach: float,
        speed: float = 0.0,
        sigma: float = 0.0,
        spread: Floats | None = None,
        least: float = 0.0,
    ) -> bool:
        """Fit the shape near a state.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        start : ndarray of shape (s,), float64
            Where to begin.
        reach : float
            How far the outline may be from there, px.
        speed : float
            How fast the shape moves, px per frame: by as much the two fields of an interlaced picture may disagree.
        sigma : float
            How far the edge points are expected from the start, px; 0 for a third of the reach.
        spread : ndarray of shape (p,), float64, optional
            How far each parameter may be from the start; without it they are free.
        least : float
            Agreement below which it gives up.

        Returns
        -------
        bool
            Whether there are edge points to fit at all; whether they are enough is for the caller to judge.
        """
        self.state = start.copy()  # a new array: callers keep states
        sigma = sigma or max(reach / 3.0, 1.0)
        lines, noise, self.noise = self.lines, self.noise, 0.0
        for _ in range(self.parameters.turns):
            size = self.family.half_width(self.state)
            if not 2.0 < size < 1e5:
                self.seen = 0
                return False
            self.family.trace(self.state, self.rays, lines.outline)
            (
                noise,
                moved,
                self.grain,
                self.seen,
                self.confirmed,
                self.agreement,
                self.evidence,
                self.wave,
                self.corners,
                self.inside,
                self.core,
                self.hollow,
            ) = measure(
                image,
                color.table,
                lines.outline,
                lines.edges,
                lines.runs,
                lines.starts,
                lines.pixels,
                lines.sums,
                self.rays,
                self.limits,
                self.state,
                start,
                self.free if spread is None else spread,
                self.full_covariance,
                self.found,
                size,
                reach,
                speed,
                noise,
                sigma,
                self.grain,
            )
            if noise == 0.0 or self.agreement < least:
                return False
            if moved * moved < NEAR * size:
                break
            reach, sigma = max(4.0, 2.0 + 0.5 * speed), 1.0
        self.noise = noise
        return 2.0 < self.family.half_width(self.state) < 1e5

    def forget(self) -> None:
        """Begin anew: nothing is left of earlier pictures."""
        self.noise, self.grain = 0.0, FIRST_GRAIN

    @property
    def bent(self) -> float:
        """Size of the modes that are held near zero, in half-widths."""
        modes = self.state[self.count :].tolist()
        return math.hypot(*modes) / self.family.half_width(self.state)
