"""The mean of discs that are the same ball: `mean_disc`.

Where an outline is blurred, the network stops at different circles from different sides. All were read from the same
pixels, so their mean is better than each, but no surer.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.network import Disc

Floats = npt.NDArray[np.float64]


def mean_disc(discs: Sequence[Disc], merits: Floats, same: float) -> Disc:
    """Mean of the best disc and of those that are the same ball, by their precisions and merits.

    Parameters
    ----------
    discs : sequence of Disc
        At least one.
    merits : ndarray of shape (k,), float64
        Logarithm of how likely each is.
    same : float
        Discs whose x, y and radius differ from the best one's by less in all, in its radii, are the same ball.

    Returns
    -------
    Disc
        With precision and log-odds of the best one.
    """
    best = discs[int(merits.argmax())]
    circles = np.array([disc.circle for disc in discs])
    near = np.abs(circles - best.circle).sum(axis=1) < same * best.circle[2]
    weights = np.where(near, np.exp(merits - merits.max()), 0.0)[:, np.newaxis, np.newaxis]
    precisions = weights * np.array([disc.precision for disc in discs])
    x, y, radius = np.linalg.solve(precisions.sum(axis=0), np.einsum("kij,kj->i", precisions, circles)).tolist()
    return best._replace(circle=(x, y, radius))
