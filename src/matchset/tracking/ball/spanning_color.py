"""A color learned from several discs of a picture: `spanning_color`."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from matchset.image.click_region import disc_mask
from matchset.image.color import ColorModel
from matchset.image.color_learning import log_odds_between
from matchset.image.disc_network.patch_format import Circle3

Image = npt.NDArray[np.uint8]


def spanning_color(
    image: Image, color: ColorModel, circles: Sequence[Circle3], shares: tuple[float, float]
) -> ColorModel:
    """Learn what tells discs from what is next to them, where a click could teach that of one of them only.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
        What was learned at the click; its sample stays.
    circles : sequence of (x, y, radius)
        Discs that were found, px.
    shares : (float, float)
        Share of its radius within which a pixel is of a disc, and up to which it is next to it.

    Returns
    -------
    ColorModel
    """
    own, next_to = shares
    shape = image.shape[:2]
    target, near, of_disc = np.zeros((3, *shape), bool)
    for circle in circles:
        target |= disc_mask(shape, circle, own)
        of_disc |= disc_mask(shape, circle, 1.0 / own)
        near |= disc_mask(shape, circle, next_to)
    outside = near & ~of_disc
    if not (target.any() and outside.any()):
        return color
    model = ColorModel(log_odds_between(image if image.shape[2] > 1 else image[:, :, 0], target, outside))
    model.circle, model.sample, model.is_local = color.circle, color.sample, True
    return model
