"""What tells the inside of a circle from what is around it: `separate`, with the pixel at which to click.

Where a finger is before a ball, the middle of the circle is finger. But the finger goes on outside of the circle, so
its color is no rarer inside than outside, and the ball's is.
"""

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.candidates import Candidate, shrunk
from matchset.image.click_region import disc_mask
from matchset.image.color_learning import cells_of, log_odds_between

Picture = npt.NDArray[np.uint8]


class SeparationParameters(msgspec.Struct, frozen=True):
    """How the inside of a circle is compared with the picture around it.

    Chosen by hand on four real clips; docs/log/search.md#learn-chooses has the figures of these
    and of five others.

    Parameters
    ----------
    rim : float
        Share of the radius within which pixels are inside: beyond it blur mixes in the background.
    gap, gap_px : float
        Pixels are outside from so many radii on, and so many px.
    around, around_px : float
        And around the circle up to so many radii, and px.
    smoothing_px : float
        Standard deviation of the smoothing of the picture, px: averages noise away, mixes what lies close together.
    depth : float
        Standard deviation of the smoothing of the log-odds before the best pixel is chosen, in radii: larger keeps a
        click farther from what is not the ball, and from the rim.
    reach : float
        How far from the center the click may be, in radii.
    central : float
        Log-odds that one radius of distance from the center is worth.
    """

    rim: float = 0.88
    gap: float = 1.4
    gap_px: float = 4.0
    around: float = 2.2
    around_px: float = 6.0
    smoothing_px: float = 1.0
    depth: float = 0.12
    reach: float = 0.65
    central: float = 0.3


PARAMETERS = SeparationParameters()


class Separation(msgspec.Struct, frozen=True):
    """How well a circle is told from what is around it.

    Parameters
    ----------
    inside, around : float
        Share of the pixels inside, and around it, whose color is rarer in the picture than in the circle.
    pick : tuple of int
        The pixel inside it, px, where and around which that is clearest: where to click.
    """

    inside: float
    around: float
    pick: tuple[int, int]

    @property
    def clearness(self) -> float:
        """How much of the circle is free and of one kind, 0 ... 1."""
        return max(self.inside - self.around, 0.0) ** 2


def separate(image: Picture, candidate: Candidate) -> Separation:
    """Compare the inside of a circle with the picture around it.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    candidate : Candidate
        The circle.

    Returns
    -------
    Separation
        With the candidate's own pick where nothing lies around the circle.
    """
    small, scale = shrunk(image)
    small = np.asarray(cv2.GaussianBlur(small, (0, 0), PARAMETERS.smoothing_px), np.uint8)
    x, y, radius = (candidate.x + 0.5) * scale - 0.5, (candidate.y + 0.5) * scale - 0.5, candidate.radius * scale
    disc = disc_mask(small.shape, (x, y, radius), PARAMETERS.rim)
    outside = ~disc_mask(small.shape, (x, y, PARAMETERS.gap * radius + PARAMETERS.gap_px), 1.0)
    ring = outside & disc_mask(small.shape, (x, y, PARAMETERS.around * radius + PARAMETERS.around_px), 1.0)
    if not disc.any() or not ring.any():
        return Separation(0.0, 0.0, candidate.pick)
    odds = log_odds_between(small, disc, outside)
    field = odds[cells_of(small, len(odds))]
    smooth = cv2.GaussianBlur(field, (0, 0), max(1.0, PARAMETERS.depth * radius))
    rows, columns = np.indices(field.shape)
    far = np.hypot(columns - x, rows - y) / radius
    best = int(np.argmax(np.where(far < PARAMETERS.reach, smooth - PARAMETERS.central * far, -np.inf)))
    row, column = divmod(best, field.shape[1])
    pick = round((column + 0.5) / scale - 0.5), round((row + 0.5) / scale - 0.5)
    return Separation(float((field[disc] > 0.0).mean()), float((field[ring] > 0.0).mean()), pick)
